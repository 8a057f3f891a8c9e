"""What was asked for in numbers, and what is measured."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass


@dataclass(frozen=True)
class Bar:
    """Something asked for, and what is measured.

    Attributes:
        asked: What, in words.
        limit: The largest value that meets it; None where no bar is set.
        value: What was measured.
        where: In which scene or case, at its worst.
        digits: Format of both numbers.
    """

    asked: str
    limit: float | None
    value: float
    where: str
    digits: str = ".3g"

    @property
    def is_met(self) -> bool:
        return self.limit is None or self.value <= self.limit

    def cells(self) -> list[str]:
        value = format(self.value, self.digits)
        if self.limit is None:
            return [self.asked, "none set", value, "", self.where]
        verdict = "met" if self.is_met else "**missed**"
        return [self.asked, f"≤ {format(self.limit, self.digits)}", value, verdict, self.where]


def worst(
    asked: str,
    figures: Iterable[tuple[str, float]],
    limit: float | None,
    digits: str = Bar.digits,
) -> Iterator[Bar]:
    """The bar at the largest of some figures, or none where there are no figures.

    Args:
        asked: What, in words.
        figures: Where, and what was measured there.
        limit: As in `Bar`.
        digits: As in `Bar`.
    """
    found = list(figures)
    if found:
        where, value = max(found, key=lambda figure: figure[1])
        yield Bar(asked, limit, value, where, digits)
