"""What it means that bad input is refused."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from precompute.errors import InputError


@contextmanager
def refused(file: str | Path, field: str, value: object, expected: str) -> Iterator[None]:
    """Expects one `InputError` that names them all, in one line.

    Args:
        file: Its file.
        field: Its field.
        value: Its value; compared as text, so that NaN equals itself.
        expected: Occurs in what was expected.
    """
    with pytest.raises(InputError) as caught:
        yield
    error = caught.value
    assert (error.file, error.field) == (str(file), field)
    assert repr(error.value) == repr(value)
    assert expected in error.expected
    message = str(error)
    assert "\n" not in message
    assert all(part in message for part in (error.file, error.field, error.expected))
