"""All that `precompute` has to import is documented, its quantities with their units."""

import importlib
import inspect
import pkgutil
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from types import ModuleType
from typing import Any, get_args, get_origin, get_type_hints

import numpy as np
import pytest
from docstring_parser import DocstringStyle, parse
from numpy.typing import NDArray

import precompute

MODULES = [
    module.name
    for module in pkgutil.walk_packages(precompute.__path__, "precompute.")
    # The command line has its help, and the report nobody imports.
    if not re.match(r"precompute\.(cli|report)\b", module.name)
]
NUMBERS = re.compile(r"\b(float|int|complex|NDArray|Array\w*|Positive)\b")
UNIT = re.compile(
    r"(?<![\w'])(µm|um|mm|nm|rad|degrees|px|pixels|[Tt]exels|bytes|s|sr|unit vectors?|ω_[io])(?!\w)"
)
NO_UNIT = re.compile(
    r"\b(no unit|shares?|factor|times|ind(ex|ices)|relative|numbers?|how many|count|every|shape"
    r"|rows|columns|orders?|samples|nodes|seed|refractive index|ratio|slope|XYZ|radiance)\b",
    re.IGNORECASE,
)
"""Words of what has none: numbers of things, shares, ratios; and of arrays whose unit is said."""
RETURNED = re.compile(
    r"(?<![\w'|])(µm|mm|nm|[Rr]ad|degrees|px|bytes|s|sr|unit vectors?)[²³]?(?![\w*·²|])"
    r"|(?i:\b(units?|shares?|factors?|times as|ind(ex|ices)|relative|number of|how many"
    r"|refractive index|ratio|slope|XYZ|radiance)\b)"
)
"""The same of what comes back, without words that tell its shape, or what it is made from."""
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
                is_property = isinstance(plain, property)
                if not key.startswith("_") and (inspect.isfunction(plain) or is_property):
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
    ] + [
        f"{name}(): {text}"
        for name, value in members(module)
        if returns_floats(value)
        and RETURNED.search(text := said_of_result(value)) is None
        and NAMED.search(name) is None
    ]


def returns_floats(member: Any) -> bool:
    """Whether a function gives, or a property is, a float or an array of floats, or has some."""
    function = member.fget if isinstance(member, property) else member
    return inspect.isroutine(function) and holds_floats(
        get_type_hints(function, include_extras=True).get("return")
    )


def holds_floats(annotation: Any) -> bool:
    if get_origin(annotation) is Callable:
        return False
    if inspect.isclass(annotation) and issubclass(annotation, float | complex | np.inexact):
        return True
    return any(holds_floats(argument) for argument in get_args(annotation))


def said_of_result(member: Any) -> str:
    """Its first line, and what is said of the result apart or else in the lines below."""
    said = parse(inspect.getdoc(member) or "", DocstringStyle.GOOGLE)
    below = said.long_description if said.returns is None else said.returns.description
    return f"{said.short_description or ''}\n{below or ''}"


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


def test_what_comes_back_without_a_unit_is_seen() -> None:
    def silent(size: int) -> tuple[int, NDArray[np.float32]]:
        """The lamp's place, shape (size,)."""
        raise NotImplementedError

    def apart(width: float) -> float | None:
        """How long.

        Args:
            width: A share.

        Returns:
            Half the width, µm.
        """

    class Sheet:
        @property
        def length(self) -> float:
            """How long.

            mm, of the longer side.
            """
            raise NotImplementedError

    def count() -> int:
        raise NotImplementedError

    results = (silent, apart, Sheet.length, count)
    assert [returns_floats(result) for result in results] == [True, True, True, False]
    said = [RETURNED.search(said_of_result(result)) is not None for result in results[:3]]
    assert said == [False, True, True]
