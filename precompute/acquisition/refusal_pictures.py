"""Pictures that errors name: a photograph, what was looked for in it and what was found."""

from __future__ import annotations

import textwrap
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from precompute.acquisition.evidence import LARGEST, Evidence, PhotographError
from precompute.errors import InputError
from precompute.files import written_aside

DOTS = 100
"""Dots per inch."""

ABOUT = 1.3
"""Inches above and below a photograph for what is said of it."""

BEYOND = 1.0
"""How far beyond a photograph marks are shown, in photographs: farther ones are moved there."""


def drawn(error: InputError, folder: Path, prefix: str) -> InputError:
    """Draw what an error saw, if it says so.

    Args:
        error: Any.
        folder: Where; made if missing.
        prefix: What the picture's name begins with.

    Returns:
        The same error, the picture's file named at its end.
    """
    if not isinstance(error, PhotographError):
        return error
    photograph = error.evidence.name.replace("/", "-")
    file = folder / f"{prefix}{photograph}.refused.png"
    _draw(error.evidence, file, str(error))
    return InputError(error.file, error.field, error.value, f"{error.expected}; see {file}")


def _draw(evidence: Evidence, file: Path, text: str) -> None:
    """Draw what an error saw.

    Args:
        evidence: That.
        file: A PNG; its folder is made if missing.
        text: What the error says, put above it.
    """
    size = np.array(evidence.size)
    places = [mark.pixels.clip(-BEYOND * size, (1 + BEYOND) * size) for mark in evidence.marks]
    reach = np.concatenate([np.array([(0, 0), evidence.size]) - 0.5, *places])
    low, high = reach.min(axis=0), reach.max(axis=0)
    inches = (high - low) * LARGEST / (high - low).max() / DOTS
    figure = Figure((max(inches[0], 6), inches[1] + ABOUT), DOTS, layout="constrained")
    axes = figure.subplots()
    axes.set_facecolor("#555")
    axes.imshow(evidence.shown, extent=(-0.5, size[0] - 0.5, size[1] - 0.5, -0.5))
    for mark, place in zip(evidence.marks, places, strict=True):
        x, y = np.concatenate([place, place[:1]]).T
        colour, line = ("orangered", "-") if mark.is_found else ("cyan", "--")
        said = f"{'found' if mark.is_found else 'looked for'}: {mark.label}"
        if len(mark.pixels) == 1:
            sign = "x" if mark.is_found else "+"
            axes.plot(
                x,
                y,
                sign,
                color=colour,
                clip_on=False,
                markersize=14,
                markeredgewidth=2,
                label=said,
            )
        else:
            axes.plot(x, y, line, color=colour, linewidth=1.6, label=said)
    axes.set(xlim=(low[0], high[0]), ylim=(high[1], low[1]), xlabel="px", ylabel="px")
    axes.set_title(textwrap.fill(text, round(max(inches[0], 6) * 12)), fontsize=9)
    if evidence.marks:
        figure.legend(loc="outside lower center", ncols=2, fontsize=8, facecolor="#888")
    with written_aside(file) as aside:
        figure.savefig(aside, format="png")
