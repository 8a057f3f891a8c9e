"""The mapping between a table's texels and the parameters they stand for.

The first and the last texel's centres stand for the ends of the range, so that linear filtering
never leaves it. A sidecar states each axis; the web loader reads the same statement.
"""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BaseModel, ConfigDict, Field

Array = NDArray[np.float64]


class Axis(BaseModel):
    """One axis of a table.

    Attributes:
        name: The parameter's name.
        symbol: Its symbol in docs/theory.
        unit: Its unit, ``1`` where it has none.
        size: Texels along it.
        mapping: How the parameter runs from `first` to `last` with the position x in [0, 1]:
            ``linear``: first + (last − first) x; ``square``: first + (last − first) x²;
            ``log``: first (last/first)^x.
        first: The parameter at the first texel's centre.
        last: The parameter at the last texel's centre.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    name: str
    symbol: str
    unit: str
    size: Annotated[int, Field(ge=1)]
    mapping: Literal["linear", "square", "log"] = "linear"
    first: float
    last: float

    def parameter_from_texel(self, texel: ArrayLike) -> Array:
        """The parameter at a texel index, which may be fractional."""
        x = np.asarray(texel, dtype=np.float64) / max(self.size - 1, 1)
        if self.mapping == "log":
            return self.first * (self.last / self.first) ** x
        return self.first + (self.last - self.first) * (x**2 if self.mapping == "square" else x)

    def texel_from_parameter(self, parameter: ArrayLike) -> Array:
        """The fractional texel index of a parameter, held within the table.

        >>> axis = Axis(name="p", symbol="p", unit="1", size=9, mapping="log", first=1, last=16)
        >>> float(axis.texel_from_parameter(axis.parameter_from_texel(3.25)))
        3.25
        """
        p = np.asarray(parameter, dtype=np.float64)
        if self.mapping == "log":
            x = np.log(np.maximum(p, np.finfo(float).tiny) / self.first) / np.log(
                self.last / self.first
            )
        else:
            x = (p - self.first) / ((self.last - self.first) or 1)
            x = np.sqrt(np.maximum(x, 0)) if self.mapping == "square" else x
        return np.clip(x, 0, 1) * (self.size - 1)

    def parameters(self) -> Array:
        """The parameters at all texels' centres, in the axis' unit, shape (size,)."""
        return self.parameter_from_texel(np.arange(self.size))
