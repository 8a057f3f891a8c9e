"""What light meets at a height field beside its relief: material, coherence, tilts of its normals.

Directions are unit vectors away from the surface, in its frame (x, y, normal); d = (ω_i + ω_o)_xy,
w = (ω_i + ω_o)_z, s = 1/λ.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, PositiveInt, field_validator

from precompute.gratings import Positive
from precompute.height_fields.window import CutWindow
from precompute.spectra import Metal, metal_reflectance

Array = NDArray[np.float64]

HeightFieldEnergy = Literal["kirchhoff", "relative"]
"""Stam's absolute BRDF, or the same over that of a flat surface seen head-on."""


def _metal_unless_dielectric(fields: dict[str, Any]) -> Metal | None:
    return "aluminium" if fields.get("ior") is None else None


class HeightFieldOptics(BaseModel):
    """Material, coherence and roughness of a height field, and how its BRDF is normalised.

    Attributes:
        ior: Index of refraction n of a dielectric; ``null`` for a metal or a perfect mirror.
        metal: The metal, which gives R(λ); left out it is aluminium, or none where there is an
            `ior`. ``null`` without an `ior` is a perfect mirror, R = 1.
        coherence: σ of the Gaussian coherence window exp(−r²/2σ²), µm.
        tiles: How many patches the window is cut to along x and y; one number stands for both.
            ``null``: it is not cut, the patch repeats for ever.
        roughness: δ, standard deviation of the normal's tilt, rad.
        energy: ``kirchhoff``, Stam's absolute BRDF in 1/sr, or ``relative``: divided by that of
            a flat surface of the same material at ω_i = ω_o = n: 1 for a mirror seen head-on.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    ior: Annotated[float, Field(gt=1)] | None = None
    metal: Metal | None = Field(default_factory=_metal_unless_dielectric)
    coherence: Positive = 16.25
    tiles: tuple[PositiveInt, PositiveInt] | None = None
    roughness: Annotated[float, Field(ge=0, lt=np.pi / 2)] = 0.0
    energy: HeightFieldEnergy = "kirchhoff"

    @field_validator("metal")
    @classmethod
    def _is_not_both(cls, value: Metal | None, info: Any) -> Metal | None:
        if value is not None and info.data.get("ior") is not None:
            raise ValueError("null, or no ior: a surface is a metal or a dielectric")
        return value

    @field_validator("tiles", mode="before")
    @classmethod
    def _along_both_axes(cls, value: Any) -> Any:
        return (value, value) if isinstance(value, int) else value

    def reflectance(self, wi: Array, wo: Array, wavelength: Array) -> Array:
        """R of the material, for unpolarised light.

        A dielectric reflects as Fresnel says at the angle between light and half vector,
        cosθ_h = √((1 + ω_i·ω_o)/2); a metal as at normal incidence.

        Args:
            wi: ω_i, shape (n, 3).
            wo: ω_o, shape (n, 3).
            wavelength: λ, µm, shape (n,).

        Returns:
            A share of the light, shape (n,).
        """
        if self.ior is not None:
            # Opposite directions, edge-on both: rounding may leave the sum below zero.
            return _fresnel(self.ior, np.maximum(1 + np.sum(wi * wo, axis=-1), 0) / 2)
        if self.metal is not None:
            return metal_reflectance(self.metal, wavelength)
        return np.ones(len(wi))

    @property
    def window_variance(self) -> float:
        """W = 1/(8π²σ²), 1/µm²: of the squared window's lobe in spatial frequency."""
        return 1 / (8 * np.pi**2 * self.coherence**2)

    def cut_windows(self, period: tuple[float, float] | None) -> tuple[CutWindow, CutWindow] | None:
        """The window along x and y where `tiles` cuts it, else None.

        Args:
            period: (T_x, T_y) of the patch, µm; `tiles` need it.
        """
        if self.tiles is None:
            return None
        assert period is not None
        (nx, ny), (tx, ty) = self.tiles, period
        return CutWindow(self.coherence, nx * tx), CutWindow(self.coherence, ny * ty)

    def flat_density(self, period: tuple[float, float] | None) -> float:
        """|P|²/A of a flat surface where a point source is brightest, µm²: 4πσ² uncut.

        Args:
            period: (T_x, T_y) of the patch, µm; `tiles` need it.
        """
        windows = self.cut_windows(period)
        if windows is None:
            return 1 / (2 * np.pi * self.window_variance)
        return windows[0].peak * windows[1].peak

    def covariance(self, wi: Array, wo: Array, wavelength: Array, angular_radius: float) -> Array:
        """C_f of a line's lobe in the plane of spatial frequencies, (xx, yy, xy).

        C_f = W·1 + s²((wδ)²·1 + α²(1 − tt^T)), t = (ω_i)_xy: the window, normals that tilt, and a
        source whose directions project onto the surface.

        Args:
            wi: ω_i, shape (n, 3).
            wo: ω_o, shape (n, 3).
            wavelength: λ, µm, shape (n,).
            angular_radius: α, rad.

        Returns:
            1/µm², shape (3, n).
        """
        s2, α2 = wavelength**-2.0, angular_radius**2
        same = self.window_variance + s2 * ((wi[:, 2] + wo[:, 2]) * self.roughness) ** 2
        return np.stack(
            [
                same + s2 * α2 * (1 - wi[:, 0] ** 2),
                same + s2 * α2 * (1 - wi[:, 1] ** 2),
                -s2 * α2 * wi[:, 0] * wi[:, 1],
            ]
        )

    def scale(
        self,
        wi: Array,
        wo: Array,
        wavelength: Array,
        period: tuple[float, float] | None = None,
    ) -> Array:
        """What makes |P|²/A, in µm², the BRDF of the chosen energy.

        Absolute: R s² (1 + ω_i·ω_o)²/(cosθ_i cosθ_o w²). Relative: that over what a flat surface
        has head-on under a point source, R_0 s² `flat_density`.

        Args:
            wi: ω_i, shape (n, 3), above the horizon.
            wo: ω_o, likewise.
            wavelength: λ, µm, shape (n,).
            period: (T_x, T_y) of the patch, µm; a relative BRDF with `tiles` needs it.

        Returns:
            Shape (n,), 1/(µm² sr); relative: 1/µm².
        """
        w = wi[:, 2] + wo[:, 2]
        obliquity = (1 + np.sum(wi * wo, axis=-1)) ** 2 / (wi[:, 2] * wo[:, 2] * w**2)
        scale = self.reflectance(wi, wo, wavelength) * obliquity
        if self.energy == "kirchhoff":
            return scale * wavelength**-2.0
        normal = np.broadcast_to([0.0, 0.0, 1.0], wi.shape)
        head_on = self.reflectance(normal, normal, wavelength)
        return scale / head_on / self.flat_density(period)


def _fresnel(n: float, cosine_squared: Array) -> Array:
    """Unpolarised reflectance of a dielectric of index n in air, by the squared cosine.

    >>> bool(np.isclose(_fresnel(1.5, np.array([1.0]))[0], 0.04))  # ((n − 1)/(n + 1))²
    True
    """
    inside = np.sqrt(n**2 - 1 + cosine_squared)  # n cosθ of the refracted ray
    c = np.sqrt(cosine_squared)
    across = (c - inside) / (c + inside)
    along = (n**2 * c - inside) / (n**2 * c + inside)
    return (across**2 + along**2) / 2
