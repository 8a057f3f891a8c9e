"""The circle on which gratings' modulations lie, whatever their orientations are.

All gratings of a foil modulate a polariser's light alike, A cos(2ψ − η) of their mean: their points
A e^{iη}/c lie on one circle. What a mirror under retarding plastic modulates by itself, and what is
left of an uneven spread of orientations in the means that photographs are divided by, moves all
points alike: the circle's centre. Bare mirrors lie in it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from precompute.acquisition.polarization_fit import HarmonicFit

Array = NDArray[np.float64]
Points = NDArray[np.complexfloating]

MOST = 2**18
"""Pixels that a circle is fitted to, picked evenly: enough by far for three numbers."""

ROUNDS = 10
"""Of leaving out what lies off the circle; two or three decide it."""

TRIALS, JUDGES = 3000, 1000
"""Circles that are tried, through three pixels each, and pixels that judge them. Where 70 % of all
are bare, 3 % of triples lie on the circle: 80."""

AGREE = 0.85
"""Share of pixels that a circle is judged by: the others may lie anywhere."""

LEAST = 0.01
"""Of the smallest eigenvalue of a fit's normal matrix over its pixels: below it, as of two clusters
or a short arc, a circle is known no better than to ten times what pixels are off."""


@dataclass(frozen=True)
class PhaseCircle:
    """The circle.

    Attributes:
        centre: Common to all pixels.
        radius: A/c of the gratings.
        scatter: Standard deviation of pixels' distances from the centre; of those near the circle.
        known: Whether orientations are spread enough to tell; else the centre is 0.
    """

    centre: complex
    radius: float
    scatter: float
    known: bool


def modulations(fit: HarmonicFit) -> NDArray[np.complex64]:
    """A e^{iη}/c of pixels, of the fit's shape; NaN where they are unknown or dark."""
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = np.where(fit.mean > 0, fit.amplitude / fit.mean, np.float32(np.nan))
    return (relative * np.exp(1j * fit.phase)).astype(np.complex64)


def phase_circle(points: Points) -> PhaseCircle:
    """Fit the circle to pixels that lie on it, in its middle, or, few of them, elsewhere.

    It starts from the best of many circles through three pixels (least quantiles of distances,
    Rousseeuw 1984); what lies off it by more than noise, or half its radius, is then left out.
    Where half of all pixels are bare, noise has to stay below a tenth of the radius, else a circle
    through their middle may do as well: then bare ones are better left out beforehand.

    Args:
        points: A e^{iη}/c (`modulations`) of pixels, any shape; NaN is left out.
    """
    picked = points[np.isfinite(points)].ravel()
    picked = picked[:: max(1, -(-picked.size // MOST))].astype(np.complex128)
    if picked.size < 3:
        return PhaseCircle(0j, float(np.abs(picked).mean()) if picked.size else 0.0, 0.0, False)
    centre, radius, noise = _best_of_trials(picked)
    kept = np.zeros(picked.shape, bool)
    for _ in range(ROUNDS):
        band = np.clip(3 * noise, 1e-6 * radius, radius / 2)
        near = np.abs(np.abs(picked - centre) - radius) < band
        if np.array_equal(near, kept) or np.count_nonzero(near) < 3:
            break
        kept = near
        centre, radius = _taubin(picked[kept])
    away = picked[kept] - centre
    known = bool(np.isfinite(radius)) and away.size > 0 and _spread(away) >= LEAST
    if not known:
        centre, away = 0j, picked
        radius = float(np.abs(away).mean())
    return PhaseCircle(centre, radius, float(np.std(np.abs(away))), known)


def centred(fit: HarmonicFit, circle: PhaseCircle) -> HarmonicFit:
    """The fit with phases and amplitudes counted from the circle's centre."""
    away = modulations(fit) - np.complex64(circle.centre)
    return replace(fit, phase=np.angle(away), amplitude=np.abs(away) * fit.mean)


def _best_of_trials(points: NDArray[np.complex128]) -> tuple[complex, float, float]:
    """Of circles through three points that from which, or from whose centre, most are least off.

    Returns:
        Its centre, its radius, and how far off those are.
    """
    rng = np.random.default_rng(1)
    one, two, three = points[rng.integers(points.size, size=(3, TRIALS))]
    judges = points[rng.integers(points.size, size=min(JUDGES, points.size))]
    # |z − c|² is the same for three points: with the first as origin c·z = |z|²/2 for the others.
    first, second = two - one, three - one
    area = 2 * (first.real * second.imag - first.imag * second.real)
    turned = np.abs(first) ** 2 * second - np.abs(second) ** 2 * first
    apart = np.abs(area) > 0
    towards = -1j * turned[apart] / area[apart]
    best = 0j, 0.0, np.inf
    for centre, radius in zip(one[apart] + towards, np.abs(towards), strict=True):
        away = np.abs(judges - centre)
        off = float(np.quantile(np.minimum(away, np.abs(away - radius)), AGREE))
        if off < best[2]:
            best = complex(centre), float(radius), off
    return best


def _spread(away: Points) -> float:
    """Smallest eigenvalue of what changes of centre and radius do to distances, over pixels."""
    direction = away / np.maximum(np.abs(away), np.finfo(float).tiny)
    rows = np.stack([direction.real, direction.imag, np.ones(away.size)])
    return float(np.linalg.eigvalsh(rows @ rows.T / away.size)[0])


def _taubin(points: NDArray[np.complex128]) -> tuple[complex, float]:
    """Centre and radius by Taubin's fit (1991): Σ(α|z|² + β·z + γ)² over Σ|its gradient|², least.

    Algebraic, so without iterations, and free of the small radii that Σ(|z − c|² − r²)² prefers.
    Infinite radii of points on a line come out as NaN or very large.
    """
    middle = points.mean()
    z = points - middle
    square = np.abs(z) ** 2
    mean = square.mean()
    # With α = α'/(2√mean) the constraint is the length of (α', β); γ follows from the means.
    scale = 2 * np.sqrt(mean)
    if scale == 0:
        return complex(middle), 0.0
    columns = np.stack([(square - mean) / scale, z.real, z.imag])
    _, vectors = np.linalg.eigh(columns @ columns.T)
    α, x, y = vectors[0, 0] / scale, vectors[1, 0], vectors[2, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        centre = -(x + 1j * y) / (2 * α)
        radius = np.sqrt(abs(centre) ** 2 + mean)
    return complex(middle + centre), float(radius)
