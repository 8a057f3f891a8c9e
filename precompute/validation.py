"""From pydantic's failures to the one error that names file, field, value and expectation."""

from __future__ import annotations

from pathlib import Path

from pydantic import ValidationError

from precompute.errors import InputError

MAX_FAILURES = 1000
"""Pydantic writes all of them out, at a kilobyte each, though but the first is told."""


def first_failure(
    file: str | Path, failure: ValidationError, contents: object = None
) -> InputError:
    """The first failure of a validation, as the error that users see.

    Args:
        file: What was validated.
        failure: What pydantic says of it.
        contents: The validated contents where unions are told apart by a field ``kind``, and
            those of one kind by a field ``design``: pydantic puts both into a field's path, and
            they are taken out again.
    """
    if failure.error_count() > MAX_FAILURES:
        found = f"{failure.error_count()} wrong fields"
        return InputError(file, "contents", found, f"{MAX_FAILURES} at most to look at")
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
            path.append(context["discriminator"].strip("'"))
            value = context["tag"]
            expected = f"one of {context['expected_tags']}"
        case "union_tag_not_found":
            missing = context["discriminator"].strip("'")
            path.append(missing)
            value, expected = None, f"a {missing}; the field is missing"
    field = ".".join(str(part) for part in path) or "contents"
    return InputError(file, field, value, expected)


def _without_kinds(path: tuple[int | str, ...], contents: object) -> list[int | str]:
    result: list[int | str] = []
    here, kinds = contents, _kinds(contents)  # kinds: those of `here` that are not yet passed
    for part in path:
        if kinds and part == kinds[0]:
            kinds = kinds[1:]
            continue
        if isinstance(here, int | float):
            continue  # it stands for a pair, or for a kind, which the file does not write
        result.append(part)
        here = _child(here, part)
        kinds = _kinds(here)
    return result


def _kinds(contents: object) -> list[object]:
    if not isinstance(contents, dict):
        return [contents]  # a name alone stands for its kind
    return [contents[field] for field in ("kind", "design") if field in contents]


def _child(parent: object, part: int | str) -> object:
    if isinstance(parent, dict):
        return parent.get(part)
    if isinstance(parent, list) and isinstance(part, int) and part < len(parent):
        return parent[part]
    return None
