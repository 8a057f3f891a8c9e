"""The map of terms, the series summed from it, and the maps that recipes give."""

import json
from pathlib import Path

import numpy as np
import pytest
from refusals import refused

from precompute.bake import bake
from precompute.gratings import Light
from precompute.height_fields.expansion import (
    Expansion,
    basis,
    coefficients,
    phase_length,
    taylor_cancellation,
    terms_needed,
    worst_phase,
)
from precompute.height_fields.field import HeightField
from precompute.height_fields.lines import line_amplitudes
from precompute.height_fields.optics import HeightFieldOptics
from precompute.height_fields.reference import colour_brdf
from precompute.height_fields.term_sum import TermsMethod, even_and_odd_sums
from precompute.height_fields.terms import POWER_LEFT_OUT, terms_map, visible_lines
from precompute.maps import Map

EXPANSIONS: tuple[Expansion, ...] = ("jacobi-anger", "taylor")


def bumps(height: float, rows: int = 48, columns: int = 60) -> HeightField:
    """One smooth bump 1 µm × 0.5 µm large in a cell of 2.5 µm × 2 µm, and a smaller one."""
    y, x = np.meshgrid(
        2 * np.arange(rows) / rows, 2.5 * np.arange(columns) / columns, indexing="ij"
    )

    def bump(at_x: float, at_y: float, length: float, width: float) -> np.ndarray:
        dx, dy = np.abs(x - at_x) / length, np.abs(y - at_y) / width
        return np.where((dx < 0.5) & (dy < 0.5), (np.cos(np.pi * dx) * np.cos(np.pi * dy)) ** 2, 0)

    heights = bump(0.8, 1, 1, 0.5) + 0.6 * bump(1.9, 0.7, 0.7, 0.9)
    return HeightField(height * heights / heights.max(), (2.5 / columns, 2 / rows))


def read_back(baked: Map, folder: Path) -> Map:
    """With the precision of the file."""
    baked.write(folder, "map")
    return Map.read(folder / "map")


def relative(found: np.ndarray, exact: np.ndarray) -> float:
    return float(np.sqrt(np.sum(np.abs(found - exact) ** 2) / np.sum(np.abs(exact) ** 2)))


@pytest.mark.parametrize("expansion", EXPANSIONS)
def test_texels_are_transforms_of_the_basis(expansion: Expansion) -> None:
    field = bumps(0.15)
    baked = terms_map(field, expansion, 5, 1e-3, {}, "bumps.json")
    table = baked.tables["terms"]
    assert table.dtype == ("float16" if expansion == "jacobi-anger" else "float32")
    pairs, rows, columns, _ = table.values.shape
    assert pairs == 3
    assert np.all(table.values[2, ..., 2:] == 0)  # there is no sixth term
    along_y, along_x = (axis.parameters().astype(int) for axis in table.axes[1:])
    assert along_y.tolist() == list(range(-(rows // 2), rows // 2 + 1))
    assert along_x.tolist() == list(range(columns))
    y, x = np.meshgrid(np.arange(48) / 48, np.arange(60) / 60, indexing="ij")
    tolerance = 2e-4 if expansion == "jacobi-anger" else 1e-7
    for n, b in enumerate(basis(expansion, field, 5)):
        for j, l in ((0, 0), (1, -2), (3, 4), (0, 5)):  # noqa: E741
            stored = table.values[n // 2, l + rows // 2, j, 2 * (n % 2) : 2 * (n % 2) + 2]
            g = 1j**n * np.mean(b * np.exp(2j * np.pi * (j * x + l * y)))
            assert complex(*stored) == pytest.approx(g, abs=tolerance)
            opposite = 1j**n * np.mean(b * np.exp(-2j * np.pi * (j * x + l * y)))
            assert opposite == pytest.approx((-1) ** n * np.conj(g), abs=1e-12)


@pytest.mark.parametrize("expansion", EXPANSIONS)
def test_coefficients_between_their_samples(expansion: Expansion, tmp_path: Path) -> None:
    baked = read_back(terms_map(bumps(0.15), expansion, 12, 1e-3, {}, "bumps.json"), tmp_path)
    table = baked.tables["coefficients"]
    x = np.random.default_rng(1).uniform(0, baked.constants["max_phase"], 500)
    exact = coefficients(expansion, 12, x)
    found = np.stack([table.sample(np.full(500, n), x)[:, 0] for n in range(12)])
    assert np.abs(found - exact).max() <= 1e-4 * max(1, np.abs(exact).max())


@pytest.mark.parametrize("expansion", EXPANSIONS)
def test_constants_say_how_to_read_the_map(expansion: Expansion) -> None:
    field = bumps(0.15)
    baked = terms_map(field, expansion, None, 1e-3, {"kind": "height-field"}, "bumps.json")
    k = 2 * np.pi / 0.38
    constants = baked.constants
    assert (constants["period_x"], constants["period_y"]) == pytest.approx((2.5, 2))
    assert constants["range"] == pytest.approx(0.15)
    assert constants["amplitude"] == pytest.approx(0.075 if expansion == "jacobi-anger" else 0.15)
    worst = 2 * k * float(np.ravel(constants["amplitude"])[0])
    assert worst < float(np.ravel(constants["max_phase"])[0]) < 1.02 * worst
    assert constants["terms"] == terms_needed(expansion, worst, 1e-3)


@pytest.mark.parametrize("expansion", EXPANSIONS)
def test_recorded_error_is_reproduced(expansion: Expansion, tmp_path: Path) -> None:
    """With few enough terms that there is an error to speak of."""
    field = bumps(0.15)
    count = 4 if expansion == "jacobi-anger" else 13
    baked = read_back(terms_map(field, expansion, count, 1e-3, {}, "bumps.json"), tmp_path)
    method = TermsMethod(baked, HeightFieldOptics())
    limit_x, limit_y = visible_lines(field)
    lines = np.stack(
        np.meshgrid(np.arange(-limit_x, limit_x + 1), np.arange(-limit_y, limit_y + 1)), axis=-1
    ).reshape(-1, 2)
    found, exact = [], []
    for part in range(1, 7):
        kw = 4 * np.pi / 0.38 * part / 6
        found.append(np.abs(method.line_amplitude(lines, np.full(len(lines), kw))))
        exact.append(np.abs(line_amplitudes(field, kw)[lines[:, 1], lines[:, 0]]))
    expected = relative(np.stack(found), np.stack(exact))
    assert expected > 1e-3
    assert baked.error["relative_rms"] == pytest.approx(expected, rel=1e-4)


def test_lines_without_power_are_left_out() -> None:
    field = bumps(0.15)
    baked = terms_map(field, "jacobi-anger", None, 1e-3, {}, "bumps.json")
    _, rows, columns, _ = baked.tables["terms"].values.shape
    limit_x, limit_y = visible_lines(field)
    assert columns <= limit_x + 1 and rows <= 2 * limit_y + 1
    assert columns * rows < (limit_x + 1) * (2 * limit_y + 1)
    j, l = (np.abs(np.fft.fftfreq(n, 1 / n)) for n in (60, 48))  # noqa: E741
    seen = (j[None] <= limit_x) & (l[:, None] <= limit_y)
    kept = (j[None] < columns) & (l[:, None] <= rows // 2)
    for kw in 4 * np.pi / 0.38 * np.array([0.2, 0.5, 1]):
        power = np.abs(line_amplitudes(field, kw)) ** 2
        assert power[seen & ~kept].sum() <= 1.01 * POWER_LEFT_OUT


def test_a_relief_of_one_dimension_has_one_row_of_lines() -> None:
    heights = np.tile(0.1 * np.cos(2 * np.pi * np.arange(40) / 40), (20, 1))
    for h, rows in ((heights, 1), (heights.T, None)):
        baked = terms_map(HeightField(h, (0.05, 0.05)), "jacobi-anger", 1, 1e-3, {}, "x.json")
        pairs, along, across, _ = baked.tables["terms"].values.shape
        assert pairs == 1
        assert (along if rows else across) == 1


@pytest.mark.parametrize("expansion", EXPANSIONS)
@pytest.mark.parametrize(
    ("roughness", "radius", "step"), [(0, 0, 0.002), (0, 0.01, 0.005), (0.0175, 0, 0.005)]
)
def test_colours_are_the_references(
    expansion: Expansion, roughness: float, radius: float, step: float, tmp_path: Path
) -> None:
    """Where nothing blurs them, lines are narrower than the papers' 5 nm."""
    field = bumps(0.15)
    baked = read_back(terms_map(field, expansion, None, 1e-3, {}, "bumps.json"), tmp_path)
    optics = HeightFieldOptics(metal="copper", roughness=roughness)
    light = Light(angular_radius=radius, tint=(1, 0.7, 0.5)) if radius else Light()
    rng = np.random.default_rng(4)
    xy = rng.uniform(-0.5, 0.5, (60, 2))
    wo = np.column_stack([xy, np.sqrt(1 - np.sum(xy**2, axis=1))])
    wi = np.tile([0.3, 0.1, np.sqrt(0.9)], (60, 1))
    wo[0, 2] *= -1  # below the horizon: dark
    found = TermsMethod(baked, optics, step).colour_brdf(wi, wo, light)
    exact = colour_brdf(field, optics, wi, wo, light)
    assert np.all(found[0] == 0)
    assert relative(found, exact) <= (0.01 if step < 0.005 else 0.004)


def test_interference_of_neighbouring_lines_is_kept(tmp_path: Path) -> None:
    field = bumps(0.15)
    baked = read_back(terms_map(field, "jacobi-anger", None, 1e-3, {}, "bumps.json"), tmp_path)
    optics = HeightFieldOptics(coherence=1.0, energy="relative")
    xy = np.random.default_rng(4).uniform(-0.5, 0.5, (100, 2))
    wo = np.column_stack([xy, np.sqrt(1 - np.sum(xy**2, axis=1))])
    wi = np.tile([0.3, 0.1, np.sqrt(0.9)], (100, 1))
    found = TermsMethod(baked, optics).colour_brdf(wi, wo, Light())
    assert relative(found, colour_brdf(field, optics, wi, wo, Light())) <= 0.01


X_HIGH = np.linspace(0, 80, 17)


def errors_of_amplitudes(field: HeightField, expansion: Expansion, dtype: type) -> np.ndarray:
    """Relative RMS error of all lines' amplitudes at each x up to 80, sums in float32."""
    length = phase_length(expansion, field)
    count = terms_needed(expansion, 80, 1e-3)
    terms = np.zeros(((count + 1) // 2, *field.heights.shape, 4), dtype)
    for n, b in enumerate(basis(expansion, field, count)):
        g = 1j**n * np.fft.ifft2(b)
        terms[n // 2, ..., 2 * (n % 2)], terms[n // 2, ..., 2 * (n % 2) + 1] = g.real, g.imag
    errors = []
    for x in X_HIGH:
        with np.errstate(over="ignore"):
            c = coefficients(expansion, count, [x])[:, :, None].astype(np.float32)
        with np.errstate(invalid="ignore", over="ignore"):
            found = np.abs(np.add(*even_and_odd_sums(terms, c)))
        exact = np.abs(line_amplitudes(field, x / length))
        errors.append(relative(found, exact))
    return np.array(errors)


@pytest.mark.parametrize("dtype", [np.float16, np.float32])
def test_jacobi_anger_is_stable(dtype: type) -> None:
    errors = errors_of_amplitudes(bumps(80 / (2 * np.pi / 0.38)), "jacobi-anger", dtype)
    assert np.all(errors <= 0.02)  # of a NaN or an infinity that is false


def test_the_map_of_a_high_relief_is_stable(tmp_path: Path) -> None:
    field = bumps(80 / (2 * np.pi / 0.38))
    assert worst_phase("jacobi-anger", field) == pytest.approx(80)
    baked = read_back(terms_map(field, "jacobi-anger", None, 1e-3, {}, "high.json"), tmp_path)
    assert float(baked.error["relative_rms"]) <= 0.02
    method = TermsMethod(baked, HeightFieldOptics())
    limit = method.limit
    j, l = (grid.ravel() for grid in np.mgrid[-limit[0] : limit[0] + 1, -limit[1] : limit[1] + 1])  # noqa: E741
    lines = np.stack([j, l], axis=-1)
    for x in X_HIGH:
        kw = x / float(np.ravel(baked.constants["amplitude"])[0])
        found = np.abs(method.line_amplitude(lines, np.full(len(lines), kw)))
        assert relative(found, np.abs(line_amplitudes(field, kw)[l, j])) <= 0.02


def test_the_failure_of_taylor_is_predicted() -> None:
    errors = errors_of_amplitudes(bumps(0.3), "taylor", np.float32)
    predicted = np.array([taylor_cancellation(float(x)) for x in X_HIGH])
    assert np.all(errors[predicted <= 0.01] <= 0.02)
    assert not np.any(errors[predicted > 1] <= 0.02)


def test_taylor_is_refused_before_anything_is_written(tmp_path: Path) -> None:
    recipe = {
        "kind": "height-field",
        "source": {"kind": "cosine", "height": 0.6, "period": 5.0},
        "methods": ["jacobi-anger", "taylor"],
    }
    file = tmp_path / "height-field-high.json"
    file.write_text(json.dumps(recipe), "utf-8")
    with refused(file, "methods", "taylor", "jacobi-anger"):
        bake(file, tmp_path / "maps")
    assert not (tmp_path / "maps").exists()


def test_a_recipe_gives_a_map_for_each_method_and_the_same_bytes_again(tmp_path: Path) -> None:
    recipe = {
        "kind": "height-field",
        "source": {"kind": "bumps"},
        "methods": ["taylor", "jacobi-anger"],
        "terms": 26,
    }
    file = tmp_path / "height-field-bumps.json"
    file.write_text(json.dumps(recipe), "utf-8")
    once, again = (bake(file, tmp_path / folder) for folder in ("once", "again"))
    assert [f.name for f in once if f.suffix == ".json"] == [
        "height-field-bumps-taylor.json",
        "height-field-bumps-jacobi-anger.json",
    ]
    assert [f.read_bytes() for f in once] == [f.read_bytes() for f in again]
    for name in ("taylor", "jacobi-anger"):
        baked = Map.read(tmp_path / "once" / f"height-field-bumps-{name}")
        assert baked.kind == "height-field-terms"
        assert baked.constants["terms"] == 26
        assert baked.recipe["source"]["kind"] == "bumps"
