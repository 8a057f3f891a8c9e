"""The one error that bad input raises."""

from __future__ import annotations

from pathlib import Path


class InputError(ValueError):
    """Input that cannot be used, said as file, field, value and what was expected.

    Args:
        file: The file that holds the value, or the name of the function's argument set where
            there is no file.
        field: The field, column, option or array within it.
        value: What was found there.
        expected: What would have been accepted.
    """

    def __init__(self, file: str | Path, field: str, value: object, expected: str) -> None:
        self.file = str(file)
        self.field = field
        self.value = value
        self.expected = expected
        shown = repr(value)
        if len(shown) > 120:
            shown = shown[:117] + "..."
        super().__init__(f"{self.file}: {field} = {shown}: expected {expected}")


def unreadable(file: str | Path, reason: object) -> InputError:
    """The error for a file that is missing or cannot be parsed."""
    return InputError(file, "contents", str(reason), "a readable file")
