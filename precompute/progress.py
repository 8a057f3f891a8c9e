"""Bars on standard error, where that is a terminal."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeVar

from rich.console import Console
from rich.progress import track

console = Console(stderr=True)

T = TypeVar("T")


def tracked(items: Iterable[T], description: str, total: int | None = None) -> Iterable[T]:
    """The items, with a bar that fills as they are taken; one within another adds a line.

    Args:
        items: What to go through.
        description: What is being done.
        total: How many items, where they do not say.
    """
    return track(items, description, total, console=console, disable=not console.is_terminal)
