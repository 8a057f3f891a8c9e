"""The seed's method in numpy: a sum over wavelengths at equal steps, as the shaders' loop makes it.

The papers take 5 nm and, for a sinusoid, the second-order Taylor coefficients of its efficiencies.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from precompute.closed_form import ClosedForm, uniform_nodes
from precompute.gratings import Grating, Light
from precompute.spectra import WAVELENGTH_MAX, WAVELENGTH_MIN

Array = NDArray[np.float64]


class WavelengthLoop(ClosedForm):
    """Point and directional light on a grating, summed over wavelengths.

    Args:
        grating: The grating.
        light: The light.
        step: Between wavelengths, µm.
        is_taylor: Take the Taylor coefficients for the efficiencies, in place of the table.

    Raises:
        InputError: As `ClosedForm`.
    """

    def __init__(
        self, grating: Grating, light: Light, step: float = 0.005, is_taylor: bool = False
    ) -> None:
        super().__init__(grating, light)
        count = round((WAVELENGTH_MAX - WAVELENGTH_MIN) / step) + 1
        self.nodes = uniform_nodes(self.weights, np.asarray(light.tint), count)
        self.is_taylor = is_taylor
        if is_taylor:
            self.max_order = min(self.max_order, 2)

    def colour_brdf(self, wi: Array, wo: Array) -> Array:
        """∫ S (x̄, ȳ, z̄) f_r dλ, XYZ in 1/sr, shape (n, 3), for directions of shape (n, 3).

        Args:
            wi: ω_i, shape (n, 3), above the horizon.
            wo: ω_o, shape (n, 3), above the horizon.
        """
        result = np.zeros((len(wi), 3))
        rows = np.flatnonzero((wi[:, 2] > 0) & (wo[:, 2] > 0))
        wi, wo = wi[rows], wo[rows]
        for node in self.nodes:
            result[rows] += node.xyz * self.at_node(node, wi, wo)[:, None]
        return result

    def efficiency(self, m: int, w: Array, wavenumber: Array) -> Array:
        """η_m, a share, by the table or by docs/theory/profiles.md: β = φ/2.

        Args:
            m: The order.
            w: w = cosθ_i + cosθ_o, no unit, shape (n,).
            wavenumber: 1/λ, 1/µm, shape (n,).
        """
        if not self.is_taylor:
            return super().efficiency(m, w, wavenumber)
        β2 = (np.pi * w * self.grating.height * wavenumber) ** 2
        match abs(m):
            case 0:
                return (1 - 0.75 * β2) ** 2 + β2
            case 1:
                return (β2 + β2**2) / 4
            case _:
                return β2**2 / 64
