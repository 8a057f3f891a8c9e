"""The harmonic of light through a turning polariser: a linear fit to each pixel by itself.

What leaves a point is made of 1, cos 2ψ and sin 2ψ of the polariser's angle ψ alone
(docs/theory/polarisation.md): three numbers a pixel, by linear least squares from any three angles.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import partial

import numpy as np
from numpy.typing import NDArray

from precompute.acquisition.blocks import Run, in_threads
from precompute.errors import InputError
from precompute.progress import tracked

Array = NDArray[np.float64]
Pixels = NDArray[np.float32]

APART = np.radians(1.0)
"""Angles that are nearer than this are one: from three such noise comes out a thousandfold."""

BLOCK = 2**16
"""Pixels that are fitted at once: what is kept of them fits into a processor's cache."""


@dataclass(frozen=True)
class Harmonics:
    """What photographs over their means are fitted by: 1, cos 2ψ/m and sin 2ψ/m.

    A mirror under retarding plastic modulates light too, the same in all pixels, by some m(ψ), and
    the panel's light drifts. Each photograph over its mean is rid of both,

        I/mean = g (1 + A cos(2ψ − η)/m(ψ))

    if orientations are spread evenly, so that their own modulations cancel in the mean. The 2018
    paper takes the mean away instead, which does as much where all pixels are equally bright.

    Attributes:
        columns: cos 2ψ/m and sin 2ψ/m, each less its mean, shape (2, photographs).
        middles: Their means.
        means: What photographs are divided by.
    """

    columns: Array
    middles: Array
    means: Array

    @staticmethod
    def of(polariser: Array, means: Array | None = None) -> Harmonics:
        """The columns for photographs.

        Args:
            polariser: ψ of each, rad.
            means: Of each over pixels whose modulations cancel: all that diffract, or bare ones
                alone. Without them photographs are taken as they are.

        Raises:
            InputError: Fewer than three angles differ modulo π, or a mean is not above 0.
        """
        ψ = np.asarray(polariser, np.float64)
        apart = distinct_angles(ψ)
        if apart < 3:
            stated = np.degrees(ψ).round(3).tolist()
            expected = f"three angles that differ modulo 180°, not {apart}"
            raise InputError("photographs", "polariser_deg", stated, expected)
        harmonic = np.stack([np.ones_like(ψ), np.cos(2 * ψ), np.sin(2 * ψ)])
        if means is None:
            divisors = common = np.ones_like(ψ)
        else:
            divisors = np.asarray(means, np.float64)
            _check_means(divisors)
            constant, *swing = np.linalg.lstsq(harmonic.T, divisors)[0]
            common = 1 + swing @ harmonic[1:] / constant
            _check_means(common)
        columns = harmonic[1:] / common
        middles = columns.mean(axis=1)
        return Harmonics(columns - middles[:, None], middles, divisors)


@dataclass(frozen=True)
class HarmonicFit:
    """c + A cos(2ψ − η) at each pixel, arrays of one shape; NaN where a photograph is NaN.

    Attributes:
        phase: η, rad, −π to π: θ is half of it up to one offset.
        amplitude: A.
        mean: c.
        residual: Standard deviation of photographs from the fit, three numbers being fitted; NaN of
            three photographs. Below some 1e-3 A it is rounding.
        correlation: Of photographs and fit over ψ, 0 to 1; NaN where a pixel never changes.
    """

    phase: Pixels
    amplitude: Pixels
    mean: Pixels
    residual: Pixels
    correlation: Pixels


def repeated_angles(polariser: Array) -> list[list[int]]:
    """Which of angles, rad, are one modulo π, none being `APART` from the next: two or more each.

    Args:
        polariser: Angles, rad, shape (n,).


    >>> repeated_angles(np.radians([0, 45, 90, 135, 180]))
    [[0, 4]]
    """
    turned = np.mod(polariser, np.pi)
    order = np.argsort(turned, kind="stable")
    # Begin after a gap, so that none goes on where the half turn does.
    gaps = np.diff(turned[order], append=turned[order[0]] + np.pi)
    first = int(np.argmax(gaps)) + 1
    order, gaps = np.roll(order, -first), np.roll(gaps, -first)
    groups = np.split(order, np.flatnonzero(gaps[:-1] >= APART) + 1)
    return sorted(sorted(group.tolist()) for group in groups if len(group) > 1)


def distinct_angles(polariser: Array) -> int:
    """How many of angles, rad, differ modulo π by `APART` or more.

    Args:
        polariser: Angles, rad, shape (n,).


    >>> distinct_angles(np.radians([0, 45, 90, 135, 180]))
    4
    """
    within = np.sort(np.mod(polariser, np.pi))
    # Going round the half turn once, from each to the next; a single one is π from itself.
    gaps = np.diff(within, append=within[0] + np.pi)
    return max(int(np.count_nonzero(gaps >= APART)), 1)


def photograph_means(photographs: Pixels, mask: NDArray[np.bool_]) -> Array:
    """The mean of each photograph over pixels of a mask, in its unit.

    Args:
        photographs: Shape (photographs, rows, columns); NaN is left out.
        mask: Shape (rows, columns).

    Raises:
        InputError: The mask is empty, or a photograph has nothing but NaN there.
    """
    means = np.full(len(photographs), np.nan)
    for index, photograph in enumerate(photographs):
        values = photograph[mask]
        values = values[np.isfinite(values)]
        if values.size == 0:
            raise InputError("photographs", f"{index}", "no pixel", "one that diffracts, or more")
        means[index] = values.mean(dtype=np.float64)
    return means


def fitted(photographs: Pixels, harmonics: Harmonics, run: Run = in_threads) -> HarmonicFit:
    """Fit all pixels of photographs that lie on one another.

    Args:
        photographs: Shape (photographs, rows, columns); may be mapped from a file.
        harmonics: Of their angles.
        run: Fits blocks of rows; what comes out does not depend on how many these are.

    Returns:
        Arrays of shape (rows, columns).
    """
    rows, columns = photographs.shape[1:]
    out = HarmonicFit(*(np.empty((rows, columns), np.float32) for _ in fields(HarmonicFit)))
    step = max(1, BLOCK // columns)
    strips = [slice(start, start + step) for start in range(0, rows, step)]
    values = np.asarray(photographs)
    fits = run(partial(fit_block, harmonics=harmonics), (values[:, strip] for strip in strips))
    for strip, fit in tracked(zip(strips, fits, strict=True), "fitting", len(strips)):
        for part in fields(HarmonicFit):
            getattr(out, part.name)[strip] = getattr(fit, part.name)
    return out


def fit_block(values: Pixels, harmonics: Harmonics) -> HarmonicFit:
    """Fit pixels.

    Sums are of differences from the first photograph: these are as small as what is sought, and
    single precision holds them to some millionths of it.

    Args:
        values: Shape (photographs, …).
        harmonics: Of the photographs' angles.

    Returns:
        Arrays of the shape of one photograph.
    """
    count = len(values)
    (u, v), factors = harmonics.columns, 1 / harmonics.means
    first = values[0] * np.float32(factors[0])
    total, along_u, along_v, squares = np.zeros((4, *values.shape[1:]), np.float32)
    for k in range(1, count):
        change = values[k] * np.float32(factors[k])
        change -= first
        total += change
        along_u += np.float32(u[k]) * change
        along_v += np.float32(v[k]) * change
        change *= change
        squares += change
    # Normal equations of the two columns, whose sums over photographs are 0.
    inverse = np.linalg.inv(harmonics.columns @ harmonics.columns.T).astype(np.float32)
    a = inverse[0, 0] * along_u + inverse[0, 1] * along_v
    b = inverse[1, 0] * along_u + inverse[1, 1] * along_v
    explained = a * along_u + b * along_v
    total /= np.float32(count)
    squares -= np.float32(count) * total * total
    middle_u, middle_v = harmonics.middles.astype(np.float32)
    rest = np.maximum(squares - explained, 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        residual = np.sqrt(rest / np.float32(count - 3)) if count > 3 else np.full_like(a, np.nan)
        correlation = np.sqrt(np.clip(explained / squares, 0, 1))
    return HarmonicFit(
        phase=np.arctan2(b, a),
        amplitude=np.hypot(a, b),
        mean=first + total - a * middle_u - b * middle_v,
        residual=residual,
        correlation=correlation,
    )


def _check_means(means: Array) -> None:
    if not np.all(means > 0):
        raise InputError("photographs", "mean", float(means.min()), "above 0, light")
