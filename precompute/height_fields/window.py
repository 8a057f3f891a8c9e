"""A coherence window cut to a finite number of patches, one axis of it at a time.

Light that falls on N repeats of a patch of length T, and no more, sees the window

    g(x) = exp(−x²/2σ²) where |x| ≤ NT/2, else 0,    A = ∫ g² dx = √π σ erf(NT/2σ),

about the middle of the repeats. Its transform L(f) = ∫ g e^{2πifx} dx is real and even. For σ → ∞
it is sin(πNTf)/(πf), and the lines of a spectrum, 1/T apart, each with this lobe, add up to the
patch's transform times the Dirichlet factor sin(πNTf)/sin(πTf).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.fft
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates, spline_filter
from scipy.special import erf, wofz

Array = NDArray[np.float64]

SAMPLES = 40
"""Of a blurred lobe, over 1/NT: a cubic spline between them is good to 1e-6 of the peak."""

WIDTHS = 48
"""Of the blur, at which lobes are tabulated."""

MARGIN = 8
"""Samples of both beyond those asked for: the spline's end conditions have died out there."""

ALIASING = 8
"""Steps of the window's correlation over the shortest wave. Its kinks, at 0 and at NT, leave the
trapezoidal rule an error of second order, which is known; then 1e-8 of the peak is left."""


@dataclass(frozen=True)
class CutWindow:
    """The window along one axis.

    Attributes:
        coherence: σ, µm.
        length: NT, µm.
    """

    coherence: float
    length: float

    @property
    def area(self) -> float:
        """A = ∫ g² dx, µm."""
        σ = self.coherence
        return float(np.sqrt(np.pi) * σ * erf(self.length / (2 * σ)))

    @property
    def peak(self) -> float:
        """L(0)²/A, µm: what a mirror's |P|²/A has along this axis where it is brightest."""
        return float(self.amplitude(np.zeros(1))[0] ** 2)

    @property
    def variance(self) -> float:
        """Of the Gaussian with the energy and the peak of L²/A, 1/µm²; the window's own if uncut.

        >>> W = CutWindow(coherence=2, length=100).variance
        >>> bool(np.isclose(W, 1 / (8 * np.pi**2 * 2**2)))
        True
        """
        return 1 / (2 * np.pi * self.peak**2)

    def amplitude(self, f: Array) -> Array:
        """L(f)/√A, so that ∫ (L²/A) df = 1.

        With a = 1/(√2 σ), β = πf/a and w the Faddeeva function,

            L = (√π/a) (e^{−β²} − e^{−(aNT/2)²} Re e^{−iπNTf} w(i(aNT/2 + iβ))).

        Args:
            f: Spatial frequency, 1/µm, any shape.

        Returns:
            √µm.
        """
        a = 1 / (np.sqrt(2) * self.coherence)
        edge = a * self.length / 2
        β = np.pi * f / a
        cut = np.exp(-(edge**2) - 1j * np.pi * self.length * f) * wofz(1j * edge - β)
        return np.sqrt(np.pi / self.area) / a * (np.exp(-(β**2)) - cut.real)

    def reach(self, share: float) -> float:
        """Beyond which |L| stays below this share of L(0), 1/µm.

        The cut leaves a tail below g(NT/2)/(πf), besides what is left of the Gaussian.
        """
        edge = np.exp(-((self.length / self.coherence) ** 2) / 8)
        tail = edge / (np.pi * share * np.sqrt(self.peak * self.area))
        return float(tail + np.sqrt(-np.log(share) / 2) / (np.pi * self.coherence))


@dataclass(frozen=True)
class BlurredLobes:
    """L²/A convolved with Gaussians, ∫ (L(f')²/A) N(f − f'; b²) df', from a table.

    The transform of L² is the window's correlation: G(x) = e^{−x²/4σ²} √π σ erf((NT − |x|)/2σ)
    where |x| ≤ NT, else 0. A blurred lobe is the cosine transform of (G/A) e^{−2π²b²x²}.

    Attributes:
        window: The window.
        widths: Least and largest deviation b of the Gaussians, 1/µm.
        farthest: Largest |f| asked for, 1/µm.
    """

    window: CutWindow
    widths: tuple[float, float]
    farthest: float

    @cached_property
    def _table(self) -> tuple[float, float, Array]:
        """Step over f, step over b, and the spline's coefficients (b, f), `MARGIN` rows first."""
        length, σ = self.window.length, self.window.coherence
        span = min(length, 12 * σ)  # what lies beyond is below e^−36
        steps = int(np.ceil(ALIASING * max(self.farthest * span, 1)))
        dx = span / steps
        x = dx * np.arange(steps + 1)
        norm = erf(length / (2 * σ))
        correlation = np.exp(-((x / (2 * σ)) ** 2)) * erf((length - x) / (2 * σ)) / norm
        kink = np.exp(-((length / (2 * σ)) ** 2)) / (np.sqrt(np.pi) * σ * norm)
        # The grid of the cosine transform: f = n/(2 count dx).
        count = SAMPLES * steps // 2
        df = 1 / (2 * count * dx)
        f = df * np.arange(int(np.ceil(self.farthest / df)) + MARGIN)
        step = max(self.widths[1] - self.widths[0], 0.01 * self.widths[1]) / WIDTHS
        widths = self.widths[0] + step * np.arange(-MARGIN, WIDTHS + MARGIN + 1)
        rows = np.zeros((len(widths), len(f)))
        for row, b in zip(rows, widths, strict=True):
            samples = np.zeros(count + 1)
            samples[: len(x)] = correlation * np.exp(-2 * (np.pi * b * x) ** 2)
            row[:] = dx * np.asarray(scipy.fft.dct(samples, type=1))[: len(f)]
            end = np.exp(-2 * (np.pi * b * span) ** 2) * np.cos(2 * np.pi * f * span)
            row -= dx**2 / 6 * kink * (1 - end)
        return df, step, spline_filter(rows, order=3, mode="mirror")

    def __call__(self, f: Array, b: Array) -> Array:
        """At spatial frequencies and blurs that broadcast, µm."""
        df, step, coefficients = self._table
        row = MARGIN + (b - self.widths[0]) / step
        at = np.stack(np.broadcast_arrays(row, np.abs(f) / df))
        return map_coordinates(coefficients, at, order=3, mode="mirror", prefilter=False)
