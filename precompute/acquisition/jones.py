"""Jones calculus of a grating under plastic, lit by a panel and seen through a polariser.

The 2018 paper's Eq. 4 to 6, at normal incidence, for circularly polarised light e_i:

    I(ψ) = |S e_i|²,   S = r_p e^{iφ_p} F R_f B_R + t_p F R_f B_T R_dᵀ D R_d O B_T

    F = diag(1, 0)                  the polariser, in its own frame
    R_f, R_d                        turns into the frames of the polariser, at ψ, and the grating, θ
    B_T = diag(1, e^{iΔ})           the plastic's retardation Δ (the paper's Δn), each way
    B_R                             likewise of what its first surface reflects
    D = diag(−1, R), R = R_−/R_+    the grating: s- over p-polarised amplitude
    O                               oblique incidence, 1 in the paper (`Obliquity`)
    r_p, t_p = 1 − r_p²             the first surface's reflection, and both passages through it

Signs. All Jones vectors have their components along the sample's x (right) and y (up), before and
after reflection. Angles are counter-clockwise as the camera sees them; θ is the grating vector's,
as in maps, and the paper's clockwise θ is −θ. So what turns into a frame at an angle α is
[[cos α, sin α], [−sin α, cos α]]. Waves go with exp(−iωt): metals have n + ik, and Δ > 0 delays
what is polarised across the plastic's axis. e_i = (1, −i): at one place the field turns clockwise
as the camera sees it. A mirror is D = −1, R = −1: Fresnel's r_s = −r_p at normal incidence, and the
−1 in D turns a reflected p-polarised wave's frame back into the sample's. As in Eq. 6, amplitudes
are over the metal's own R_+. So I = 1 for a mirror, at all ψ.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Wave: TypeAlias = tuple[Complex, Complex]
"""Amplitudes along x and y."""


@dataclass(frozen=True)
class Plastic:
    """The layer over the metal.

    Attributes:
        retardation: Δ, rad, each way.
        axis: Angle of its fast axis from x, rad.
        first_surface: r_p, amplitude of what its upper side reflects, −1 to 1.
        first_phase: φ_p of that over what the metal reflects, rad; the layer's thickness decides.
        first_retardation: Of B_R, rad.
    """

    retardation: float = 0.0
    axis: float = 0.0
    first_surface: float = 0.0
    first_phase: float = 0.0
    first_retardation: float = 0.0


@dataclass(frozen=True)
class Obliquity:
    """What a metal does to polarisation where it is not met at right angles.

    O is diag(1, −R_F) along and across the plane of incidence, with Fresnel's R_F = r_s/r_p, which
    is −1 at normal incidence. The paper leaves it out.

    Attributes:
        plane: Angle of the plane of incidence from x, rad.
        ratio: R_F (`fresnel_ratio`).
    """

    plane: Array
    ratio: Complex


def fresnel_ratio(metal: ArrayLike, plastic: float, angle: ArrayLike) -> Complex:
    """R = r_s/r_p of a metal under plastic.

    Fresnel's equations; −1 at normal incidence, and near it −(1 + 2 sin²φ/(n N)).

    Args:
        metal: Its complex index N = n + ik.
        plastic: The plastic's index n.
        angle: φ, of incidence in air, rad.

    Returns:
        A ratio of amplitudes, of the shape to which `metal` and `angle` broadcast.
    """
    index = np.asarray(metal, np.complex128)
    sine = np.sin(angle) / plastic
    cosine = np.sqrt(1 - sine**2)
    within = np.sqrt(1 - (plastic * sine / index) ** 2)
    s = (plastic * cosine - index * within) / (plastic * cosine + index * within)
    p = (index * cosine - plastic * within) / (index * cosine + plastic * within)
    return s / p


def reflected(
    orientation: ArrayLike, ratio: ArrayLike, plastic: Plastic, obliquity: Obliquity | None = None
) -> Wave:
    """The wave before the polariser: S e_i without F R_f.

    Args:
        orientation: θ of the gratings, rad.
        ratio: R of the gratings, a ratio of amplitudes, −1 where there is none; broadcasts with
            `orientation`.
        plastic: Over them.
        obliquity: Oblique incidence; none without it.

    Returns:
        Amplitudes over the metal's own, no unit, of the shape to which all broadcast.
    """
    incident = np.array(1, complex), np.array(-1j)
    delay = np.exp(1j * plastic.retardation)
    wave = _scaled(incident, plastic.axis, 1, delay)
    if obliquity is not None:
        wave = _scaled(wave, obliquity.plane, 1, -obliquity.ratio)
    wave = _scaled(wave, orientation, -1, ratio)
    x, y = _scaled(wave, plastic.axis, 1, delay)
    r = plastic.first_surface
    first = _scaled(incident, plastic.axis, 1, np.exp(1j * plastic.first_retardation))
    early = r * np.exp(1j * plastic.first_phase)
    return (1 - r**2) * x + early * first[0], (1 - r**2) * y + early * first[1]


def intensity(wave: Wave, polariser: ArrayLike) -> Array:
    """I = |F R_f wave|², relative to the light that a mirror returns.

    Args:
        wave: Before the polariser.
        polariser: ψ, rad.
    """
    x, y = wave
    through = np.cos(polariser) * x + np.sin(polariser) * y
    return through.real**2 + through.imag**2


def global_offset(ratio: complex, plastic: Plastic = Plastic()) -> float:
    """θ − η/2, where I = c + A cos(2ψ − η): what tells orientations from phases.

    It is half the angle of −conj(d₀)(1 + R), where d₀ = t_p(R − 1)/2 + r_p e^{iφ_p} is what the
    foil returns as a mirror does: exact without retardation, and wrong by its square with it.

    Args:
        ratio: R, a ratio of amplitudes.
        plastic: Over the gratings.

    Returns:
        Rad, −π/2 to π/2; it counts modulo π.
    """
    r = plastic.first_surface
    mirror = (1 - r**2) * (ratio - 1) / 2 + r * np.exp(1j * plastic.first_phase)
    return float(np.angle(np.conj(mirror) * -(1 + ratio)) / 2)


def _scaled(wave: Wave, angle: ArrayLike, along: complex, across: ArrayLike) -> Wave:
    """Rᵀ diag(along, across) R with the turn R into a frame at an angle from x."""
    x, y = wave
    cosine, sine = np.cos(angle), np.sin(angle)
    first = along * (cosine * x + sine * y)
    second = np.multiply(across, cosine * y - sine * x)
    return cosine * first - sine * second, sine * first + cosine * second
