"""Noise and small bumps taken out of measured orientations, the edges between gratings kept.

An iterated bilateral filter in (cos 2θ, sin 2θ), after the 2018 paper's sections 5.3 and 6.2:
pixels that do not diffract are left out, what a fit is sure of weighs more, and values are compared
with the median of a small window in place of the middle pixel, which may itself be what is off.

Other than in the paper

- the comparison's width is not one number: a pair of values is compared by what both are known to.
  Noisy pixels reach far, and what has been averaged reaches less far with every pass, so that
  steps do not wear down as they do under a constant width;
- the median serves the first pass alone: later it would round off corners, a pixel a pass;
- from the second pass on orientations are compared, and averaged, as they are less the slope around
  a pixel. Else passes make stairs of whatever turns steadily, as kinematic discs do.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from os import cpu_count

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from precompute.errors import InputError

Pixels = NDArray[np.float32]

REACH = 2.0
"""Windows end at so many standard deviations."""

LEAST, MOST = 1e-4, 2.0
"""Uncertainties, rad, are taken as no smaller, which keeps squares of weights within single
precision, and as no larger, from where on they all mean the same: not known."""

BLOCK = 2**15
"""Pixels that are filtered at once: what is kept of them fits into a processor's cache."""


SLOPE_REACH, SLOPE_ROUNDS = 4, 4
"""A slope is that of pixels no further than so, row- and columnwise; in so many rounds what differs
from the others there, a step, is left out."""

SLOPE_ROWS = 256
"""Rows whose slopes are found at once."""


@dataclass(frozen=True)
class FilterOptions:
    """How much is smoothed.

    Attributes:
        spatial: Standard deviation of the window, pixels.
        range: Difference of orientations, rad, that is smoothed away however well both are known:
            bumps. A standard deviation, in 2 sin δθ ≈ 2δθ.
        deviations: And so many standard deviations of the two values that are compared.
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
    """

    cosine: Pixels
    sine: Pixels
    variance: Pixels
    weight: Pixels

    def part(self, rows: slice, columns: slice) -> _Field:
        return _Field(*(array[rows, columns] for array in vars(self).values()))


def filtered_orientation(
    orientation: ArrayLike,
    uncertainty: ArrayLike,
    mask: ArrayLike,
    options: FilterOptions | None = None,
    passed: Callable[[int, Pixels], None] | None = None,
) -> FilteredOrientation:
    """Filter a map of orientations.

    Args:
        orientation: θ, rad, any number standing for itself modulo π. Shape (rows, columns).
        uncertainty: Its standard deviation, rad, above 0: that shape, or one number for all.
        mask: Which pixels diffract, of that shape. Those whose orientation or uncertainty is NaN
            are taken as if they did not.
        options: How much is smoothed.
        passed: Told the number of passes done and θ after each of them.

    Raises:
        InputError: Shapes differ, an uncertainty is not above 0, or an option is out of range.
    """
    options = options or FilterOptions()
    θ = np.asarray(orientation, np.float32)
    known, σ = _checked(θ, uncertainty, mask)
    radius = int(np.ceil(REACH * options.spatial))
    now = _field(θ, σ, known, radius)
    first = now.variance
    for done in range(options.iterations):
        now = _pass(now, first, options, radius, is_first=done == 0)
        if passed is not None:
            passed(done + 1, _orientation(now, radius))
    return FilteredOrientation(
        _orientation(now, radius),
        np.where(known, np.sqrt(_inner(now.variance, radius)), np.float32(np.nan)),
    )


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


def _pass(
    now: _Field, first: Pixels, options: FilterOptions, radius: int, *, is_first: bool
) -> _Field:
    """One pass over all pixels, strip by strip."""
    out = _Field(*(array.copy() for array in vars(now).values()))
    slopes = None if is_first else _slopes(now)
    rows, columns = (size - 2 * radius for size in now.weight.shape)
    step = max(1, BLOCK // columns)

    def filter_strip(start: int) -> None:
        some = slice(radius + start, radius + min(start + step, rows))
        _filter_strip(now, first, slopes, out, some, options, radius)

    with ThreadPoolExecutor(cpu_count()) as pool:
        for _ in pool.map(filter_strip, range(0, rows, step)):
            pass
    return out


def _filter_strip(
    now: _Field,
    first: Pixels,
    slopes: tuple[Pixels, Pixels] | None,
    out: _Field,
    rows: slice,
    options: FilterOptions,
    radius: int,
) -> None:
    """Filter some rows of a padded field into another.

    What is averaged in a pass was averaged before, together with pixels around it. A window over
    a field of independent errors leaves Σw²s²/(Σw)² of their variance s², and one that has been
    filtered n times by equal windows an n-th of that: precisions add up from pass to pass. (Too
    many are counted where a piece is smaller than n windows together.)

    Args:
        now: What is filtered.
        first: The variance of what went into the first pass.
        slopes: Of 2θ along rows and columns, rad per pixel; in the first pass there are none, and
            the window's median stands for its middle.
        out: Where results go.
        rows: Which.
        options: How much is smoothed.
        radius: Of the window, and margin of the field.
    """
    here = slice(radius, now.weight.shape[1] - radius)
    middle = now.part(rows, here)
    if slopes is None:
        pivot_cosine, pivot_sine = _median(now, rows, radius)
    else:
        pivot_cosine, pivot_sine = middle.cosine, middle.sine
    # |z − z'| = 2 sin δθ, twice the difference of orientations.
    apart = np.float32(4 * options.deviations**2)
    common = np.float32(4 * options.range**2) + apart * middle.variance
    total, cosine, sine, spread, carried = np.zeros((5, *middle.weight.shape), np.float32)
    for down in range(-radius, radius + 1):
        for across in range(-radius, radius + 1):
            if down**2 + across**2 > (REACH * options.spatial) ** 2:
                continue
            there = (
                slice(rows.start + down, rows.stop + down),
                slice(here.start + across, here.stop + across),
            )
            other = now.part(*there)
            c, s = other.cosine, other.sine
            if slopes is not None:
                along, up = slopes
                turned = np.float32(across) * along[rows, here]
                turned += np.float32(down) * up[rows, here]
                x, y = np.cos(turned), np.sin(turned)
                c, s = c * x + s * y, s * x - c * y
            w = (c - pivot_cosine) ** 2
            w += (s - pivot_sine) ** 2
            w /= common + apart * other.variance
            w *= np.float32(-0.5)
            w -= np.float32(0.5 * (down**2 + across**2) / options.spatial**2)
            np.exp(w, out=w)
            w *= other.weight
            total += w
            cosine += w * c
            sine += w * s
            carried += w * other.variance
            w *= w
            w *= first[there]
            spread += w
    length = np.hypot(cosine, sine)
    good = (middle.weight > 0) & (length > 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        precision = total**2 / spread
        if slopes is not None:
            precision += total / carried
        for array, value in (
            (out.cosine, cosine / length),
            (out.sine, sine / length),
            (out.variance, 1 / precision),
            (out.weight, precision),
        ):
            array[rows, here] = np.where(good, value, array[rows, here])


def _slopes(now: _Field) -> tuple[Pixels, Pixels]:
    """How 2θ grows along rows and along columns around each pixel, rad per pixel; 0 if unknown."""
    rows = now.weight.shape[0]
    margin = SLOPE_REACH * SLOPE_ROUNDS
    found = np.zeros((2, *now.weight.shape), np.float32)
    for start in range(0, rows, SLOPE_ROWS):
        stop = min(start + SLOPE_ROWS, rows)
        above = max(start - margin, 0)
        part = now.part(slice(above, min(stop + margin, rows)), slice(None))
        for axis in (0, 1):
            slope = _slope(part, axis)
            found[axis, start:stop] = slope[start - above : stop - above]
    return found[1], found[0]


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


def _median(now: _Field, rows: slice, radius: int) -> tuple[Pixels, Pixels]:
    """Of 3 × 3 pixels the one from which all are least far, by their weights: (cos 2θ, sin 2θ)."""
    width = now.weight.shape[1]
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
    return (
        np.choose(best, [one.cosine for one in window]),
        np.choose(best, [one.sine for one in window]),
    )
