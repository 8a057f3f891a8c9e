"""Reading columns of numbers."""

from pathlib import Path

import pytest
from refusals import refused

from precompute.columns import Columns

FILE = Path("in.csv")


@pytest.mark.parametrize("rows", [1, 2, 3, 4, 5, 7])
def test_no_row_is_lost_between_chunks(rows: int) -> None:
    lines = ["x,note", *(f"{i},n{i}" for i in range(rows))]
    chunks = list(Columns(FILE, lines).read(["x"], count=2))
    assert [n for c in chunks for n in c.numbers["x"].tolist()] == list(range(rows))
    assert [cell for c in chunks for _, cell in c.cells] == [f"n{i}" for i in range(rows)]
    assert max(len(c.cells) for c in chunks) <= 2


def test_lines_are_counted_as_an_editor_counts_them() -> None:
    lines = ["# made by hand", "x", "1", "", "# more", "2", "many"]
    with refused("in.csv", "x, line 7", "many", "a finite number"):
        list(Columns(FILE, lines).read(["x"]))


@pytest.mark.parametrize(
    ("lines", "field", "value", "expected"),
    [
        ([], "header", "an empty file", "column names"),
        (["", "# only a comment"], "header", "an empty file", "column names"),
        (["x,y,x"], "header", "x", "each column once"),
        (["y", "1"], "x", "y", "a column x"),
        (["x"], "rows", "none below the header", "one or more rows"),
        (["x", "1,2"], "line 2", "2 cells", "1 cells"),
        (["x,y", "1"], "line 2", "1 cells", "2 cells"),
        (["x", "1", '""'], "x, line 3", "", "a finite number"),
    ],
)
def test_bad_tables_are_refused(lines: list[str], field: str, value: object, expected: str) -> None:
    with refused("in.csv", field, value, expected):
        list(Columns(FILE, lines).read(["x"]))
