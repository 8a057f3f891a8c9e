"""The circle on which gratings' modulations lie, whatever their orientations are.

All gratings of a foil modulate a polariser's light alike, A cos(2ψ − η) of their mean: their points
A e^{iη}/c lie on one circle. What a mirror under retarding plastic modulates by itself, and what is
left of an uneven spread of orientations in the means that photographs are divided by, moves all
points alike: the circle's centre. Bare mirrors lie in it, matt ground elsewhere.

Bare pixels may be most of all. They are a cluster as wide as noise, which may be one orientation's
as well; so where it lies says nothing of the circle, and the others decide.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import i0e, i1e

from precompute.acquisition.polarization_fit import HarmonicFit

Array = NDArray[np.float64]
Complexes = NDArray[np.complex128]
Points = NDArray[np.complexfloating]

MOST = 2**14
"""Pixels, picked at random, that a circle is fitted to: enough where 3 % lie on it."""

TRIALS, CENTRES, JUDGES = 1000, 400, 1000
"""Circles and middles of the cluster that are tried, and pixels that judge them."""

FITTED = 2**12
"""Pixels from which the best circles are compared."""

KEPT = 3
"""Of the best circles of each kind, from which the fit starts."""

ROUNDS = 40
"""Of a fit; most need five to ten."""

OUTSKIRTS = 3.5
"""Standard deviations from a cluster's middle to which it is counted: 2 in 1000 lie beyond."""

INEXACT = 0.01
"""What models leave out (haze, oblique light, retardation to second order), over the radius within
which nearly all points lie. It is added to noise."""

SMALLEST = 1.5
"""Radius over the usual noise below which a circle is a wide cluster."""

LEAST = 0.01
"""Of the smallest eigenvalue of a fit's normal matrix over its pixels: below it, as of two clusters
or a short arc, a circle is known no better than to ten times what pixels are off."""

HALF, THIRD = 0.5, 0.4
"""Share of a cluster from which it is taken for bare, and up to which for one of three
orientations, where two others are all that is left."""

FEW = 0.05
"""As `LEAST`, below which others than the cluster are of two orientations, or an arc of 150°."""

LOOSE = 0.1
"""Of the radius, by which points may lie off the circle beside noise: pixels at edges, ellipses."""

FULL = 4.0
"""Points on a circle over what one as large as all that is seen would have, evenly lit."""

FREE = 8.0
"""Degrees of freedom of Student's distribution: a pixel's residual of some eight photographs."""

ONE = 0.95
"""Length of the mean direction, from a bare middle, of pixels of one orientation."""


@dataclass(frozen=True)
class PhaseCircle:
    """The circle.

    Attributes:
        centre: Common to all pixels.
        radius: A/c of the gratings.
        scatter: Standard deviation of pixels' distances from the centre; of those near the circle.
        known: Whether points tell it; else the centre is 0.
    """

    centre: complex
    radius: float
    scatter: float
    known: bool


def modulations(fit: HarmonicFit) -> NDArray[np.complex64]:
    """A e^{iη}/c of pixels, no unit, of the fit's shape; NaN where they are unknown or dark."""
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = np.where(fit.mean > 0, fit.amplitude / fit.mean, np.float32(np.nan))
    return (relative * np.exp(1j * fit.phase)).astype(np.complex64)


def phase_circle(points: Points, noise: ArrayLike = 0.0) -> PhaseCircle:
    """Fit the circle to pixels that lie on it, in its middle, in a cluster, or, few, elsewhere.

    Points are a mixture of those four, each as wide as its own noise: maximum likelihood, from the
    best of many circles through three pixels of which the densest cluster has a quarter or less,
    and of circles about that cluster.

    It is unknown where a wider cluster explains points as well, and where orientations are too few
    or too near. Two orientations and a cluster are taken for three orientations where that has less
    than `THIRD` of all, for bare pixels in the middle of two where it has `HALF` or more.

    Args:
        points: A e^{iη}/c (`modulations`) of pixels, any shape; NaN is left out.
        noise: Standard deviation of each component of a point, of a shape that goes with points'.
    """
    every = np.broadcast_to(noise, points.shape)
    there = np.isfinite(points) & np.isfinite(every)
    rng = np.random.default_rng(1)
    z, σ = points[there].astype(np.complex128), every[there].astype(np.float64)
    picked = rng.permutation(z.size)[:MOST]
    z, σ = z[picked], σ[picked]
    if z.size < 3:
        return PhaseCircle(0j, float(np.abs(z).mean()) if z.size else 0.0, 0.0, False)
    unknown = PhaseCircle(0j, float(np.abs(z).mean()), float(np.std(np.abs(z))), False)
    scene = _Scene.of(z, σ)
    if scene.reach == 0:
        return unknown
    through, about = scene.trials(rng)
    fit = _decided(scene, scene.best(*through), scene.best(*about))
    if fit is None and scene.share < THIRD:
        # Two orientations beside the cluster, which is taken for a third.
        fit = replace(scene, share=0.0).best(*through)
        if fit is not None and _spread(z, fit, fit.on > 0.5) < LEAST:
            fit = None
    if fit is None or scene.likelihood(fit) < scene.halo() + 3 * np.log(z.size):
        return unknown
    off = np.abs(z - fit.centre) - fit.radius
    scatter = float(np.sqrt(np.average(off**2, weights=fit.on)))
    return PhaseCircle(fit.centre, fit.radius, scatter, True)


def centred(fit: HarmonicFit, circle: PhaseCircle) -> HarmonicFit:
    """The fit with phases and amplitudes counted from the circle's centre."""
    away = modulations(fit) - np.complex64(circle.centre)
    return replace(fit, phase=np.angle(away), amplitude=np.abs(away) * fit.mean)


@dataclass(frozen=True)
class _Fit:
    """A circle.

    Attributes:
        centre: Its middle.
        radius: Its radius.
        loose: Standard deviation of points' distances from it beside noise.
        explained: Sum over points of logarithms of how well they agree with all that is there.
        on: Each point's probability to lie on it.
    """

    centre: complex
    radius: float
    loose: float
    explained: float
    on: Array


@dataclass(frozen=True)
class _Scene:
    """Points, their noise, and their densest cluster.

    Attributes:
        z: Points, shape (n,).
        σ: Noise of each.
        width: With what models leave out, too.
        reach: From the cluster's middle to nearly all points.
        middle: Of the cluster.
        share: Of points in it; 0 where none is to be counted with.
        within: Which points are.
    """

    z: Complexes
    σ: Array
    width: Array
    reach: float
    middle: complex
    share: float
    within: NDArray[np.bool_]

    @staticmethod
    def of(z: Complexes, σ: Array) -> _Scene:
        about = complex(np.median(z.real) + 1j * np.median(z.imag))
        reach = float(np.quantile(np.abs(z - about), 0.995))
        width = np.hypot(σ, max(INEXACT * reach, 1e-12))
        tried = z[-CENTRES:]
        near = np.abs(tried[:, None] - z[:JUDGES]) < 2 * width[:JUDGES]
        middle = complex(tried[near.sum(axis=1).argmax()])
        for _ in range(10):
            weight = (np.abs(z - middle) < 2 * width) / width**2
            middle = complex((weight * z).sum() / weight.sum())
        # Of a Gaussian exp(−2) lies beyond two deviations.
        share = np.mean(np.abs(z - middle) < 2 * width) / (1 - np.exp(-2))
        within = np.abs(z - middle) < OUTSKIRTS * width
        return _Scene(z, σ, width, reach, middle, min(float(share), 1.0), within)

    @property
    def elsewhere(self) -> float:
        """Density of points that may lie anywhere."""
        return 1 / (np.pi * (1.2 * self.reach) ** 2)

    def trials(self, rng: np.random.Generator) -> tuple[tuple[Complexes, Array, bool], ...]:
        """Centres and radii through three points each, and about the cluster; which are fixed."""
        rest, cluster = np.flatnonzero(~self.within), np.flatnonzero(self.within)
        kept = rng.permutation(cluster)[: max(rest.size // 3, 3)]
        pool = self.z[np.concatenate([rest, kept])]
        one, two, three = pool[rng.integers(pool.size, size=(3, TRIALS))]
        # |z − c|² is the same for three points: with the first as origin c·z = |z|²/2.
        first, second = two - one, three - one
        area = 2 * (first.real * second.imag - first.imag * second.real)
        turned = np.abs(first) ** 2 * second - np.abs(second) ** 2 * first
        apart = np.abs(area) > 0
        towards = -1j * turned[apart] / area[apart]
        outer = self.z[rest[rng.integers(rest.size, size=TRIALS // 4)]] if rest.size else pool[:0]
        radii = np.abs(outer - self.middle)
        about = np.full(radii.shape, self.middle)
        return (one[apart] + towards, np.abs(towards), False), (about, radii, True)

    def best(self, centres: Complexes, radii: Array, fixed: bool) -> _Fit | None:
        """The circle that explains most points, of those that trials lead to; none within noise."""
        few = self.some(JUDGES)
        more = self.some(FITTED)
        able = self.is_able(radii)
        centres, radii = centres[able], radii[able]
        scores = [few.scored(complex(c), r) for c, r in zip(centres, radii, strict=True)]
        fits = []
        for start in np.argsort(scores)[::-1][:KEPT]:
            fit = more.fitted(complex(centres[start]), float(radii[start]), fixed)
            if self.is_able(fit.radius):
                fits.append(fit)
        if not fits:
            return None
        first = max(fits, key=lambda fit: fit.explained)
        fit = self.fitted(first.centre, first.radius, fixed)
        return fit if self.is_able(fit.radius) else None

    def is_able(self, radius: float | Array) -> NDArray[np.bool_]:
        """Whether a circle is larger than noise, and not of another order than what is seen."""
        smallest = SMALLEST * float(np.median(self.width))
        return np.asarray((radius > smallest) & (radius < 2 * self.reach))

    def some(self, count: int) -> _Scene:
        """The scene by fewer points, evenly picked from their random order."""
        step = slice(None, None, max(1, self.z.size // count))
        parts = {name: getattr(self, name)[step] for name in ("z", "σ", "width", "within")}
        return replace(self, **parts)

    def parts(self, centre: complex, radius: float, loose: float = 0.0) -> Array:
        """How well points agree with the cluster, with a circle and with nothing.

        Orientations may be few, so that a circle's points are no less dense for its being large.
        """
        width = np.hypot(self.width, loose)
        ring = _ring(np.abs(self.z - centre), radius, width) * (FULL * radius / self.reach)
        nothing = np.full(self.z.size, self.elsewhere)
        spot = _spot(np.abs(self.z - self.middle), self.width) * (self.share > 0)
        return np.stack([spot, ring, nothing])

    def scored(self, centre: complex, radius: float) -> float:
        rest = 1 - self.share
        weights = np.array([self.share, 0.7 * rest + 0.01, 0.3 * rest + 0.01])
        return float(np.log(weights @ self.parts(centre, radius)).sum())

    def fitted(self, centre: complex, radius: float, fixed: bool) -> _Fit:
        """Expectation maximisation, with steps of Fisher's scores for the circle."""
        rest = 1 - self.share
        weights = np.array([self.share, 0.7 * rest + 0.01, 0.3 * rest + 0.01])
        weights /= weights.sum()
        loose, on = 0.0, np.zeros(self.z.size)
        for _ in range(ROUNDS):
            parts = weights[:, None] * self.parts(centre, radius, loose)
            total = parts.sum(axis=0)
            on = parts[1] / total
            weights = np.maximum((parts / total).mean(axis=1), 1e-6)
            weights /= weights.sum()
            moved = self.step(centre, radius, on / (self.width**2 + loose**2), fixed)
            off = np.abs(self.z - centre) - radius
            left = float((on * (off**2 - self.width**2)).sum() / max(on.sum(), 1e-300))
            loose = min(np.sqrt(max(left, 0.0)), LOOSE * radius)
            by = abs(moved[0] - centre) + abs(moved[1] - radius)
            centre, radius = moved
            if not self.is_able(radius) or by < 1e-7 * self.reach:
                break
        explained = float(np.log(weights @ self.parts(centre, radius, loose)).sum())
        return _Fit(centre, radius, loose, explained, on)

    def step(
        self, centre: complex, radius: float, counted: Array, fixed: bool
    ) -> tuple[complex, float]:
        """The next centre and radius, points being counted by so much."""
        away = np.abs(self.z - centre)
        rows = _directions(self.z, centre)
        # The mean direction, from a centre, to where noise has moved a point from.
        bend = away * radius / np.maximum(self.σ, 1e-9 * radius) ** 2
        lean = i1e(bend) / i0e(bend)
        out = counted * (away - radius * lean)
        larger = counted * (away * lean - radius)
        score = np.array([rows[0] @ out, rows[1] @ out, larger.sum()])
        normal = (counted * rows) @ rows.T
        if fixed:
            return centre, radius + float(score[2] / max(normal[2, 2], 1e-300))
        x, y, wider = np.linalg.lstsq(normal, score)[0]
        return centre + complex(x, y), radius + float(wider)

    def likelihood(self, fit: _Fit) -> float:
        """Its logarithm, of a circle that may be lit all round."""
        parts = self.parts(fit.centre, fit.radius, fit.loose)
        parts[1] /= FULL * fit.radius / self.reach
        return _mixed(parts)

    def halo(self) -> float:
        """The logarithm of likelihood of no circle, but a wider cluster about the same middle."""
        away = np.abs(self.z - self.middle)
        widest = 2 * self.reach / float(np.median(self.width))
        rest = np.full(away.size, self.elsewhere)
        spot = _spot(away, self.width)
        return max(
            _mixed(np.stack([spot, _spot(away, wider * self.width), rest]))
            for wider in np.geomspace(1.2, widest, 12)
        )


def _mixed(parts: Array) -> float:
    """The largest logarithm of likelihood of densities, shape (n, points), of any shares."""
    weights = np.full(len(parts), 1 / len(parts))
    for _ in range(ROUNDS):
        mixed = weights[:, None] * parts
        weights = (mixed / mixed.sum(axis=0)).mean(axis=1)
    return float(np.log(weights @ parts).sum())


def _decided(scene: _Scene, free: _Fit | None, bare: _Fit | None) -> _Fit | None:
    """Of a circle through all and one about the cluster that which points tell, if any."""
    if bare is not None:
        direction = _directions(scene.z, bare.centre)[:2, bare.on > 0.5]
        if direction.size == 0 or np.hypot(*direction.mean(axis=1)) > ONE:
            bare = None
    if free is None:
        return bare if scene.share >= HALF else None
    others = (free.on > 0.5) & ~scene.within
    widened = float(np.mean((scene.width[others] / free.radius) ** 2)) if others.any() else 0.0
    if _spread(scene.z, free, others) < FEW + widened:
        even = np.log(2) * max(int(others.sum()), 1)
        tells = bare is not None and bare.explained > free.explained - even
        return bare if tells and scene.share >= HALF else None
    return bare if bare is not None and bare.explained > free.explained else free


def _directions(z: Complexes, centre: complex) -> Array:
    """Cosine, sine and 1 of points seen from a centre: what moving it, and a radius, change."""
    away = z - centre
    direction = away / np.maximum(np.abs(away), 1e-300)
    return np.stack([direction.real, direction.imag, np.ones(z.size)])


def _spread(z: Complexes, fit: _Fit, of: NDArray[np.bool_]) -> float:
    """Smallest eigenvalue of what changes of centre and radius do to distances, over pixels."""
    rows = _directions(z[of], fit.centre)
    return float(np.linalg.eigvalsh(rows @ rows.T / max(rows.shape[1], 1))[0])


def _spot(away: Array, width: Array) -> Array:
    """Density of points that noise moves so far: Student's, noise itself being uncertain."""
    return (1 + away**2 / (FREE * width**2)) ** (-(FREE + 2) / 2) / (2 * np.pi * width**2)


def _ring(away: Array, radius: float, width: Array) -> Array:
    """Density of points at a distance from a circle's centre that noise moves from it (Rice)."""
    ring = np.exp(-((away - radius) ** 2) / (2 * width**2)) * i0e(away * radius / width**2)
    return ring / (2 * np.pi * width**2)
