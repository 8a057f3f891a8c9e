"""What a person imports from `precompute` is documented, its quantities with their units."""

import importlib
import inspect
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import pytest
from docstring_parser import DocstringStyle, parse

PUBLIC = [
    *"axes bake closed_form efficiencies errors evaluate gratings images lobes maps".split(),
    *"metrics profiles recipes reference renderings spectra wavelength_loop".split(),
    *(f"foils.{name}" for name in "bumps distribution edits foil_map stochastic".split()),
    *(
        f"height_fields.{name}"
        for name in "baked expansion field generate optics prepare read reference terms".split()
    ),
    *(
        f"acquisition.{name}"
        for name in "capture flash fuse fusion jones polarization sensor simulate".split()
    ),
    "acquisition.simulate_polarization",
]
NUMBERS = re.compile(r"\b(float|int|complex|NDArray|Array\w*|Positive)\b")
UNIT = re.compile(
    r"(?<!\w)(µm|um|mm|nm|rad|degrees|px|pixels|[Tt]exels|bytes|s|sr|unit vectors?|ω_[io])(?!\w)"
)
NO_UNIT = re.compile(
    r"\b(no unit|shares?|factor|times|ind(ex|ices)|relative|numbers?|how many|count|every|shape"
    r"|rows|columns|orders?|samples|nodes|seed|refractive index|ratio|slope|XYZ|radiance)\b",
    re.IGNORECASE,
)
"""Words of what has none: numbers of things, shares, ratios; and of arrays whose unit is said."""
NAMED = re.compile(r"_(mm|um|nm|px|s|deg|xyz|rgb)$|^degrees$")
"""Names that say the unit themselves."""


@dataclass
class Parameter:
    name: str
    text: str

    @property
    def has_unit(self) -> bool:
        return any(p.search(self.text) for p in (UNIT, NO_UNIT)) or bool(NAMED.search(self.name))


def members(module: ModuleType) -> Iterator[tuple[str, Any]]:
    """Public classes, functions and methods that a module defines."""
    for name, value in vars(module).items():
        # Names with brackets are pydantic's, of generic classes.
        if not name.isidentifier() or name.startswith("_"):
            continue
        if getattr(value, "__module__", None) != module.__name__:
            continue
        if inspect.isfunction(value):
            yield name, value
        elif inspect.isclass(value):
            yield name, value
            for key, member in vars(value).items():
                plain = getattr(member, "__func__", member)
                if not key.startswith("_") and inspect.isfunction(plain):
                    yield f"{name}.{key}", getattr(value, key)


def undocumented(module: ModuleType) -> list[str]:
    return [name for name, value in members(module) if not inspect.getdoc(value)]


def without_unit(module: ModuleType) -> list[str]:
    return [
        f"{name}({parameter.name}): {parameter.text}"
        for name, function in members(module)
        if inspect.isroutine(function)
        for parameter in quantities(function)
        if not parameter.has_unit
    ]


def quantities(function: Callable[..., Any]) -> Iterator[Parameter]:
    """Parameters that are numbers, with what is said of each, apart or in the function's line."""
    text = inspect.getdoc(function) or ""
    said = {p.arg_name: p.description or "" for p in parse(text, DocstringStyle.GOOGLE).params}
    for name, parameter in inspect.signature(function).parameters.items():
        if name in ("self", "cls") or NUMBERS.search(str(parameter.annotation)) is None:
            continue
        is_named = re.search(rf"(?<!\w){name}(?!\w)", text) is not None
        yield Parameter(name, said.get(name, text if is_named else ""))


@pytest.mark.parametrize("name", PUBLIC)
def test_what_is_imported_is_documented(name: str) -> None:
    module = importlib.import_module(f"precompute.{name}")
    assert module.__doc__
    assert undocumented(module) == []
    assert without_unit(module) == []


def test_what_lacks_a_unit_is_seen() -> None:
    def poor(depth: float, length: float, width: float, height_mm: float) -> None:
        """Poor.

        Args:
            depth: How deep, µm.
            length: How long.
            height_mm: How high.
        """

    assert [p.name for p in quantities(poor) if not p.has_unit] == ["length", "width"]
