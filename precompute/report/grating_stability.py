"""The closed form of gratings at the edges: its radiance against the reference's.

Its mirror in numpy (`precompute.closed_form`) reads the tables that the shader reads; the shader
itself is driven to its edges by tests/browser/stability.test.ts.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from precompute.closed_form import ClosedForm
from precompute.gratings import Grating, Light
from precompute.metrics import relative_rmse
from precompute.reference import colour_brdf, order_direction, propagating_orders
from precompute.report.rows import Stability
from precompute.spectra import WAVELENGTH_MAX, WAVELENGTH_MIN

Array = NDArray[np.float64]

NEGATIVE_ALLOWED = 1e-6
"""Of Y, as a share of the largest: what rounding to halves leaves of dark colours."""

BRIGHT = 3
"""Largest |m| of the lobes looked into: a hundred further ones have next to no light."""


@dataclass(frozen=True)
class Edge:
    """A grating, a light and directions at one end of what they may be.

    Attributes:
        case: What it is.
        grating: What differs from a sinusoid of 1.66 µm, 0.15 µm high.
        angular_radius: Standard deviation of the light's disc, rad; 0 is a point.
        degrees: Least and largest angle of light and view from the normal.
        pairs: Pairs of directions.
    """

    case: str
    grating: dict[str, Any] = field(default_factory=dict)
    angular_radius: float = 0
    degrees: tuple[float, float] = (0, 80)
    pairs: int = 400


EDGES = (
    Edge("1.66 µm, 0.15 µm high, a point light"),
    Edge("a tenth of a wavelength long", {"period": 0.038}),
    Edge("100 µm long, hundreds of orders", {"period": 100.0, "coherence": 400.0}, pairs=40),
    Edge("100 µm long, longer than the coherence of 16.25 µm", {"period": 100.0}, pairs=40),
    Edge("0.6 µm high", {"height": 0.6}),
    Edge("blazed, 0.6 µm high", {"height": 0.6, "profile": {"kind": "blazed"}}),
    Edge("coherence of a quarter of the period", {"coherence": 1.66 / 4}),
    Edge("coherence of 1 mm", {"coherence": 1000.0}),
    Edge("tilts of 1°", {"roughness": 0.01745}),
    Edge("tilts of 30°", {"roughness": 0.5236}),
    Edge("light of 30°", angular_radius=0.5236),
    Edge("80° to 89.99° from the normal", degrees=(80, 89.99)),
    Edge("likewise, tilts of 1°", {"roughness": 0.01745}, degrees=(80, 89.99)),
    Edge("likewise, light of 1°", angular_radius=0.01745, degrees=(80, 89.99)),
)


def grating_stability(edge: Edge) -> Stability:
    """Radiance of the closed form, in lobes of random orders and elsewhere."""
    grating = Grating.model_validate({"period": 1.66, "height": 0.15} | edge.grating)
    light = Light(angular_radius=edge.angular_radius) if edge.angular_radius > 0 else Light()
    wi, wo = _directions(grating, edge)
    found = wi[:, 2:] * ClosedForm(grating, light).colour_brdf(wi, wo)
    exact = wi[:, 2:] * colour_brdf(grating, wi, wo, light)
    return Stability(
        case=edge.case,
        method="closed-form",
        samples=edge.pairs,
        max_albedo=None,
        float="fp16",
        **compared(found, exact),
    )


def compared(found: Array, exact: Array) -> dict[str, Any]:
    """What of XYZ radiance (n, 3) is no number or dark, and its error where all is finite."""
    finite = np.isfinite(found).all(axis=1)
    luminance = found[finite, 1]
    least = -NEGATIVE_ALLOWED * np.max(luminance, initial=0)
    return {
        "non_finite": int(np.count_nonzero(~finite)),
        "negative_energy": int(np.count_nonzero(luminance < least)),
        "rel_rmse": float(relative_rmse(found, exact)) if finite.all() else None,
    }


def _directions(grating: Grating, edge: Edge) -> tuple[Array, Array]:
    """Unit ω_i and ω_o, shape (pairs, 3): half of the views are in a lobe of a visible colour."""
    rng = np.random.default_rng(1)
    wi, wo = (_random(edge, rng) for _ in range(2))
    # A lobe's width in directions: window, tilts and light.
    window = 0.55 / (np.sqrt(8) * np.pi * grating.coherence)
    width = np.hypot(np.hypot(window, 2 * grating.roughness), edge.angular_radius)
    for row in range(0, edge.pairs, 2):
        λ = rng.uniform(WAVELENGTH_MIN, WAVELENGTH_MAX)
        orders = propagating_orders(wi[row], λ, grating.period)
        order = rng.choice(orders[np.abs(orders) <= BRIGHT])
        xy = order_direction(wi[row], order, λ, grating.period)[:2] + width * rng.normal(size=2)
        if xy @ xy < 1:
            wo[row] = [*xy, np.sqrt(1 - xy @ xy)]
    return wi, wo


def _random(edge: Edge, rng: np.random.Generator) -> Array:
    θ = np.deg2rad(rng.uniform(*edge.degrees, edge.pairs))
    φ = rng.uniform(0, 2 * np.pi, edge.pairs)
    return np.stack([np.sin(θ) * np.cos(φ), np.sin(θ) * np.sin(φ), np.cos(θ)], axis=1)
