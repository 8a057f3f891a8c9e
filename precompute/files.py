"""Writing files so that nothing half-written is ever found under their name."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def written_aside(file: Path) -> Iterator[Path]:
    """A path beside `file` to write to; it takes the file's name at the end, or is deleted.

    Args:
        file: The file; its folder is made if missing.
    """
    file.parent.mkdir(parents=True, exist_ok=True)
    aside = file.with_name(file.name + ".part")
    try:
        yield aside
        aside.replace(file)
    finally:
        aside.unlink(missing_ok=True)
