"""What a grating is: the recipe a person writes, and the object every method is asked about."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, field_validator

from precompute.profiles import Profile, Sinusoidal
from precompute.spectra import Metal, Observer

Energy = Literal["conserving", "reciprocal", "kirchhoff"]
Positive = Annotated[float, Field(gt=0)]


class Grating(BaseModel):
    """A one-dimensional reflection grating, its grating vector along +t, its normal along +n.

    Attributes:
        period: a, µm.
        height: h0, from valley to ridge, µm.
        profile: Shape of one period; a name alone takes its defaults.
        metal: The metal, which gives R(λ); ``null`` for a perfect mirror, R = 1.
        coherence: σ of the Gaussian coherence window exp(−r²/2σ²), µm.
        roughness: Standard deviation of the normal's tilt, rad.
        energy: How efficiencies are normalised (see `precompute.reference.energy_factor`).
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    period: Positive
    height: Positive
    profile: Profile = Sinusoidal()
    metal: Metal | None = "aluminium"
    coherence: Positive = 16.25
    roughness: Annotated[float, Field(ge=0, lt=np.pi / 2)] = 0.0
    energy: Energy = "conserving"

    @field_validator("profile", mode="before")
    @classmethod
    def _name_is_kind(cls, value: Any) -> Any:
        return {"kind": value} if isinstance(value, str) else value


class Light(BaseModel):
    """A distant light.

    Attributes:
        illuminant: Name or CSV path of its spectrum (`precompute.spectra.illuminant`).
        observer: Whose colour-matching functions turn it into XYZ.
        angular_radius: Standard deviation of the Gaussian source as seen from the surface, rad,
            above 0; left out, the source is a point.
        tint: Linear sRGB colour, a factor of the illuminant.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    illuminant: str = "D65"
    observer: Observer = "1931-2"
    angular_radius: Annotated[float, Field(gt=0, le=np.pi / 2)] = 0.0  # the default is not checked
    tint: tuple[float, float, float] = (1.0, 1.0, 1.0)
