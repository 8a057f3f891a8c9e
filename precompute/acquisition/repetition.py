"""The tile of a repeating sample, found where its gratings are seen again."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates, spline_filter
from scipy.optimize import minimize

from precompute.acquisition.agreement import DIRECTIONS, Agreement, Look, agreements
from precompute.errors import InputError

Array = NDArray[np.float64]

STEP = 0.5
"""Of the sizes that are tried, px: two pixels, a small piece, at the fourth tile."""

LONGEST = 0.8
"""Of the sample's width or height, the longest period that is tried: were less tried, a part of a
tile that is longer would have no rival."""

TURNED = list(range(DIRECTIONS // 6, DIRECTIONS - DIRECTIONS // 6 + 1, DIRECTIONS // 12))
"""Turns by 30° to 150°: no grating is lit in both of such directions."""

MOST = 0.6
"""Of the sample's width or height, the longest period that is believed: with less than two tiles a
size was found that was 10 % off."""

LEAD = 3.0
"""Times the most evidence of a size that chance brings: it was up to 1.1 times as much where
nothing repeats, up to 2.4 where less than two tiles are seen, and 7 to 600 where 8 × 6 are."""

EVEN = 0.6
"""Least agreement of other corners over that of every second or third: of tiles it was 0.7 or more,
of halves it is what chance has over what tiles have, 0.2 to 0.5."""


def find_tile(looks: list[Look], pitch_mm: float) -> tuple[float, float]:
    """Find how often a sample's pattern repeats along x and y.

    At the corners of a lattice of tiles n pairs of points agree where chance would have m. How much
    likelier n is with a rate of n / m than with 1, n ln(n / m) − n + m for Poisson's, is the
    evidence for the lattice. Twice the tile has the same n / m of fewer pairs; half of it mixes
    them with pairs as rare as chance has them, and loses, the logarithm being steep. So the tile
    itself has the most. Where few tiles are seen, or few gratings make one, half of it may have
    more by chance; but then points agree less at the corners that are not the tile's.

    Pairs come in pieces, not one by one, so that a lattice may reach any evidence by chance. How
    much is told by pairs whose directions differ by 30° or more: their pieces are the same, but no
    grating is behind both.

    Args:
        looks: The photographs, on one grid.
        pitch_mm: Of the grid.

    Returns:
        Width and height of a tile, mm.

    Raises:
        InputError: No size stands out from chance.
    """
    alike, *turned = agreements(looks, [0, *TURNED])
    piece = max(alike.piece(), 1)
    rows, columns = looks[0].lit.shape
    trials = [np.arange(piece, LONGEST * extent, STEP) for extent in (columns, rows)]
    if min(len(sizes) for sizes in trials) == 0 or not any(look.lit.any() for look in looks):
        raise _refusal("lit points that are alike all over, or none")
    beyond = alike.beyond(piece)
    width, height = _whole(beyond, *_best(beyond, trials)[:2])
    evidence = float(_evidence(*_at_corners(beyond, width, height)))
    chance = max(_best(other.beyond(piece), trials)[2] for other in turned)
    found = f"{width * pitch_mm:.1f} × {height * pitch_mm:.1f} with evidence {evidence:.0f}"
    if evidence <= LEAD * chance:
        raise _refusal(f"{found}, and {chance:.0f} by chance")
    if width > MOST * columns or height > MOST * rows:
        raise _refusal(f"{found}, but less than two of them")
    width, height = _refined(beyond, width, height)
    return width * pitch_mm, height * pitch_mm


def _refusal(found: str) -> InputError:
    expected = "a pattern that repeats so clearly that its tile can be found, or the tile's size"
    return InputError("capture", "sample.tile_mm", found, expected)


def _best(agreement: Agreement, trials: list[Array]) -> tuple[float, float, float]:
    """Width and height of the tile with the most evidence, px, and how much that is."""
    evidence = _evidence(*(_on_lattices(pairs, *trials) for pairs in vars(agreement).values()))
    column, row = np.unravel_index(np.argmax(evidence), evidence.shape)
    return float(trials[0][column]), float(trials[1][row]), float(evidence[column, row])


def _evidence(seen: Array, expected: Array) -> Array:
    """n ln(n / m) − n + m where n > m, of pairs seen and expected."""
    ratio = np.maximum(seen, 1e-9) / np.maximum(expected, 1e-9)
    return np.where(ratio > 1, seen * np.log(ratio) - seen + expected, 0)


def _whole(agreement: Agreement, width: float, height: float) -> tuple[float, float]:
    """The least multiple of a size at all of whose corners points agree alike."""
    all_seen, all_expected = _at_corners(agreement, width, height)
    for times in (2, 3):
        for sides in ((times * width, height), (width, times * height)):
            seen, expected = _at_corners(agreement, *sides)
            if (all_seen - seen) * expected < EVEN * seen * (all_expected - expected):
                return _whole(agreement, *sides)
    return width, height


def _at_corners(agreement: Agreement, width: float, height: float) -> tuple[Array, Array]:
    """Pairs seen and expected on one lattice, shape () each."""
    sizes = np.array([width]), np.array([height])
    seen, expected = (_on_lattices(pairs, *sizes)[0, 0] for pairs in vars(agreement).values())
    return seen, expected


def _on_lattices(pairs: Array, widths: Array, heights: Array) -> Array:
    """Sums of pairs over half of each lattice's points, shape (widths, heights).

    The other half are the same pairs with first and second exchanged.
    """
    down, right = pairs.shape[0] // 2, pairs.shape[1] // 2
    below, left = pairs[down:, right:], pairs[down:, right::-1]
    folded = below + left
    folded[0], folded[:, 0], folded[0, 0] = below[0], below[:, 0], 0
    rows = [_multiples(height, down) for height in heights]
    starts = np.cumsum([0, *(len(row) for row in rows[:-1])])
    stacked = np.concatenate(rows)
    return np.array(
        [
            np.add.reduceat(folded[:, _multiples(width, right)].sum(axis=1)[stacked], starts)
            for width in widths
        ]
    )


def _multiples(length: float, most: int) -> NDArray[np.intp]:
    return np.round(np.arange(0, most + 1e-9, length)).astype(np.intp)


def _refined(agreement: Agreement, width: float, height: float) -> tuple[float, float]:
    """The size, within two pixels, of the most evidence at corners between pixels."""
    down, right = agreement.reach
    smooth = [spline_filter(pairs) for pairs in vars(agreement).values()]
    across = int((right - 1) / (width + 2))
    columns = np.arange(-across, across + 1)
    column, row = np.meshgrid(columns, np.arange(int((down - 1) / (height + 2)) + 1))

    def missed(size: Array) -> float:
        at = [down + row.ravel() * size[1], right + column.ravel() * size[0]]
        seen, expected = (map_coordinates(pairs, at, prefilter=False).sum() for pairs in smooth)
        return -float(_evidence(seen, expected))

    found = minimize(
        missed,
        [width, height],
        method="Nelder-Mead",
        bounds=[(side - 2, side + 2) for side in (width, height)],
        options={
            "initial_simplex": [
                (width - 0.5, height - 0.5),
                (width + 0.5, height - 0.3),
                (width, height + 0.6),
            ],
            "xatol": 1e-3,
        },
    )
    return float(found.x[0]), float(found.x[1])
