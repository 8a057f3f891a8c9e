"""Noise and small bumps taken out of measured orientations, the edges between gratings kept.

An iterated bilateral filter in (cos 2θ, sin 2θ), after the 2018 paper's sections 5.3 and 6.2:
pixels that do not diffract are left out, what a fit is sure of weighs more, and values are compared
with the median of a small window in place of the middle pixel, which may itself be what is off.

Other than in the paper

- the comparison's width is not one number: a pair of values is compared by what both are known to.
  Noisy pixels reach far, and what has been averaged reaches less far with every pass, so that
  steps do not wear down as they do under a constant width;
- the median serves the first pass alone, since later it would round off corners, a pixel a pass;
  and only for pixels that are noisy, or alone among others that agree: it takes strokes away that
  are two pixels wide;
- orientations are compared, and averaged, as they are less the slope around a pixel, but for those
  noisy ones in the first pass. Else passes make stairs of whatever turns steadily, as kinematic
  discs do.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeAlias

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from precompute.acquisition.blocks import Run, in_threads
from precompute.errors import InputError
from precompute.progress import tracked

Pixels = NDArray[np.float32]
Turn: TypeAlias = tuple[Pixels, Pixels]
"""Cosine and sine."""

REACH = 2.0
"""Windows end at so many standard deviations."""

LEAST, MOST = 1e-4, 2.0
"""Uncertainties, rad, are taken as no smaller, which keeps squares of weights within single
precision, and as no larger, from where on they all mean the same: not known."""

STROKE, NEAR = 2, 2.0
"""Of 3 × 3 pixels more than so many are like the middle, itself included, as along the finest
stroke; else it is itself what is off, if most are like their median. Alike is what is no further
apart than so many widths of the comparison."""

LOWEST = np.float32(-80)
"""Exponent of what counts as nothing: beyond, OpenCV's exponential, four times as fast as NumPy's,
becomes a hundred times slower."""

STRIP = 2**15
"""Pixels that are filtered at once: what is kept of them fits into a processor's cache."""

SLOPE_REACH, SLOPE_ROUNDS = 4, 4
"""A slope is that of pixels no further than so, row- and columnwise; in so many rounds what differs
from the others there, a step, is left out."""

BLOCK, BLOCK_ROWS = 2**16, 32
"""Pixels of a block, and how many rows it has at the least: as many as its margins, which slopes
take."""

CHANGED = ("cosine", "sine", "variance", "weight")
"""Arrays of a field that a pass renews."""


@dataclass(frozen=True)
class FilterOptions:
    """How much is smoothed.

    Attributes:
        spatial: Standard deviation of the window, pixels.
        range: Difference of orientations, rad, that is smoothed away however well both are known:
            bumps. A standard deviation, in 2 sin δθ ≈ 2δθ.
        deviations: And this number of standard deviations of the two values that are compared.
        iterations: Passes.
    """

    spatial: float = 3.0
    range: float = 0.05
    deviations: float = 1.0
    iterations: int = 10

    def __post_init__(self) -> None:
        for field, least in (
            ("spatial", 0.3),
            ("range", 1e-3),
            ("deviations", 0),
            ("iterations", 0),
        ):
            value = getattr(self, field)
            if not (np.isfinite(value) and value >= least):
                raise InputError("orientation filter", field, value, f"a number from {least:g}")


@dataclass(frozen=True)
class FilteredOrientation:
    """Arrays of one shape, NaN where the mask is off.

    Attributes:
        orientation: θ, rad, 0 to π.
        uncertainty: Its standard deviation, rad, as far as it comes from errors that went in and
            were independent; too small by a third after one pass, a tenth after ten, since the
            middle pixel's noise chooses what is averaged. What is smoothed away where orientations
            turn or step comes on top.
    """

    orientation: Pixels
    uncertainty: Pixels


@dataclass(frozen=True)
class _Field:
    """Orientations with a bare margin, so that windows never leave the arrays.

    Attributes:
        cosine: cos 2θ.
        sine: sin 2θ.
        variance: Of θ, rad².
        weight: 1/variance; 0 where nothing is known.
        first: The variance of what went into the first pass.
    """

    cosine: Pixels
    sine: Pixels
    variance: Pixels
    weight: Pixels
    first: Pixels

    def part(self, rows: slice, columns: slice = slice(None)) -> _Field:
        return _Field(*(array[rows, columns] for array in vars(self).values()))


@dataclass(frozen=True)
class _Block:
    """What it takes to filter some rows.

    Attributes:
        field: Those rows, and such above and below as windows and slopes reach.
        rows: Which of them.
    """

    field: _Field
    rows: slice


def filtered_orientation(
    orientation: ArrayLike,
    uncertainty: ArrayLike,
    mask: ArrayLike,
    options: FilterOptions | None = None,
    passed: Callable[[int, Pixels], None] | None = None,
    run: Run = in_threads,
) -> FilteredOrientation:
    """Filter a map of orientations.

    Args:
        orientation: θ, rad, any number standing for itself modulo π. Shape (rows, columns).
        uncertainty: Its standard deviation, rad, above 0: that shape, or one number for all.
        mask: Which pixels diffract, of that shape. Those whose orientation or uncertainty is NaN
            are taken as if they did not.
        options: How much is smoothed.
        passed: Told the number of passes done and θ after each of them.
        run: Filters blocks of rows; what comes out does not depend on how many these are.

    Raises:
        InputError: Shapes differ, an uncertainty is not above 0, or an option is out of range.
    """
    options = options or FilterOptions()
    θ = np.asarray(orientation, np.float32)
    known, σ = _checked(θ, uncertainty, mask)
    radius = _radius(options)
    now = _field(θ, σ, known, radius)
    for done in range(options.iterations):
        now = _pass(now, options, done, run)
        if passed is not None:
            passed(done + 1, _orientation(now, radius))
    return FilteredOrientation(
        _orientation(now, radius),
        np.where(known, np.sqrt(_inner(now.variance, radius)), np.float32(np.nan)),
    )


def _radius(options: FilterOptions) -> int:
    """Of a window, and margin of the field."""
    return int(np.ceil(REACH * options.spatial))


def _checked(
    θ: Pixels, uncertainty: ArrayLike, mask: ArrayLike
) -> tuple[NDArray[np.bool_], Pixels]:
    """Where orientations are known, and how well."""
    known, σ = np.asarray(mask, bool), np.asarray(uncertainty, np.float32)
    for field, shape in (("orientation", θ.shape), ("mask", known.shape)):
        if len(shape) != 2 or shape != θ.shape:
            raise InputError("orientation filter", field, shape, "rows and columns, as the others")
    if σ.ndim and σ.shape != θ.shape:
        raise InputError("orientation filter", "uncertainty", σ.shape, f"the shape {θ.shape}")
    σ = np.broadcast_to(σ, θ.shape)
    known = known & np.isfinite(θ) & ~np.isnan(σ)
    if (σ[known] <= 0).any():
        raise InputError("orientation filter", "uncertainty", float(σ[known].min()), "above 0, rad")
    return known, σ


def _field(θ: Pixels, σ: Pixels, known: NDArray[np.bool_], margin: int) -> _Field:
    variance = np.where(known, np.clip(σ, LEAST, MOST) ** 2, np.float32(1))
    arrays = (
        np.where(known, np.cos(2 * θ), np.float32(0)),
        np.where(known, np.sin(2 * θ), np.float32(0)),
        variance,
        known / variance,
        variance,
    )
    return _Field(*(np.pad(array.astype(np.float32), margin) for array in arrays))


def _inner(array: Pixels, margin: int) -> Pixels:
    return array[margin:-margin, margin:-margin]


def _orientation(field: _Field, margin: int) -> Pixels:
    cosine, sine, weight = (
        _inner(array, margin) for array in (field.cosine, field.sine, field.weight)
    )
    θ = np.mod(np.arctan2(sine, cosine) / 2, np.float32(np.pi))
    θ[θ >= np.float32(np.pi)] = 0  # a negative angle so small that it rounds to π
    return np.where(weight > 0, θ, np.float32(np.nan))


def _pass(now: _Field, options: FilterOptions, done: int, run: Run) -> _Field:
    """One pass over all pixels after so many others, block by block."""
    radius = _radius(options)
    margin = max(radius, SLOPE_REACH * SLOPE_ROUNDS)
    rows, columns = (size - 2 * radius for size in now.weight.shape)
    step = max(BLOCK_ROWS, BLOCK // columns)
    strips = [
        slice(start, min(start + step, radius + rows))
        for start in range(radius, radius + rows, step)
    ]

    def block(strip: slice) -> _Block:
        above = max(strip.start - margin, 0)
        inner = slice(strip.start - above, strip.stop - above)
        return _Block(now.part(slice(above, strip.stop + margin)), inner)

    work = partial(_filtered, options=options, is_first=done == 0)
    title = f"filtering, pass {done + 1} of {options.iterations}"
    out = replace(now, **{name: getattr(now, name).copy() for name in CHANGED})
    found = zip(strips, run(work, map(block, strips)), strict=True)
    for strip, arrays in tracked(found, title, len(strips)):
        for name, array in zip(CHANGED, arrays, strict=True):
            getattr(out, name)[strip, radius:-radius] = array
    return out


def _filtered(block: _Block, options: FilterOptions, *, is_first: bool) -> list[Pixels]:
    """The arrays `CHANGED` of a block's rows, without margins."""
    slopes = _slopes(block.field)
    start, stop = block.rows.start, block.rows.stop
    step = max(1, STRIP // block.field.weight.shape[1])
    strips = [slice(top, min(top + step, stop)) for top in range(start, stop, step)]
    found = [
        _filtered_strip(block.field, slopes, strip, options, is_first=is_first) for strip in strips
    ]
    return [np.concatenate(arrays) for arrays in zip(*found, strict=True)]


def _filtered_strip(
    now: _Field,
    slopes: tuple[Pixels, Pixels],
    rows: slice,
    options: FilterOptions,
    *,
    is_first: bool,
) -> list[Pixels]:
    """Filter some rows of a padded field.

    What is averaged in a pass was averaged before, together with pixels around it. A window over
    a field of independent errors leaves Σw²s²/(Σw)² of their variance s², and one that has been
    filtered n times by equal windows an n-th of that: precisions add up from pass to pass. (Too
    many are counted where a piece is smaller than n windows together.)

    Args:
        now: What is filtered.
        slopes: Of 2θ along rows and columns, rad per pixel.
        rows: Which.
        options: How much is smoothed.
        is_first: Whether nothing has been filtered yet: then a median stands for the middle.

    Returns:
        The arrays `CHANGED` of these rows, without margins.
    """
    radius = _radius(options)
    here = slice(radius, now.weight.shape[1] - radius)
    middle = now.part(rows, here)
    reach = range(-radius, radius + 1)
    along, up = (slope[rows, here] for slope in slopes)
    pivot_cosine, pivot_sine = middle.cosine, middle.sine
    if is_first:
        calm_cosine, calm_sine, is_off = _median(now, rows, options)
        doubtful = is_off | (middle.variance > options.range**2)
        along, up = (np.where(doubtful, np.float32(0), slope) for slope in (along, up))
        pivot_cosine = np.where(doubtful, calm_cosine, pivot_cosine)
        pivot_sine = np.where(doubtful, calm_sine, pivot_sine)
    turns_across, turns_down = (
        {pixels: _turn(slope, pixels) for pixels in reach} for slope in (along, up)
    )
    # |z − z'| = 2 sin δθ, twice the difference of orientations, and −2 is a Gaussian's.
    apart = np.float32(-2 * 4 * options.deviations**2)
    common = np.float32(-2 * 4 * options.range**2) + apart * middle.variance
    total, cosine, sine, spread, carried = np.zeros((5, *middle.weight.shape), np.float32)
    for down in reach:
        # What is in a row is turned back by the slope along it; instead of by that down to it, too,
        # the pivot is turned to there, and the row's sum back.
        row_cosine = np.zeros(middle.weight.shape, np.float32)
        row_sine = np.zeros(middle.weight.shape, np.float32)
        x, y = turns_down[down]
        p, q = pivot_cosine * x - pivot_sine * y, pivot_sine * x + pivot_cosine * y
        for across in reach:
            if down**2 + across**2 > (REACH * options.spatial) ** 2:
                continue
            other = now.part(
                slice(rows.start + down, rows.stop + down),
                slice(here.start + across, here.stop + across),
            )
            c, s = _turned_back(other.cosine, other.sine, turns_across[across])
            w = (c - p) ** 2
            w += (s - q) ** 2
            w /= common + apart * other.variance
            w -= np.float32(0.5 * (down**2 + across**2) / options.spatial**2)
            np.maximum(w, LOWEST, out=w)
            cv2.exp(w, w)
            w *= other.weight
            total += w
            row_cosine += w * c
            row_sine += w * s
            carried += w * other.variance
            w *= w
            w *= other.first
            spread += w
        row_cosine, row_sine = _turned_back(row_cosine, row_sine, turns_down[down])
        cosine += row_cosine
        sine += row_sine
    length = np.hypot(cosine, sine)
    good = (middle.weight > 0) & (length > 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        precision = total**2 / spread
        if not is_first:
            precision += total / carried
        found = (cosine / length, sine / length, 1 / precision, precision)
        return [
            np.where(good, value, getattr(middle, name))
            for name, value in zip(CHANGED, found, strict=True)
        ]


def _turn(slope: Pixels, pixels: int) -> Turn:
    """Cosine and sine of what a slope grows to over so many pixels."""
    turned = np.float32(pixels) * slope
    return np.cos(turned), np.sin(turned)


def _turned_back(cosine: Pixels, sine: Pixels, by: Turn) -> Turn:
    x, y = by
    back = cosine * x, sine * x
    back[0][:] += sine * y
    back[1][:] -= cosine * y
    return back


def _slopes(now: _Field) -> tuple[Pixels, Pixels]:
    """How 2θ grows along rows and along columns around each pixel, rad per pixel; 0 if unknown."""
    return _slope(now, 1), _slope(now, 0)


def _slope(part: _Field, axis: int) -> Pixels:
    """The mean difference of neighbours along an axis around each pixel, outliers left out.

    They are left out by weights 1/(1 + r²/s²)² of residuals r, s² being their mean square around
    (Geman and McClure's estimator, by reweighting).
    """
    one, other = (
        part.part(*(cut if index == axis else slice(None) for index in (0, 1)))
        for cut in (slice(None, -1), slice(1, None))
    )
    change = np.arctan2(
        one.cosine * other.sine - one.sine * other.cosine,
        one.cosine * other.cosine + one.sine * other.sine,
    )
    paired = (one.weight > 0) & (other.weight > 0)
    with np.errstate(divide="ignore"):  # the margin has no variance
        weight = np.where(paired, 1 / (one.variance + other.variance), np.float32(0))
    # A last line that pairs with nothing, and windows with as many pairs before as after a pixel.
    last = tuple((0, int(index == axis)) for index in (0, 1))
    change, weight, pairs = (
        np.pad(array.astype(np.float32), last) for array in (change, weight, paired)
    )
    reach = 2 * SLOPE_REACH + 1
    size = (reach, reach - 1) if axis == 0 else (reach - 1, reach)

    def around(values: NDArray[np.floating]) -> Pixels:
        middle = (SLOPE_REACH, SLOPE_REACH)
        sums = cv2.boxFilter(
            values, -1, size, anchor=middle, normalize=False, borderType=cv2.BORDER_CONSTANT
        )
        return np.asarray(sums, np.float32)

    some = around(pairs) > 0.5
    slope, now = np.zeros_like(change), weight
    for left in reversed(range(SLOPE_ROUNDS)):
        sums = np.where(some, around(now), np.float32(1))
        slope = np.where(some, around(now * change) / sums, np.float32(0))
        if left:
            rest = np.square(change - slope)
            scale = np.where(some, around(now * rest) / sums, np.float32(0))
            now = weight / (1 + rest / (scale + np.float32(LEAST))) ** 2
    return slope


def _median(
    now: _Field, rows: slice, options: FilterOptions
) -> tuple[Pixels, Pixels, NDArray[np.bool_]]:
    """Of 3 × 3 pixels the one from which all are least far, by their weights.

    Returns:
        cos 2θ and sin 2θ of it, and where it is to be believed rather than the middle.
    """
    radius, width = _radius(options), now.weight.shape[1]
    window = [
        now.part(
            slice(rows.start + down, rows.stop + down),
            slice(radius + across, width - radius + across),
        )
        for down in (-1, 0, 1)
        for across in (-1, 0, 1)
    ]
    cost = np.zeros((len(window), *window[0].weight.shape), np.float32)
    for i, one in enumerate(window):
        for j, other in enumerate(window[:i]):
            apart = np.hypot(one.cosine - other.cosine, one.sine - other.sine)
            cost[i] += other.weight * apart
            cost[j] += one.weight * apart
    for i, one in enumerate(window):
        cost[i][one.weight == 0] = np.inf
    best = cost.argmin(axis=0)
    cosine, sine, variance = (
        np.asarray(np.choose(best, [getattr(one, name) for one in window]), np.float32)
        for name in ("cosine", "sine", "variance")
    )
    middle = window[len(window) // 2]
    own = (middle.cosine, middle.sine, middle.variance)
    with_middle, with_median = (
        np.sum([_alike(other, *one, options) for other in window], axis=0)
        for one in (own, (cosine, sine, variance))
    )
    known = np.sum([other.weight > 0 for other in window], axis=0)
    is_off = np.asarray((with_middle <= STROKE) & (2 * with_median > known), bool)
    return cosine, sine, is_off


def _alike(
    other: _Field, cosine: Pixels, sine: Pixels, variance: Pixels, options: FilterOptions
) -> NDArray[np.bool_]:
    """Whether pixels of a field are known and, as far as they are, like others."""
    apart = (other.cosine - cosine) ** 2 + (other.sine - sine) ** 2
    both = options.range**2 + options.deviations**2 * (other.variance + variance)
    return (other.weight > 0) & (apart < 4 * NEAR**2 * both)
