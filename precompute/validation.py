"""From pydantic's failures to the one error that names file, field, value and expectation."""

from __future__ import annotations

from pathlib import Path

from pydantic import ValidationError

from precompute.errors import InputError


def first_failure(
    file: str | Path, failure: ValidationError, contents: object = None
) -> InputError:
    """The first failure of a validation, as the error that users see.

    Args:
        file: What was validated.
        failure: What pydantic says of it.
        contents: The validated contents where unions are told apart by a field ``kind``: pydantic
            puts the kind into a field's path, and it is taken out again.
    """
    first = failure.errors()[0]
    path = _without_kinds(first["loc"], contents)
    value, expected, context = first["input"], first["msg"], first.get("ctx", {})
    expected = expected.removeprefix("Input should be ")
    match first["type"]:
        case "extra_forbidden":
            expected = "no such field"
        case "value_error":
            expected = str(context["error"])
        case "missing":
            value, expected = None, "a value; the field is missing"
        case "union_tag_invalid":
            path.append("kind")
            value = context["tag"]
            expected = f"one of {context['expected_tags']}"
        case "union_tag_not_found":
            path.append("kind")
            value, expected = None, "a kind; the field is missing"
    field = ".".join(str(part) for part in path) or "contents"
    return InputError(file, field, value, expected)


def _without_kinds(path: tuple[int | str, ...], contents: object) -> list[int | str]:
    result: list[int | str] = []
    here, named = contents, False  # named: the kind of `here` has been passed
    for part in path:
        kind = here.get("kind") if isinstance(here, dict) else here
        if part == kind and not named:
            named = True
            continue
        result.append(part)
        here, named = _child(here, part), False
    return result


def _child(parent: object, part: int | str) -> object:
    if isinstance(parent, dict):
        return parent.get(part)
    if isinstance(parent, list) and isinstance(part, int) and part < len(parent):
        return parent[part]
    return None
