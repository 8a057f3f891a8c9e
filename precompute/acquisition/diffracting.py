"""Which pixels diffract, and their harmonics counted from the middle of their circle.

A pixel that diffracts lies on the circle of its kind (`phase_circle`), one that is bare in its
middle. So what tells them apart is the squared distance from the middle, less what noise adds to
it: unlike the point itself it may be averaged over neighbours of other orientations.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter

from precompute.acquisition.blocks import Run, in_threads
from precompute.acquisition.foretold import misfits
from precompute.acquisition.phase_circle import PhaseCircle, centred, modulations, phase_circle
from precompute.acquisition.polarization_fit import (
    HarmonicFit,
    Harmonics,
    Pixels,
    fitted,
    photograph_means,
)
from precompute.errors import InputError

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

JUDGED = 2**20
"""Pixels, picked evenly, over which means and the circle are found."""

DARK = 0.03
"""Of the brightness that a tenth of pixels exceed: what is darker shows no grating."""

INSIDE = 0.5
"""Distance from the middle over the radius from which a pixel diffracts."""

WIDER = 3.0
"""Half the side, px, over which squared distances are averaged, over noise in radii: what is
averaged is then uncertain by a sixth of the squared radius or less."""

LAG, ALIKE = 4, 0.02
"""Pixels between those that are compared, beyond what interpolation mixes, and how alike they have
to be: gratings are 0.1 to 1, noise is 0."""


@dataclass(frozen=True)
class Diffracting:
    """What photographs show of gratings, arrays of shape (rows, columns).

    Attributes:
        fit: Phases and amplitudes counted from the circle's middle.
        circle: The circle.
        mask: Which pixels diffract.
        noise: Standard deviation of a pixel's phase, rad: that of its amplitude over it.
        misfits: Of each photograph, no unit, see `foretold.misfits`.
    """

    fit: HarmonicFit
    circle: PhaseCircle
    mask: Mask
    noise: Pixels
    misfits: Array


def diffracting(light: Pixels, polariser: Array, run: Run = in_threads) -> Diffracting:
    """Fit photographs that lie on one another, and find who diffracts.

    Args:
        light: Shape (photographs, rows, columns), NaN where it is unknown.
        polariser: ψ of each photograph, rad.
        run: Fits blocks.

    Raises:
        InputError: Fewer than three angles differ modulo π, or no pixel diffracts.
    """
    step = max(1, round(float(np.sqrt(light[0].size / JUDGED))))
    some = np.asarray(light[:, ::step, ::step])
    known = np.asarray(np.isfinite(some).all(axis=0))
    _check_any(known)
    # Over bare pixels too: what they add to the means moves all points alike, as the circle is.
    harmonics = Harmonics.of(polariser, photograph_means(some, known))
    fit = fitted(some, harmonics, run)
    apart = misfits(some, harmonics, fit)
    judges = _bright(fit)
    circle = phase_circle(modulations(fit)[judges], _seen_noise(fit, polariser)[judges])
    fit = centred(fitted(light, harmonics, run), circle)
    bright = _bright(fit)
    alike, least = _alikeness(fit, bright)
    if alike < least:
        found = f"light whose change by the polariser is alike in neighbours by {alike:.3f}"
        expected = f"{least:.3f} or more, as of gratings of several orientations"
        raise InputError("photographs", "diffracting pixels", found, expected)
    mask = _mask(fit, bright, circle, polariser)
    _check_any(mask)
    with np.errstate(divide="ignore", invalid="ignore"):
        noise = _noise(fit, circle, polariser) / fit.amplitude
    return Diffracting(fit, circle, mask, np.asarray(noise, np.float32), apart)


def _check_any(mask: Mask) -> None:
    if not mask.any():
        raise InputError("photographs", "diffracting pixels", 0, "light that the polariser changes")


def _bright(fit: HarmonicFit) -> Mask:
    """Pixels that are known and not dark."""
    known = np.isfinite(fit.mean)
    _check_any(known)
    return known & (fit.mean > DARK * np.percentile(fit.mean[known], 90))


def _seen_noise(fit: HarmonicFit, polariser: Array) -> Pixels:
    """Standard deviation of each component of a pixel's A e^{iη}/c, before a circle is known.

    Three photographs leave no residual: then it is what neighbours differ by, of which a fifth at
    the least are taken to show the same, whatever their brightness.
    """
    photographs = len(polariser)
    if photographs > 3:
        nothing = PhaseCircle(0j, 0.0, 0.0, False)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(_noise(fit, nothing, polariser) / fit.mean, np.float32)
    swing = fit.amplitude * np.exp(1j * fit.phase)
    apart = np.abs(swing[:, 1:] - swing[:, :-1]) ** 2
    apart = apart[np.isfinite(apart)]
    if apart.size == 0:
        return np.zeros(fit.mean.shape, np.float32)
    # |z − z'|² is spread exponentially about 4σ², a fifth of it below log(5/4) of that.
    variance = float(np.quantile(apart, 0.2)) / (4 * np.log(5 / 4))
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.sqrt(variance) / fit.mean, np.float32)


def _noise(fit: HarmonicFit, circle: PhaseCircle, polariser: Array) -> Pixels:
    """Standard deviation of each component of a pixel's A e^{iη}.

    Residuals of few photographs are uncertain themselves, so each is taken together with three of
    what is usual. Three photographs leave none: then it is pixels' distances from the circle, as
    noise moves a point along the circle as much as across.
    """
    photographs = len(polariser)
    if photographs == 3:
        return np.asarray(circle.scatter * fit.mean, np.float32)
    usual = np.nanmedian(fit.residual**2)
    free = photographs - 3
    variance = (free * fit.residual**2 + 3 * usual) / (free + 3)
    return np.asarray(np.sqrt(2 / photographs * variance), np.float32)


def _mask(fit: HarmonicFit, bright: Mask, circle: PhaseCircle, polariser: Array) -> Mask:
    with np.errstate(divide="ignore", invalid="ignore"):
        noise = _noise(fit, circle, polariser) / fit.mean
        excess = (fit.amplitude / fit.mean) ** 2 - 2 * noise**2
    share = float(np.median(noise[bright])) / max(circle.radius, 1e-12)
    side = 2 * int(np.ceil(WIDER * share)) + 1 if share > 1 / 6 else 1
    if side > 1:
        weight = uniform_filter(bright.astype(np.float32), side)
        excess = uniform_filter(np.where(bright, excess, 0), side) / np.maximum(weight, 1e-6)
    return bright & (excess > (INSIDE * circle.radius) ** 2)


def _alikeness(fit: HarmonicFit, bright: Mask) -> tuple[float, float]:
    """How alike neighbours' A e^{iη}/c are, 0 to 1, and what chance might bring."""
    points = np.where(bright, modulations(fit), np.complex64(0)).astype(np.complex64)
    both = bright[:, LAG:] & bright[:, :-LAG]
    left, right = points[:, :-LAG][both], points[:, LAG:][both]
    if left.size == 0:
        return 0.0, ALIKE
    power = float((np.abs(left) ** 2 + np.abs(right) ** 2).sum(dtype=np.float64)) / 2
    together = np.sum(left.real * right.real + left.imag * right.imag, dtype=np.float64)
    alike = float(together) / max(power, 1e-30)
    return alike, max(ALIKE, 4 / np.sqrt(left.size))
