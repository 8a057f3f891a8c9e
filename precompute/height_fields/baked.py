"""The colour of a height field, baked over (u, v, w) as a few modes (docs/theory/height-fields.md).

Where normals tilt or the light has a size, the lines of a repeating patch blur into a pattern that
a table can hold. With d = (u, v) = (ω_i + ω_o)_xy, w = (ω_i + ω_o)_z and s = 1/λ,

    I_c(u, v, w) = ∫ W_c(λ) R(λ) s² |P|²/A dλ,      c = X, Y, Z,

of which each line (j, l) is a Gaussian about (u, v) = λ f_jl with the covariance

    C = λ²/(8π²σ²) + (wδ)² + α²(1 + w²/4)/2

along both axes, the light's disc being foreshortened as it is on average. Order 0, the one line at
f = 0, turns with the light's disc and is left out: it is a table of its own. The rest is split over
w by singular values, I ≈ Σ_r ψ_r(w) B_r(u, v). B_r are splines, cubic along v, where they follow a
lobe on a grid whose step is the lobe's deviation, and linear along u, where they need more than
twice as many texels: a shader reads one with two bilinear lookups, where cubic ones both ways would
be four, and linear ones would be one from a table twice as large. Where w is so small that lobes
are narrower than a step, they are widened and keep their energy.

A window that is cut to some patches has lobes with tails (`precompute.height_fields.window`). They
are put into the powers, on a lattice, and order 0 into the modes, its own table being dark.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import scipy.fft
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from precompute.axes import Axis
from precompute.errors import InputError
from precompute.height_fields.baked_lookup import ALONG_U, ALONG_V, OBSERVER, BakedLookup
from precompute.height_fields.cells import spectrum_cells
from precompute.height_fields.expansion import terms_needed
from precompute.height_fields.field import HeightField
from precompute.height_fields.optics import HeightFieldOptics
from precompute.height_fields.recipe import HeightFieldRecipe
from precompute.height_fields.splines import coefficients, gaussian_moments
from precompute.height_fields.window import BlurredLobes, CutWindow
from precompute.lobes import EXPONENT_CUT
from precompute.maps import Map, Table
from precompute.spectra import (
    WAVELENGTH_MAX,
    WAVELENGTH_MIN,
    WAVELENGTH_STEP,
    WAVELENGTHS,
    colour_weights,
    metal_reflectance,
)

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complexfloating]
Index = NDArray[np.intp]
Singles = NDArray[np.float32]

DIRECTION_MAX = 2.0
"""Largest |u|, |v| and w: light and view grazing, or both overhead."""

FARTHEST = DIRECTION_MAX / WAVELENGTH_MIN
"""Largest p = w/λ, 1/µm."""

SHARE, LARGEST_ERROR = 6.0, 6e-3
"""What modes left out may cost, and what the grid may, each: so many times the error of the recipe,
which is of amplitudes, but no more than leaves the whole within 1 %."""

LINEAR_SHARE, CUBIC_SHARE = 4 / 3, 1 / 6
"""Of that error at which splines along u and v resolve the narrowest lobe that they are to. The
memory is about the same for all shares; cubic ones fail faster where lobes are narrower still."""

LEAST_W, COARSEST_W = 0.8, 1.3
"""Bounds of the least w at which the grid resolves lobes to that: both directions at 66° and 49°.
Lobes are narrower at smaller w, and take more memory than the pixels that see them are worth."""

LARGEST_GRID = 1024
"""Texels along u: 15 MB for four modes."""

SPECTRUM_ERROR = 1e-8
"""Largest error of |A|² interpolated in w/λ: small, since it starts as w², and is divided by that
in the end."""

SLICE_ERROR = 5e-4
"""Likewise of slices interpolated in w, which are divided by w first."""

BLUR_NODES = 12
"""Chebyshev nodes over w beyond those for |A|², for the width of lobes, which changes with w."""

REACH_SHARE = 1e-3
"""Share of the power that may lie beyond the table along an axis."""

NARROWEST = 0.85
"""About the least deviation of a lobe, in texels: narrower ones ring, and reach below zero."""

SMOOTHING = 0.6
"""Deviation, in texels along v at the longest wavelength, by which a dense spectrum is smoothed so
that fewer samples stand for it. As much is taken off the blur, which is more wherever the grid
resolves lobes."""

CUT_TAIL = 0.03
"""Amplitude of a cut window's lobe, of its peak, beyond which the table need not follow it."""

GAPS = 1e-4
"""Ripple of a smoothed spectrum, relative."""

WAVELENGTH_REACH = 1.5
"""How far a line may move from one wavelength of the sum to the next, in deviations of its lobe: a
row of Gaussians so far apart is smooth to 2 exp(−2π²/1.5²) = 3e-4."""

COARSEST_WAVELENGTH_STEP = 0.005

SAMPLES_PER_NODE = 32
"""Samples of ψ for each Chebyshev node over w: a polynomial of degree n over [0, 2] has about the
curvature of cos nw, from which straight lines depart by (2/32)²/8 = 5e-4."""

COHERENT_STEP = 0.05
"""Change of η_0's fastest phase from one sample of order 0 to the next, rad, and of its lobe in
deviations: straight lines are off by less than 0.05²/8 = 3e-4."""

ERROR_DIRECTIONS, ERROR_ROUNDS = 500, 20
"""Lights and views in which the error is measured; rounds to draw them, all but a few of which
lie below the horizon where lines are far out."""

FULL_SCALE = 1024.0
"""Largest texel of each mode: half floats keep all their bits down to 6e-5."""


def baked_map(
    field: HeightField, recipe: HeightFieldRecipe, file: Path = Path("height-field")
) -> Map:
    """Bake I(u, v, w), and order 0.

    Modes come in groups of four, a group in three layers: X, Y, Z of three modes in the first
    channels of a layer each, X, Y, Z of the fourth in the last channels of the three. Order 0, as
    `BakedLookup.order_0` reads it, is a table over w and the distance r from its middle in
    deviations.

    Args:
        field: The relief, prepared.
        recipe: Its recipe, which says roughness, light and error.
        file: The recipe's file, for errors; a CSV illuminant is looked for beside it.

    Returns:
        A map of kind ``height-field-baked`` with the arrays ``modes`` (layers × v × u; spline
        coefficients), ``weights`` (groups × w; ψ of four modes) and ``coherent`` (r × w; order 0).

    Raises:
        InputError: Roughness and light blur too little for the largest grid.
    """
    error = min(SHARE * recipe.error, LARGEST_ERROR)
    blur = _Blur.of(recipe, field.period)
    weights = _weights(recipe, file)
    spectrum = _spectrum(field, blur, blur.grid_steps(error, LEAST_W)[1])
    if not spectrum.powers.any():
        expected = "a relief with a period above 0.19 µm: this one diffracts no visible light"
        raise InputError(file, "source", f"periods {field.period} µm", expected)
    seen = _Seen.of(spectrum, blur, weights)
    reach = np.minimum(spectrum.reach(REACH_SHARE) + blur.margin, DIRECTION_MAX)
    u, v = _grid_axes(reach, blur, error, seen.resolved_w, file)
    sums = _ColourSum(spectrum.within(reach / WAVELENGTH_MIN), blur, (u, v), weights)

    nodes = _chebyshev_nodes(0, DIRECTION_MAX, _phase_nodes(field, SLICE_ERROR) + BLUR_NODES)
    # As w² begins all that order 0 is not in.
    start = 1 if blur.cut is None else 0
    slices = np.stack([sums.at(w) / w**start for w in nodes.tolist()])
    ψ, modes = _low_rank(slices, start, nodes, u, v, error)
    w = Axis(
        name="sum of the cosines",
        symbol="w",
        unit="1",
        size=SAMPLES_PER_NODE * len(nodes),
        first=0,
        last=DIRECTION_MAX,
    )
    ψ = w.parameters()[:, None] ** start * (_interpolation(nodes, w.parameters()) @ ψ)
    scale = FULL_SCALE / np.abs(modes).max(axis=(1, 2, 3))
    result = Map(
        kind="height-field-baked",
        quantity="colour of a height field but for its order 0, a mirror's Y = 1",
        symbol="I(u, v, w)",
        tables={
            "modes": _packed_modes(modes * scale[:, None, None, None], u, v),
            "weights": _packed_weights(ψ / scale, w),
            "coherent": _coherent(field, blur, weights if blur.cut is None else 0 * weights),
            **spectrum_cells(field).tables(),
        },
        error={},
        recipe=recipe.model_dump(mode="json"),
        constants={
            "modes": len(modes),
            "u_max": u.last,
            "v_max": v.last,
            "w_max": DIRECTION_MAX,
            "roughness": recipe.roughness,
            "angular_radius": recipe.angular_radius,
            "coherence": recipe.coherence,
        },
    )
    result.error = seen.error(result)
    return result


@dataclass(frozen=True)
class _Blur:
    """What gives lines their width.

    Attributes:
        window: W = 1/(8π²σ²), 1/µm²: λ²W is the window's variance in (u, v).
        roughness: δ, rad.
        angular_radius: α, rad.
        cut: The window along x and y where it is cut to some patches.
    """

    window: float
    roughness: float
    angular_radius: float
    cut: tuple[CutWindow, CutWindow] | None

    @staticmethod
    def of(recipe: HeightFieldRecipe, period: tuple[float, float]) -> _Blur:
        optics = HeightFieldOptics(coherence=recipe.coherence, tiles=recipe.tiles)
        return _Blur(
            optics.window_variance,
            recipe.roughness,
            recipe.angular_radius,
            optics.cut_windows(period),
        )

    def variance(self, w: float) -> float:
        """(wδ)² + α²(1 + w²/4)/2.

        The source's disc projects onto the surface as α²(1 − tt^T), t = (ω_i)_xy. That is α² along
        one axis and α² cos²θ_i along the other; here it is their mean, with cosθ_i = w/2.
        """
        source = self.angular_radius**2 * (1 + w**2 / 4) / 2
        return (w * self.roughness) ** 2 + source

    def narrowest(self, w: float) -> float:
        """Deviation of the narrowest lobe at w."""
        return float(np.sqrt(WAVELENGTH_MIN**2 * self.window + self.variance(w)))

    @property
    def margin(self) -> float:
        """Five deviations of the widest lobe, 4e-6 of its peak, and a cut window's tails."""
        widest = WAVELENGTH_MAX**2 * self.window + self.variance(DIRECTION_MAX)
        tails = max((window.reach(CUT_TAIL) for window in self.cut or ()), default=0.0)
        return 5 * float(np.sqrt(widest)) + WAVELENGTH_MAX * tails

    def grid_steps(self, error: float, w: float) -> tuple[float, float]:
        """Steps along u and v at which splines follow the narrowest lobe at w, to about an error.

        Relative, in the mean square. Linear splines are off by ‖f''‖Δ²/√720, which of a Gaussian f
        is √3 Δ²/(2τ²√720); cubic ones by what lies beyond the Nyquist frequency, where a Gaussian's
        spectrum has fallen to exp(−½π²τ²/Δ²).
        """
        linear = np.sqrt(LINEAR_SHARE * error * 2 * np.sqrt(720 / 3))
        cubic = np.pi / np.sqrt(-2 * np.log(CUBIC_SHARE * error))
        return float(linear * self.narrowest(w)), float(cubic * self.narrowest(w))


@dataclass(frozen=True)
class _Spectrum:
    """|P|²/A as powers on a lattice of spatial frequencies, over p = w/λ.

    Attributes:
        fx, fy: Spatial frequencies, 1/µm.
        nodes: Chebyshev nodes of p, 1/µm.
        powers: Shape (nodes, fy, fx).
        window: W, 1/µm²; 0 where it is cut, and its lobes are in the powers.
        smoothed: Variance by which powers are smoothed besides, 1/µm²; 0 for lines.
    """

    fx: Array
    fy: Array
    nodes: Array
    powers: Singles
    window: float
    smoothed: float

    def deviation(self, wavelength: float, blur: float, least: float = 0) -> float:
        """τ in (u, v) that powers are yet to be widened by.

        Never less than by which they are smoothed: as much as fills the gaps between them.

        Args:
            wavelength: λ, µm.
            blur: Variance of roughness and light.
            least: About the least variance that a whole lobe shall have.
        """
        if least > 0:
            # In place of a maximum, whose kink polynomials over w could not follow: at least 0.6 of
            # it, and no more than 0.5 % above variances from 1.3 of it on.
            blur += least * float(np.exp(-4 * (wavelength**2 * self.window + blur) / least))
        smoothed = wavelength**2 * self.smoothed
        return float(np.sqrt(max(wavelength**2 * self.window + blur - smoothed, smoothed)))

    def at(self, p: Array) -> Singles:
        """Powers at p, shape (len(p), fy, fx)."""
        return np.tensordot(_interpolation(self.nodes, p).astype(np.float32), self.powers, 1)

    def reach(self, share: float) -> Array:
        """Largest |u| and |v| of lines: beyond, at any p, is no more than that share of power."""
        total = self.powers.sum(axis=(1, 2), dtype=np.float64)
        result = []
        for f, axis in ((self.fx, 1), (self.fy, 2)):
            profile = self.powers.sum(axis=axis, dtype=np.float64)
            order = np.argsort(-np.abs(f), kind="stable")
            beyond = np.cumsum(profile[:, order], axis=1) > share * np.abs(total[:, None])
            first = np.argmax(beyond.any(axis=0))
            result.append(WAVELENGTH_MAX * np.abs(f[order[first]]))
        return np.array(result)

    def within(self, reach: Array) -> _Spectrum:
        """The frequencies up to (|f_x|, |f_y|) = `reach`."""
        x, y = np.abs(self.fx) <= reach[0], np.abs(self.fy) <= reach[1]
        return replace(self, fx=self.fx[x], fy=self.fy[y], powers=self.powers[:, y][:, :, x])


def _phase_nodes(field: HeightField, error: float) -> int:
    """Chebyshev nodes for |A|² over the whole range of w/λ, or of w at one wavelength."""
    return 1 + terms_needed("jacobi-anger", 2 * np.pi * field.amplitude * 2 / WAVELENGTH_MIN, error)


def _spectrum(field: HeightField, blur: _Blur, step: float) -> _Spectrum:
    """Powers of all visible lines but order 0.

    Lines of a long patch are dense: they are smoothed, and fewer samples of the sum stand for them.

    Args:
        field: The relief.
        blur: What widens lines.
        step: Along v, of the grid, which need not tell apart what is closer.
    """
    reach = (DIRECTION_MAX + blur.margin) / WAVELENGTH_MIN
    columns, rows = (
        np.arange(-last, last + 1)
        for last in (
            min(int(reach * period), (size - 1) // 2)
            for period, size in zip(field.period, field.heights.shape[::-1], strict=True)
        )
    )
    fx, fy = columns / field.period[0], rows / field.period[1]
    smooth = SMOOTHING * step / WAVELENGTH_MAX
    # A row of Gaussians closes its gaps to 2 exp(−2π²V/h²).
    coarse = smooth * np.pi * np.sqrt(2 / np.log(2 / GAPS))
    is_dense = coarse > max(1 / period for period in field.period) or blur.cut is not None
    to_x, to_y = (_lattice(f, coarse) if is_dense else f for f in (fx, fy))
    cut_x, cut_y = blur.cut or (None, None)
    over_x, over_y = (
        _smoothing(to, f, smooth, cut) if is_dense else np.eye(len(f), dtype=np.float32)
        for to, f, cut in ((to_x, fx, cut_x), (to_y, fy, cut_y))
    )
    nodes = _chebyshev_nodes(0, FARTHEST, _phase_nodes(field, SPECTRUM_ERROR))
    heights = field.amplitude * field.centred
    powers = np.empty((len(nodes), len(to_y), len(to_x)), np.float32)
    for power, p in zip(powers, nodes, strict=True):
        amplitudes = np.asarray(scipy.fft.ifft2(np.exp(2j * np.pi * p * heights), workers=-1))
        lines = (np.abs(amplitudes[np.ix_(rows, columns)]) ** 2).astype(np.float32)
        if blur.cut is None:
            lines[rows == 0, columns == 0] = 0
        power[:] = over_y @ lines @ over_x.T
    window = blur.window if blur.cut is None else 0.0
    return _Spectrum(to_x, to_y, nodes, powers, window, smooth**2 if is_dense else 0.0)


def _lattice(frequencies: Array, step: float) -> Array:
    """Multiples of a step, as far as the frequencies go and one more."""
    last = int(frequencies[-1] / step) + 1
    return step * np.arange(-last, last + 1.0)


def _smoothing(to: Array, of: Array, deviation: float, cut: CutWindow | None) -> Singles:
    """What spreads powers at `of` over samples at `to`, shape (len(to), len(of)).

    By a Gaussian, and by the lobe of a window that is cut.
    """
    distance = to[:, None] - of
    if cut is None:
        density = np.exp(-((distance / deviation) ** 2) / 2) / (np.sqrt(2 * np.pi) * deviation)
    else:
        lobes = BlurredLobes(cut, (deviation, deviation), float(np.abs(distance).max()))
        density = lobes(distance, np.full_like(distance, deviation))
    return ((to[1] - to[0]) * density).astype(np.float32)


def _grid_axes(
    reach: Array, blur: _Blur, error: float, resolved_w: float, file: Path
) -> tuple[Axis, Axis]:
    """The axes of u and v, or a refusal of so large a grid."""
    for w in np.linspace(resolved_w, COARSEST_W, 6).tolist():
        steps = blur.grid_steps(error, w)
        sizes = np.ceil(2 * reach / steps).astype(int) + 1
        if sizes.max() <= LARGEST_GRID:
            break
    else:
        # That resolves all of the visible range, which is as much as can be asked for.
        narrowest = blur.narrowest(COARSEST_W)
        resolved = (
            narrowest
            / blur.grid_steps(error, COARSEST_W)[0]
            * 2
            * DIRECTION_MAX
            / (LARGEST_GRID - 2)
        )
        rest = resolved**2 - narrowest**2 + (COARSEST_W * blur.roughness) ** 2
        least = np.ceil(1e4 * np.sqrt(rest) / COARSEST_W) / 1e4
        expected = (
            f"at least {least:.4f} rad, or lines are too sharp for a table of {LARGEST_GRID} "
            "texels along each axis; jacobi-anger serves sharp surfaces"
        )
        raise InputError(file, "roughness", blur.roughness, expected)
    u, v = (
        Axis(
            name=f"sum of both directions {name}",
            symbol=symbol,
            unit="1",
            size=size,
            first=-half,
            last=half,
        )
        for symbol, name, size, half in zip(
            "uv", ("along x", "along y"), sizes.tolist(), reach.tolist(), strict=True
        )
    )
    return u, v


@dataclass(frozen=True)
class _ColourSum:
    """I(u, v, w) as B-splines over (u, v).

    Attributes:
        spectrum: Powers of the visible frequencies.
        blur: What gives them their width in (u, v).
        axes: Of u and v.
        weights: W·R·1 nm on `WAVELENGTHS`, shape (401, 3).
    """

    spectrum: _Spectrum
    blur: _Blur
    axes: tuple[Axis, Axis]
    weights: Array

    def at(self, w: float) -> Singles:
        """Coefficients of one slice, shape (3, v, u)."""
        u, v = self.axes
        texel = self._texel
        reach = np.array([u.last, v.last]) + self.blur.margin
        result = np.zeros((3, v.size, u.size), np.float32)
        wavelengths = self._wavelengths(w)
        colours = (_hats(wavelengths) @ self.weights).astype(np.float32)
        for some in np.array_split(np.arange(len(wavelengths)), len(wavelengths) // 16 + 1):
            seen = self.spectrum.within(reach / wavelengths[some[0]])
            powers = seen.at(w / wavelengths[some])
            for λ, colour, power in zip(
                wavelengths[some].tolist(), colours[some], powers, strict=True
            ):
                τ = seen.deviation(λ, self.blur.variance(w), (NARROWEST * texel) ** 2)
                along_u = gaussian_moments(λ * seen.fx, τ, u, ALONG_U).astype(np.float32)
                along_v = gaussian_moments(λ * seen.fy, τ, v, ALONG_V).astype(np.float32)
                result += colour[:, None, None] * (along_v.T @ (power @ along_u))
        over_v = coefficients(result.astype(np.float64), 1, ALONG_V)
        return coefficients(over_v, 2, ALONG_U).astype(np.float32)

    @property
    def _texel(self) -> float:
        """Step of the grid along v, the coarser."""
        v = self.axes[1]
        return (v.last - v.first) / (v.size - 1)

    def _wavelengths(self, w: float) -> Array:
        """Wavelengths of the sum: a line moves by less than its lobe, or a texel, in between."""
        u, v = self.axes
        lobe = np.sqrt(WAVELENGTH_MIN**2 * self.blur.window + self.blur.variance(w))
        farthest = min(np.hypot(u.last, v.last), np.sqrt(DIRECTION_MAX**2 - w**2))
        step = WAVELENGTH_REACH * max(lobe, self._texel) * WAVELENGTH_MIN / max(farthest, 1e-3)
        step = np.clip(step, WAVELENGTH_STEP, COARSEST_WAVELENGTH_STEP)
        count = int(np.ceil((WAVELENGTH_MAX - WAVELENGTH_MIN) / step - 1e-9)) + 1
        return np.linspace(WAVELENGTH_MIN, WAVELENGTH_MAX, count)


def _illuminant(recipe: HeightFieldRecipe, file: Path) -> str:
    light = recipe.illuminant
    return str(file.parent / light) if light.endswith(".csv") else light


def _weights(recipe: HeightFieldRecipe, file: Path) -> Array:
    """W·R·1 nm, shape (401, 3)."""
    weights = colour_weights(OBSERVER, _illuminant(recipe, file)) * WAVELENGTH_STEP
    if recipe.metal is None:
        return weights
    return weights * metal_reflectance(recipe.metal)[:, None]


def _hats(wavelengths: Array) -> Array:
    """Shares of each of `WAVELENGTHS` in its two neighbours, shape (len(wavelengths), 401)."""
    step = wavelengths[1] - wavelengths[0]
    return np.maximum(1 - np.abs(wavelengths[:, None] - WAVELENGTHS) / step, 0)


def _chebyshev_nodes(first: float, last: float, count: int) -> Array:
    x = -np.cos(np.pi * (np.arange(count) + 0.5) / count)
    return first + (last - first) * (x + 1) / 2


def _interpolation(nodes: Array, to: Array) -> Array:
    """What multiplies values at Chebyshev nodes, shape (len(to), len(nodes))."""
    count = len(nodes)
    middle = (nodes[0] + nodes[-1]) / 2
    half = (nodes[-1] - nodes[0]) / 2 / np.cos(np.pi / (2 * count))
    at_nodes, at = (chebyshev.chebvander((x - middle) / half, count - 1) for x in (nodes, to))
    # From values at the nodes to coefficients of T_n, by discrete orthogonality.
    at_nodes *= np.where(np.arange(count) == 0, 1, 2) / count
    return at @ at_nodes.T


def _low_rank(
    slices: Singles, start: int, nodes: Array, u: Axis, v: Axis, error: float
) -> tuple[Array, Array]:
    """As few products as keep what is seen within an error, by singular values.

    The singular values are those of I √w in the mean square, about what best serves light and views
    from everywhere: radiance is I/w² times what depends on (u, v), and w is seldom small.

    Args:
        slices: I over w to the power `start` at Chebyshev nodes of w, shape (nodes, 3, v, u).
        start: That power.
        nodes: w.
        u: Axis of the slices.
        v: Likewise.
        error: Relative, of the radiance in the mean square over all light and views.

    Returns:
        ψ/w^start at the nodes, shape (nodes, modes), and B, shape (modes, 3, v, u).
    """
    # Nodes are dense at both ends: each stands for a step √(1 − x²) of w.
    scale = (1 - (2 * nodes / DIRECTION_MAX - 1) ** 2) ** 0.25 * nodes ** (start + 0.5)
    rows = scale[:, None] * slices.reshape(len(nodes), -1)
    gram = np.zeros((len(nodes), len(nodes)))
    for part in np.array_split(rows, 64, axis=1):
        gram += part @ part.T
    vectors = np.linalg.eigh(gram)[1][:, ::-1]
    ψ = vectors / scale[:, None]
    ψ *= np.sign(ψ[np.argmax(np.abs(ψ), axis=0), np.arange(len(nodes))])

    # At texels next to directions as they are met: ψ of all modes, and the slices there.
    seen, weight = _seen_directions()
    row, column = (
        np.clip(np.rint(axis.texel_from_parameter(x)).astype(int), 0, axis.size - 1)
        for axis, x in ((v, seen[1]), (u, seen[0]))
    )
    there = slices[:, :, row, column]
    over_w = _interpolation(nodes, seen[2]) * (weight * seen[2] ** start)[:, None]
    exact = np.einsum("nk,kcn->nc", over_w, there)
    left = exact.copy()
    count = 0
    # The fourth mode of a group takes no more memory.
    while count < len(nodes) and (
        count == 0 or count % 4 == 3 or np.sum(left**2) > error**2 * np.sum(exact**2)
    ):
        mode = np.einsum("k,kcn->nc", ψ[:, count] * scale**2, there)
        left -= (over_w @ ψ[:, count])[:, None] * mode
        count += 1
    modes = (ψ[:, :count] * scale[:, None] ** 2).T @ slices.reshape(len(nodes), -1)
    return ψ[:, :count], modes.reshape(count, *slices.shape[1:])


def _seen_directions() -> tuple[Array, Array]:
    """(u, v, w) of light and view both distributed as the cosine, and what multiplies I there.

    That gives f_r cosθ_i cosθ_o: (1 + ω_i·ω_o)²/w².

    Returns:
        Shape (3, n) and (n,).
    """
    wi, wo = cosine_directions(4096, 0), cosine_directions(4096, 1)
    uvw = (wi + wo).T
    return uvw, (1 + np.sum(wi * wo, axis=1)) ** 2 / uvw[2] ** 2


def cosine_directions(count: int, seed: int) -> Array:
    """Random unit vectors, (count, 3), as dense as their cosine: uniform over the disc below.

    Args:
        count: How many.
        seed: Of the random numbers, a whole number.
    """
    radius, turn = np.random.default_rng(seed).random((2, count))
    x, y = np.sqrt(radius) * np.stack([np.cos(2 * np.pi * turn), np.sin(2 * np.pi * turn)])
    return np.stack([x, y, np.sqrt(1 - radius)], axis=-1)


def _packed_modes(modes: Array, u: Axis, v: Axis) -> Table:
    """Groups of four modes in three layers each."""
    layers = []
    for group in np.split(modes, range(4, len(modes), 4)):
        fourth = group[3] if len(group) == 4 else np.zeros_like(group[0])
        layers += [np.concatenate([mode, fourth[c : c + 1]]) for c, mode in enumerate(group[:3])]
    layer = Axis(
        name="layer", symbol="i", unit="1", size=len(layers), first=0, last=len(layers) - 1
    )
    values = np.moveaxis(np.stack(layers), 1, -1)
    return Table(values, (layer, v, u), ("X", "Y", "Z", "X, Y or Z of the fourth mode"))


def _packed_weights(ψ: Array, w: Axis) -> Table:
    """Four modes to a texel."""
    groups = -(-ψ.shape[1] // 4)
    values = np.zeros((w.size, 4 * groups))
    values[:, : ψ.shape[1]] = ψ
    group = Axis(name="group of modes", symbol="g", unit="1", size=groups, first=0, last=groups - 1)
    channels = tuple(f"psi_{i}" for i in range(4))
    return Table(
        np.moveaxis(values.reshape(w.size, groups, 4), 1, 0), (group, w), channels, "float32"
    )


def _coherent(field: HeightField, blur: _Blur, weights: Array) -> Table:
    """Order 0: 2πτ² Σ_λ W R η_0(w/λ) N(rτ; C(λ)), XYZ.

    η_0(p) = |mean of exp(2πiph)|². C(λ) = λ²/(8π²σ²) + (wδ)² + α² along both axes, and τ² that of
    the longest wavelength.
    """
    fastest = 4 * np.pi * field.amplitude * FARTHEST
    count = max(int(np.ceil(fastest / COHERENT_STEP)), SAMPLES_PER_NODE) + 1
    last = float(np.sqrt(2 * EXPONENT_CUT))
    w = Axis(
        name="sum of the cosines", symbol="w", unit="1", size=count, first=0, last=DIRECTION_MAX
    )
    r = Axis(
        name="distance over deviation",
        symbol="r",
        unit="1",
        size=int(np.ceil(last / COHERENT_STEP)) + 1,
        first=0,
        last=last,
    )
    nodes = _chebyshev_nodes(0, FARTHEST, _phase_nodes(field, SPECTRUM_ERROR))
    means = np.array(
        [np.mean(np.exp(2j * np.pi * p * field.centred * field.amplitude)) for p in nodes]
    )
    values = np.zeros((r.size, w.size, 4))
    for column, at in enumerate(w.parameters().tolist()):
        η_0 = np.abs(_interpolation(nodes, at / WAVELENGTHS) @ means) ** 2
        same = (at * blur.roughness) ** 2 + blur.angular_radius**2
        variance = WAVELENGTHS**2 * blur.window + same
        narrower = variance / (WAVELENGTH_MAX**2 * blur.window + same)
        lobe = np.exp(-(r.parameters()[:, None] ** 2) / (2 * narrower)) / narrower
        values[:, column, :3] = lobe @ (η_0[:, None] * weights)
    return Table(values, (r, w), ("X", "Y", "Z", "unused"))


@dataclass(frozen=True)
class _Seen:
    """What is seen of a pattern where lines are lit, by which the grid is chosen and judged.

    Views are as dense as their cosine; a line drawn by its power, at a wavelength drawn by its
    weight in Y, says where the light stands.

    Attributes:
        uvw: ω_i + ω_o, shape (n, 3).
        factor: What multiplies I to give f_r cosθ_i cosθ_o, shape (n, 1).
        radiance: That, XYZ, shape (n, 3), by summing over the spectrum.
    """

    uvw: Array
    factor: Array
    radiance: Array

    @staticmethod
    def of(spectrum: _Spectrum, blur: _Blur, weights: Array) -> _Seen:
        rng = np.random.default_rng(2)
        power = np.maximum(spectrum.powers.mean(axis=0), 0).ravel().astype(np.float64)
        frequencies = np.stack(np.meshgrid(spectrum.fx, spectrum.fy), axis=-1).reshape(-1, 2)
        lights, views = np.empty((0, 3)), np.empty((0, 3))
        for _ in range(ERROR_ROUNDS):
            if len(lights) >= ERROR_DIRECTIONS:
                break
            wo = cosine_directions(ERROR_DIRECTIONS, int(rng.integers(2**31)))
            line = rng.choice(len(power), len(wo), p=power / power.sum())
            λ = rng.choice(WAVELENGTHS, len(wo), p=weights[:, 1] / weights[:, 1].sum())
            tilt = rng.normal(size=(len(wo), 2)) * 2 * np.hypot(blur.roughness, blur.angular_radius)
            xy = λ[:, None] * frequencies[line] + tilt - wo[:, :2]
            above = np.sum(xy**2, axis=1) < 1
            xy = xy[above]
            wi = np.column_stack([xy, np.sqrt(1 - np.sum(xy**2, axis=1))])
            lights, views = np.concatenate([lights, wi]), np.concatenate([views, wo[above]])
        uvw = lights + views
        factor = (1 + np.sum(lights * views, axis=1, keepdims=True)) ** 2 / uvw[:, 2:] ** 2
        sums = [_direct_sum(spectrum, blur, weights, *at) for at in uvw.tolist()]
        return _Seen(uvw, factor, factor * np.reshape(sums, (-1, 3)))

    @property
    def resolved_w(self) -> float:
        """Least w to resolve: errors of the splines grow with 1/w² below, and so count."""
        signal = np.sum(self.radiance**2, axis=1)
        if not signal.any():
            return COARSEST_W
        w = float(np.sum(signal / self.uvw[:, 2] ** 4) / np.sum(signal)) ** -0.25
        return float(np.clip(w, LEAST_W, COARSEST_W))

    def error(self, baked: Map) -> dict[str, float | str]:
        """The stored tables against the sums."""
        found = self.factor * BakedLookup(baked).pattern(*self.uvw.T)
        total = max(float(np.sum(self.radiance**2)), np.finfo(float).tiny)
        off = np.sum((found - self.radiance) ** 2) / total
        against = f"sums over spatial frequencies by 1 nm, {len(found)} lights and views"
        return {"relative_rms": float(np.sqrt(off)), "against": against}


def _direct_sum(
    spectrum: _Spectrum, blur: _Blur, weights: Array, u: float, v: float, w: float
) -> Array:
    """I(u, v, w), XYZ."""
    λ = WAVELENGTHS[:, None]
    τ = np.array([spectrum.deviation(x, blur.variance(w)) for x in WAVELENGTHS.tolist()])[:, None]
    near_x, near_y = (
        np.flatnonzero((np.abs(d - λ * f) < 6 * τ).any(axis=0))
        for d, f in ((u, spectrum.fx), (v, spectrum.fy))
    )
    along_x, along_y = (
        np.exp(-(((d - λ * f) / τ) ** 2) / 2) / (np.sqrt(2 * np.pi) * τ)
        for d, f in ((u, spectrum.fx[near_x]), (v, spectrum.fy[near_y]))
    )
    powers = spectrum.powers[:, near_y[:, None], near_x]
    over_p = _interpolation(spectrum.nodes, w / WAVELENGTHS)
    over_y = np.einsum("pys,sy->ps", powers @ along_x.T, along_y)
    return np.sum(over_p * over_y.T, axis=1) @ weights
