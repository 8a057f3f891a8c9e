"""The command `diffraction`, run as from a terminal."""

import csv
import io
import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from scipy.special import jv
from typer.testing import CliRunner, Result

from precompute.bake import bake
from precompute.cli import app
from precompute.closed_form import ClosedForm
from precompute.gratings import Grating, Light
from precompute.reference import colour_brdf, spectral_brdf

MIRROR = {"kind": "grating", "period": 1.0, "height": 0.1, "metal": None}
DIRECTIONS = "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z"
# Normal incidence; the first order of 0.5 µm by a period of 1 µm is at sinθ = 1/2.
FIRST_ORDER = "0,0,1,0.5,0,0.8660254037844386"


def run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(app, [str(a) for a in arguments], catch_exceptions=False)


def evaluate(
    folder: Path, recipe: dict[str, object], table: str, *options: str
) -> tuple[Result, list[dict[str, str]]]:
    (folder / "recipe.json").write_text(json.dumps(recipe))
    (folder / "in.csv").write_text(table)
    result = run("evaluate", folder / "recipe.json", folder / "in.csv", *options)
    return result, list(csv.DictReader(io.StringIO(result.stdout)))


def numbers(row: dict[str, str], *names: str) -> list[float]:
    return [float(row[name]) for name in names]


def test_orders_at_normal_incidence_by_hand(tmp_path: Path) -> None:
    result, rows = evaluate(
        tmp_path,
        {**MIRROR, "energy": "kirchhoff"},
        "name,theta_i_deg,phi_i_deg,wavelength_um\nfirst,0,0,0.5\n",
        "--orders",
    )
    assert result.exit_code == 0 and result.stderr == ""
    assert [row["m"] for row in rows] == ["-1", "0", "1"]  # ±2 would graze: not above the horizon
    assert [row["name"] for row in rows] == ["first"] * 3
    cosine = np.sqrt(3) / 2
    for row, x, z in zip(rows, (-0.5, 0, 0.5), (cosine, 1, cosine), strict=True):
        assert numbers(row, "wo_x", "wo_y", "wo_z") == pytest.approx([x, 0, z], abs=1e-12)
        w = 1 + z
        η = jv(int(row["m"]), np.pi * w * 0.1 / 0.5) ** 2
        obliquity = (1 + z) ** 2 / (z * w**2)
        assert numbers(row, "efficiency", "e_m") == pytest.approx([η, obliquity * η])


def test_orders_at_conical_incidence_by_hand(tmp_path: Path) -> None:
    """θ = 30°, φ = 90°: along the groove, so that every order keeps ω_y = −1/2."""
    table = "theta_i_deg,phi_i_deg,wavelength_um\n30,90,0.6\n0,0,0.7\n"
    _, rows = evaluate(tmp_path, MIRROR, table, "--orders")
    assert [row["m"] for row in rows] == ["-1", "0", "1", "-1", "0", "1"]
    assert numbers(rows[2], "wo_x", "wo_y", "wo_z") == pytest.approx([0.6, -0.5, 0.39**0.5])
    # All that a perfect mirror reflects at φ = 90° is in orders that come in pairs.
    assert float(rows[0]["e_m"]) == pytest.approx(float(rows[2]["e_m"]))


def test_orders_with_a_metal_lose_what_it_absorbs(tmp_path: Path) -> None:
    table = "theta_i_deg,phi_i_deg,wavelength_um\n20,30,0.45\n"
    _, mirror = evaluate(tmp_path, MIRROR, table, "--orders")
    _, gold = evaluate(tmp_path, {**MIRROR, "metal": "gold"}, table, "--orders")
    for perfect, absorbing in zip(mirror, gold, strict=True):
        assert perfect["efficiency"] == absorbing["efficiency"]
        share = float(absorbing["e_m"]) / float(perfect["e_m"])
        assert share == pytest.approx(0.39, abs=0.05)


def test_brdf_at_a_wavelength(tmp_path: Path) -> None:
    table = f"{DIRECTIONS},wavelength_um,n\n{FIRST_ORDER},0.5,7\n{FIRST_ORDER},0.6,8\n"
    result, rows = evaluate(tmp_path, {**MIRROR, "energy": "kirchhoff"}, table)
    assert result.exit_code == 0
    assert list(rows[0]) == [*DIRECTIONS.split(","), "wavelength_um", "n", "brdf"]
    assert [row["n"] for row in rows] == ["7", "8"]
    # On the order's middle, G/w²·4πσ²·η/(λ²)… by theory: e_m/(cosθ_i cosθ_o dω) of a Gaussian of
    # variance λ²/(8π²σ²) in u and v: e_m · 8π²σ²/(2πλ²), of (1 + ω_i·ω_o)²/(cosθ_i cosθ_o w²)·η.
    cosine = np.sqrt(3) / 2
    η = jv(1, np.pi * (1 + cosine) * 0.1 / 0.5) ** 2
    expected = (1 + cosine) ** 2 / (cosine * (1 + cosine) ** 2) * η * 4 * np.pi * 16.25**2 / 0.25
    assert float(rows[0]["brdf"]) == pytest.approx(expected)
    assert float(rows[1]["brdf"]) == 0  # 0.1 away in u, 24 standard deviations


def test_brdf_of_a_wide_source_is_lower(tmp_path: Path) -> None:
    table = f"{DIRECTIONS},wavelength_um\n{FIRST_ORDER},0.5\n"
    _, point = evaluate(tmp_path, MIRROR, table)
    _, flash = evaluate(tmp_path, {**MIRROR, "angular_radius": 0.01}, table)
    variance = 0.25 / (8 * np.pi**2 * 16.25**2)
    expected = float(point[0]["brdf"]) * variance / (variance + 1e-4)
    assert float(flash[0]["brdf"]) == pytest.approx(expected)


def test_colour_by_each_method(tmp_path: Path) -> None:
    """Full precision: what is printed is the number that the method gives, to the last bit."""
    grating = Grating(period=1.0, height=0.1, metal=None)
    wi, wo = np.split(np.array([[float(n) for n in FIRST_ORDER.split(",")]]), 2, axis=1)
    wo /= np.linalg.norm(wo)
    table = f"{DIRECTIONS},note\n{FIRST_ORDER},here\n{FIRST_ORDER.replace('0.866', '-0.866')},low\n"
    found = {}
    for method in ("reference", "closed-form", "wavelength-loop"):
        result, rows = evaluate(tmp_path, MIRROR, table, "--method", method)
        assert result.exit_code == 0
        assert [row["note"] for row in rows] == ["here", "low"]
        found[method] = numbers(rows[0], "X", "Y", "Z")
        assert numbers(rows[1], "X", "Y", "Z") == [0, 0, 0]
    assert found["reference"] == colour_brdf(grating, wi, wo, Light())[0].tolist()
    assert found["closed-form"] == ClosedForm(grating, Light()).colour_brdf(wi, wo)[0].tolist()
    margin = 0.01 * max(found["reference"])
    assert found["closed-form"] == pytest.approx(found["reference"], abs=margin)
    assert found["wavelength-loop"] != found["closed-form"]
    assert found["wavelength-loop"] == pytest.approx(found["reference"], rel=0.3)


def test_the_recipe_names_method_light_and_loop(tmp_path: Path) -> None:
    table = f"{DIRECTIONS}\n{FIRST_ORDER}\n"

    def colour(**options: object) -> list[float]:
        _, rows = evaluate(tmp_path, {**MIRROR, **options}, table)
        return numbers(rows[0], "X", "Y", "Z")

    loop = colour(method="wavelength-loop")
    fine = colour(method="wavelength-loop", wavelength_step=0.001)
    taylor = colour(method="wavelength-loop", efficiencies="taylor")
    assert fine == pytest.approx(colour(), rel=0.01)
    assert len({tuple(c) for c in (loop, fine, taylor)}) == 3
    # 0.5 µm has next to nothing of red.
    assert colour(tint=[1, 0, 0])[1] < 0.05 * colour()[1]
    assert colour(illuminant="A")[1] != colour()[1]
    (tmp_path / "lamp.csv").write_text("wavelength_um,power\n0.55,1\n0.7,1\n")
    assert colour(illuminant="lamp.csv") == [0, 0, 0]  # no light at 0.5 µm


def test_directions_of_three_decimals_are_scaled_to_unit_length(tmp_path: Path) -> None:
    grating = Grating(period=1.0, height=0.1, metal=None)
    table = f"{DIRECTIONS},wavelength_um\n0,0,1,0.5,0,0.866,0.5\n"
    _, rows = evaluate(tmp_path, MIRROR, table)
    wo = np.array([[0.5, 0, 0.866]])
    wo /= np.linalg.norm(wo)
    expected = spectral_brdf(grating, np.array([[0, 0, 1.0]]), wo, [0.5])[0]
    assert float(rows[0]["brdf"]) == expected


@pytest.mark.parametrize(
    ("table", "options", "line"),
    [
        ("", [], "header = 'an empty file': expected a line of column names"),
        ("wi_x\n1\n", [], "wi_y = 'wi_x': expected a column wi_y"),
        (f"{DIRECTIONS}\n", [], "rows = 'none below the header': expected one or more rows"),
        (
            f"{DIRECTIONS}\n0,0,1,0,0,1\n0,0,1,0,0.1,1\n",
            [],
            "wo_x, wo_y, wo_z, line 3 = [0.0, 0.1, 1.0]: expected a unit vector; its length is",
        ),
        (f"{DIRECTIONS}\n0,nan,1,0,0,1\n", [], "wi_y, line 2 = 'nan': expected a finite number"),
        (f"{DIRECTIONS}\n0,up,1,0,0,1\n", [], "wi_y, line 2 = 'up': expected a finite number"),
        (f"{DIRECTIONS}\n0,0,1,0,0\n", [], "line 2 = '5 cells': expected 6 cells"),
        (f"{DIRECTIONS},Y\n0,0,1,0,0,1,2\n", [], "header = 'Y': expected another name"),
        (
            f"{DIRECTIONS},wavelength_um\n0,0,1,0,0,1,550\n",
            [],
            "wavelength_um, line 2 = 550.0: expected 0.38 to 0.78 um",
        ),
        (
            f"{DIRECTIONS},wavelength_um\n0,0,1,0,0,1,0.5\n",
            ["--method", "closed-form"],
            "method = 'closed-form': expected reference, for a column wavelength_um",
        ),
        (
            "theta_i_deg,phi_i_deg,wavelength_um\n0,0,0.5\n",
            ["--orders", "--method", "wavelength-loop"],
            "method = 'wavelength-loop': expected reference, for order efficiencies",
        ),
        (
            "theta_i_deg,phi_i_deg,wavelength_um\n0,0,0.5\n90,0,0.5\n",
            ["--orders"],
            "theta_i_deg, line 3 = 90.0: expected 0 or more and less than 90",
        ),
        (
            "theta_i_deg,phi_i_deg,wavelength_um\n-5,0,0.5\n",
            ["--orders"],
            "theta_i_deg, line 2 = -5.0: expected 0 or more and less than 90",
        ),
        (
            "theta_i_deg,phi_i_deg,wavelength_um\n5,0,0.79\n",
            ["--orders"],
            "wavelength_um, line 2 = 0.79: expected 0.38 to 0.78 um",
        ),
        (f"{DIRECTIONS}\n0,0,1,0,0,1\n", ["--orders"], "theta_i_deg = "),
    ],
)
def test_bad_tables_end_with_one_line_and_nothing_written(
    tmp_path: Path, table: str, options: list[str], line: str
) -> None:
    output = tmp_path / "out.csv"
    result, _ = evaluate(tmp_path, MIRROR, table, *options, "-o", str(output))
    assert result.exit_code == 2
    assert result.stdout == ""
    assert result.stderr.startswith(f"{tmp_path / 'in.csv'}: {line}")
    assert result.stderr.count("\n") == 1
    assert sorted(f.name for f in tmp_path.iterdir()) == ["in.csv", "recipe.json"]


def test_missing_table_and_bad_recipe_end_with_one_line(tmp_path: Path) -> None:
    recipe = tmp_path / "recipe.json"
    recipe.write_text(json.dumps(MIRROR))
    result = run("evaluate", recipe, tmp_path / "none.csv")
    assert (result.exit_code, result.stderr.count("\n")) == (2, 1)
    assert "none.csv: contents" in result.stderr
    result, _ = evaluate(tmp_path, {**MIRROR, "height": 0.7}, f"{DIRECTIONS}\n{FIRST_ORDER}\n")
    assert result.exit_code == 0  # the reference takes any height
    result = run("evaluate", recipe, tmp_path / "in.csv", "--method", "closed-form")
    assert (result.exit_code, result.stderr.count("\n")) == (2, 1)
    assert "height = 0.7: expected at most 0.6" in result.stderr


def test_output_file_is_what_would_be_printed(tmp_path: Path) -> None:
    table = f"{DIRECTIONS},wavelength_um\n{FIRST_ORDER},0.5\n"
    printed, _ = evaluate(tmp_path, MIRROR, table)
    output = tmp_path / "new" / "out.csv"
    result, _ = evaluate(tmp_path, MIRROR, table, "-o", str(output))
    assert (result.exit_code, result.stdout) == (0, "")
    assert output.read_text() == printed.stdout
    assert [f.name for f in output.parent.iterdir()] == ["out.csv"]


def test_bake_writes_maps(tmp_path: Path) -> None:
    recipe = tmp_path / "metals.json"
    recipe.write_text('{"kind": "metals"}')
    result = run("bake", recipe, "-o", tmp_path / "maps")
    assert result.exit_code == 0
    assert sorted(f.name for f in (tmp_path / "maps").iterdir()) == [
        "metals.json",
        "metals.reflectance.bin",
    ]


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ('{"kind": "profile", "profile": "round"}', "profile.kind = 'round': expected one of"),
        ('{"kind": "foil", "design": "polygons", "height": 0}', "height = 0: expected greater"),
        ('{"kind": "grating", "period": 1, "height": 1}', "kind = 'grating': expected one of"),
        ("[1, 2", "contents = "),
    ],
)
def test_baking_a_bad_recipe_ends_with_one_line(tmp_path: Path, text: str, line: str) -> None:
    recipe = tmp_path / "bad.json"
    recipe.write_text(text)
    result = run("bake", recipe, "-o", tmp_path / "maps")
    assert result.exit_code == 2
    assert result.stderr.startswith(f"{recipe}: {line}")
    assert result.stderr.count("\n") == 1
    assert not (tmp_path / "maps").exists()


@pytest.mark.parametrize(
    ("recipe", "words", "pictures"),
    [
        (
            {"kind": "profile", "profile": "blazed", "samples": 32, "max_order": 4},
            ["diffraction efficiency", "order", "-4", "phase", "rad", "square", "float16"],
            ["name-efficiency.png"],
        ),
        (
            {"kind": "lobes", "wavenumbers": 12, "widths": 4},
            ["lobe width", "log", "mean wavenumber", "X of red", "margin"],
            ["name-lobe.png", "name-weights.png"],
        ),
        ({"kind": "metals", "wavenumbers": 16}, ["gold", "wavenumber"], ["name-reflectance.png"]),
        (
            {"kind": "foil", "design": "polygons", "size": 32},
            ["cos 2theta", "uint8", "tile_mm", "25, 25"],
            ["name-grating.png"],
        ),
    ],
    ids=lambda value: value["kind"] if isinstance(value, dict) else "",
)
def test_inspect_says_and_draws_what_is_in_a_map(
    tmp_path: Path, recipe: dict[str, object], words: list[str], pictures: list[str]
) -> None:
    (tmp_path / "name.json").write_text(json.dumps(recipe))
    bake(tmp_path / "name.json", tmp_path / "maps")
    result = run("inspect", tmp_path / "maps" / "name", "-o", tmp_path / "pictures")
    assert result.exit_code == 0
    for word in [*words, "checksums", "match", "relative_rms"]:
        assert word in result.stdout
    written = sorted((tmp_path / "pictures").iterdir())
    assert [f.name for f in written] == pictures
    for file in written:
        assert np.asarray(Image.open(file).convert("L")).std() > 5  # not blank


def test_inspecting_a_damaged_map_ends_with_one_line(tmp_path: Path) -> None:
    (tmp_path / "name.json").write_text('{"kind": "metals"}')
    binary, _ = bake(tmp_path / "name.json", tmp_path / "maps")
    binary.write_bytes(b"\0" * binary.stat().st_size)
    result = run("inspect", tmp_path / "maps" / "name")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "sha256 = " in result.stderr and result.stderr.count("\n") == 1
