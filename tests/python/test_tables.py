"""Baked tables against closed forms and quadrature, and the errors that sidecars record."""

import itertools
from pathlib import Path

import numpy as np
import pytest
from example_profiles import PROFILES
from scipy.integrate import quad
from scipy.special import jv

from precompute.efficiencies import profile_map
from precompute.lobes import lobe_wavenumber, lobes_map, metals_map
from precompute.maps import Map
from precompute.profiles import (
    Profile,
    Sinusoidal,
    efficiency,
)
from precompute.recipes import LobesRecipe, MetalsRecipe, ProfileRecipe
from precompute.spectra import METALS, WAVELENGTHS, colour_weights, metal_reflectance, tint_basis


def stored(baked: Map, folder: Path) -> Map:
    """As it is read back, with the precision of the file."""
    baked.write(folder, "table")
    return Map.read(folder / "table")


@pytest.mark.parametrize("profile", PROFILES, ids=lambda p: p.kind)
def test_efficiency_table_between_its_texels(profile: Profile, tmp_path: Path) -> None:
    baked = stored(profile_map(ProfileRecipe(kind="profile", profile=profile)), tmp_path)
    table = baked.tables["efficiency"]
    φ = np.random.default_rng(3).uniform(0, 20, 300)
    for m in (-16, -3, -1, 0, 1, 2, 5):
        found = table.sample(np.full(300, float(m)), φ)[:, 0]
        # Half a texel of curvature near φ = 20, and the precision of halves.
        assert found == pytest.approx(efficiency(profile, m, φ), abs=1.5e-3)
    assert bool(baked.constants["symmetric"]) == (profile.kind in ("sinusoidal", "rectangular"))


def test_sinusoidal_table_is_bessel() -> None:
    """Against the textbook's J_m², not the package's own closed form."""
    table = profile_map(ProfileRecipe(kind="profile", profile=Sinusoidal())).tables["efficiency"]
    m, φ = np.meshgrid(np.arange(-16, 17), table.axes[1].parameters(), indexing="ij")
    assert table.values[..., 0] == pytest.approx(jv(m, φ / 2) ** 2, abs=1e-12)


def test_shallow_gratings_keep_their_relative_precision(tmp_path: Path) -> None:
    """η_1 starts as φ²/16: with phases at equal steps it would be linear up to φ = 0.04."""
    baked = stored(profile_map(ProfileRecipe(kind="profile", profile=Sinusoidal())), tmp_path)
    φ = np.geomspace(0.05, 1, 50)
    found = baked.tables["efficiency"].sample(np.ones(50), φ)[:, 0]
    assert found == pytest.approx(jv(1, φ / 2) ** 2, rel=5e-3)


@pytest.mark.parametrize("tint", [0, 1, 2], ids=["white", "red", "green"])
def test_lobe_table_is_a_gaussian_average(tint: int) -> None:
    recipe = LobesRecipe(kind="lobes", illuminant="LED-B3", wavenumbers=24, widths=4)
    table = lobes_map(recipe, Path()).tables["lobe"]
    widths, positions = table.axes[1].parameters(), table.axes[2].parameters()
    share = np.ones(401) if tint == 0 else tint_basis()[:, tint - 1]
    weights = share[:, None] * colour_weights("1931-2", "LED-B3")
    for row, column in [(0, 8), (0, 13), (1, 3), (2, 10), (3, 0), (3, 12), (3, 23)]:
        q = float(widths[row])
        middle = float(lobe_wavenumber(positions[column], np.array(q)))
        low, high = max(1 / 0.78, middle - 7 * q), min(1 / 0.38, middle + 7 * q)

        def spectrum(s: float) -> float:
            return sum(float(np.interp(1 / s, WAVELENGTHS, w)) for w in weights.T)

        def gaussian(s: float, middle: float = middle, q: float = q) -> float:
            return np.exp(-(((s - middle) / q) ** 2) / 2) / (np.sqrt(2 * np.pi) * q)

        def average(power: int, low: float = low, high: float = high) -> float:
            def integrand(s: float) -> float:
                return s**power * gaussian(s) * spectrum(s)

            # In pieces about the lobe: the spectrum has a kink at every nanometre.
            edges = np.linspace(low, high, 41)
            return sum(
                quad(integrand, a, b, limit=200, epsabs=1e-8, epsrel=1e-6)[0]
                for a, b in itertools.pairwise(edges)
            )

        energy = average(0)
        found = table.values[tint, row, column]
        assert found[:3].sum() == pytest.approx(energy, rel=2e-5, abs=1e-6)
        if energy > 1e-3:
            assert found[3] == pytest.approx(average(1) / energy, rel=2e-5)


def test_weights_add_up_to_the_white_point() -> None:
    baked = lobes_map(LobesRecipe(kind="lobes", wavenumbers=8, widths=4), Path())
    last = baked.tables["weights"].values[-1].reshape(3, 3)
    assert last.sum(axis=0) == pytest.approx(np.array(baked.constants["white_xyz"]), rel=1e-4)
    assert np.all(baked.tables["weights"].values[0] == 0)


@pytest.mark.parametrize("profile", PROFILES, ids=lambda p: p.kind)
def test_recorded_error_of_a_profile_is_reproduced(profile: Profile, tmp_path: Path) -> None:
    recipe = ProfileRecipe(kind="profile", profile=profile, samples=64, max_order=4)
    baked = stored(profile_map(recipe), tmp_path)
    x = (np.arange(63) + 0.5) / 63
    m, φ = np.meshgrid(np.arange(-4.0, 5), 20 * x**2, indexing="ij")
    exact = np.stack([efficiency(profile, int(row[0]), φ[0]) for row in m])
    off = baked.tables["efficiency"].sample(m, φ)[..., 0] - exact
    expected = np.sqrt(np.sum(off**2) / np.sum(exact**2))
    assert baked.error["relative_rms"] == pytest.approx(expected, rel=1e-6)
    assert expected > 1e-4  # coarse enough that there is an error to speak of


def test_recorded_error_of_lobes_is_reproduced(tmp_path: Path) -> None:
    recipe = LobesRecipe(kind="lobes", wavenumbers=32, widths=4)
    baked = stored(lobes_map(recipe, Path()), tmp_path)
    table = baked.tables["lobe"]
    q = table.axes[1].parameter_from_texel(np.arange(3) + 0.5)
    x = table.axes[2].parameter_from_texel(np.arange(31) + 0.5)
    q, x = np.meshgrid(q, x, indexing="ij")
    # Over wavelength, ds = dλ/λ², by rectangles a tenth of a nanometre wide.
    λ = np.linspace(0.38, 0.78, 4001)
    weights = np.stack(
        [np.interp(λ, WAVELENGTHS, w) for w in colour_weights("1931-2", "D65").T], axis=-1
    )
    away = (1 / λ - lobe_wavenumber(x, q)[..., None]) / q[..., None]
    gaussian = np.exp(-(away**2) / 2) / (np.sqrt(2 * np.pi) * q[..., None])
    exact = (gaussian / λ**2) @ weights * 1e-4
    off = table.sample(np.zeros_like(q), q, x)[..., :3] - exact
    expected = np.sqrt(np.sum(off**2) / np.sum(exact**2))
    assert baked.error["relative_rms"] == pytest.approx(expected, rel=1e-2)


def test_recorded_error_of_metals_is_reproduced(tmp_path: Path) -> None:
    baked = stored(metals_map(MetalsRecipe(kind="metals", wavenumbers=16)), tmp_path)
    s = 1 / 0.78 + (1 / 0.38 - 1 / 0.78) * (np.arange(15) + 0.5) / 15
    exact = np.stack([metal_reflectance(metal, 1 / s) for metal in METALS], axis=-1)
    off = baked.tables["reflectance"].sample(np.zeros(15), s) - exact
    expected = np.sqrt(np.sum(off**2) / np.sum(exact**2))
    assert baked.error["relative_rms"] == pytest.approx(expected, rel=1e-6)
