"""The distribution whose diffraction under one wavelength is a spiral."""

from __future__ import annotations

import numpy as np
from scipy.stats import norm

from precompute.foils.distribution import GratingDistribution
from precompute.foils.recipe import SpiralDistribution

ORIENTATIONS = 90
FREQUENCIES = 96
REACH = 4.0
"""Deviations of the period beyond the shortest and the longest; a share of 3e-5 lies further."""


def spiral(recipe: SpiralDistribution) -> GratingDistribution:
    """Orientations evenly, and about a(θ) = shortest + (longest − shortest)·θ/π a Gaussian each.

    Args:
        recipe: Its parameters, with the deviation spread·a(θ).

    Returns:
        The distribution over cells of 2° and of 1/96 of the frequencies' range, each the exact
        share of its frequencies, over θ by the mean at eight abscissae.
    """
    abscissae = 8
    share = (np.arange(ORIENTATIONS * abscissae) + 0.5) / (ORIENTATIONS * abscissae)
    period = (recipe.shortest + (recipe.longest - recipe.shortest) * share)[:, None]
    frequency_edges = np.linspace(
        1 / (recipe.longest * (1 + REACH * recipe.spread)),
        1 / (recipe.shortest * (1 - REACH * recipe.spread)),
        FREQUENCIES + 1,
    )
    longer = norm.cdf(1 / frequency_edges, period, recipe.spread * period)
    weights = -np.diff(longer, axis=1).reshape(ORIENTATIONS, abscissae, FREQUENCIES).mean(axis=1)
    orientation_edges = np.linspace(0, np.pi, ORIENTATIONS + 1)
    return GratingDistribution(orientation_edges, frequency_edges, weights)
