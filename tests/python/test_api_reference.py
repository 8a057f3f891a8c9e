"""All that `precompute` has to import is documented, its quantities with their units."""

import importlib
import inspect
import pkgutil
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import pytest
from docstring_parser import DocstringStyle, parse

import precompute

MODULES = [
    module.name
    for module in pkgutil.walk_packages(precompute.__path__, "precompute.")
    # The command line has its help, and the report nobody imports.
    if not re.match(r"precompute\.(cli|report)\b", module.name)
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


@pytest.mark.parametrize("name", MODULES)
def test_what_can_be_imported_is_documented(name: str) -> None:
    module = importlib.import_module(name)
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
