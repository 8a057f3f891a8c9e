"""Columns of numbers in CSV files, read some thousands of rows at a time."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from precompute.errors import InputError, unreadable

Array = NDArray[np.float64]

CHUNK = 16384
"""Rows read at once: enough that numpy's overhead per call does not count, some MB at most."""


@dataclass(frozen=True)
class Rows:
    """Consecutive rows of a file.

    Attributes:
        cells: Their text, one list a row.
        lines: Their line numbers in the file, the header's usually being 1.
        numbers: The columns asked for, each of shape (rows,), finite.
    """

    cells: list[list[str]]
    lines: list[int]
    numbers: dict[str, Array]


class Columns:
    """A CSV file with a header. Empty lines and lines that begin with ``#`` are passed over.

    Args:
        file: The file's name, for errors.
        lines: Its lines.

    Raises:
        InputError: There is no header, or a name occurs twice in it.
    """

    def __init__(self, file: Path, lines: Iterable[str]) -> None:
        self.file = file
        self._rows = self._parsed(lines)
        _, header = next(self._rows, (0, None))
        if header is None:
            raise InputError(file, "header", "an empty file", "a line of column names")
        self.header = [name.strip() for name in header]
        twice = next((name for name in self.header if self.header.count(name) > 1), None)
        if twice is not None:
            raise InputError(file, "header", twice, "each column once")

    def require(self, names: Sequence[str]) -> None:
        """Raise `InputError` for the first of `names` that the header lacks."""
        for name in names:
            if name not in self.header:
                raise InputError(self.file, name, ",".join(self.header), f"a column {name}")

    def read(self, names: Sequence[str], count: int = CHUNK) -> Iterator[Rows]:
        """The rows, `count` at a time, with the columns `names` as numbers.

        Raises:
            InputError: A column is missing, a row has too many or too few cells, a cell is not a
                finite number, or there are no rows.
        """
        self.require(names)
        total = 0
        while chunk := list(islice(self._rows, count)):
            total += len(chunk)
            lines, cells = [line for line, _ in chunk], [row for _, row in chunk]
            for line, row in chunk:
                if len(row) != len(self.header):
                    raise InputError(
                        self.file, f"line {line}", f"{len(row)} cells", f"{len(self.header)} cells"
                    )
            yield Rows(cells, lines, {name: self._numbers(name, chunk) for name in names})
        if total == 0:
            raise InputError(self.file, "rows", "none below the header", "one or more rows")

    def _parsed(self, lines: Iterable[str]) -> Iterator[tuple[int, list[str]]]:
        reader = csv.reader(lines)
        try:
            for row in reader:
                if row and not row[0].startswith("#"):
                    yield reader.line_num, row
        except (OSError, ValueError, csv.Error) as failure:
            raise unreadable(self.file, failure) from failure

    def _numbers(self, name: str, chunk: list[tuple[int, list[str]]]) -> Array:
        column = self.header.index(name)
        numbers = np.empty(len(chunk))
        for i, (line, row) in enumerate(chunk):
            try:
                numbers[i] = float(row[column])
            except ValueError:
                numbers[i] = np.nan
            if not np.isfinite(numbers[i]):
                raise InputError(self.file, f"{name}, line {line}", row[column], "a finite number")
        return numbers
