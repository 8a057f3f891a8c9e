"""From pydantic's list of failures to the one error that names file, field, value and expectation."""

from __future__ import annotations

from pathlib import Path

from pydantic import ValidationError

from precompute.errors import InputError


def first_failure(file: str | Path, failure: ValidationError) -> InputError:
    """The first failure of a validation, as the error that users see."""
    first = failure.errors()[0]
    field = ".".join(str(part) for part in first["loc"]) or "contents"
    expected = first["msg"]
    if first["type"] == "extra_forbidden":
        expected = "no such field"
    return InputError(file, field, first["input"], expected)
