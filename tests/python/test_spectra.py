"""Observers, illuminants and metals against published numbers; illuminants from CSV files."""

from pathlib import Path
from typing import Any, cast

import colour
import numpy as np
import pytest
from refusals import refused

from precompute.spectra import (
    WAVELENGTHS,
    Metal,
    colour_matching_functions,
    illuminant,
    metal_reflectance,
    tint_basis,
    white_xyz,
    xyz_to_linear_srgb,
)

OBSERVER = "CIE 1931 2 Degree Standard Observer"

# Evaporated mirrors, after G. Hass in the American Institute of Physics Handbook (1972): at a
# wavelength in µm, R. Samples of one metal differ by some hundredths, copper's more.
MIRRORS = [
    ("aluminium", 0.45, 0.922, 0.02),
    ("aluminium", 0.55, 0.915, 0.02),
    ("aluminium", 0.70, 0.897, 0.02),
    ("silver", 0.45, 0.966, 0.03),
    ("silver", 0.65, 0.988, 0.02),
    ("gold", 0.45, 0.387, 0.04),
    ("gold", 0.55, 0.817, 0.05),
    ("gold", 0.65, 0.955, 0.03),
    ("copper", 0.45, 0.552, 0.06),
    ("copper", 0.70, 0.975, 0.03),
]


@pytest.mark.parametrize("name", ["D65", "A", "LED-B1", "LED-B3", "LED-B5"])
def test_white_points_are_the_published_chromaticities(name: str) -> None:
    x, y, z = white_xyz("1931-2", name)
    published = colour.CCS_ILLUMINANTS[OBSERVER][name]
    assert y == pytest.approx(1)
    # Tables of chromaticity are rounded to 1e-4; straight lines between the LEDs' spectra every
    # 5 nm, about a narrow blue peak, add twice that.
    assert [x / (x + y + z), y / (x + y + z)] == pytest.approx(published, abs=3e-4)


def test_d65_and_a_as_the_standard_prints_them() -> None:
    """Written out: were `ILLUMINANTS` mixed up, the test above would compare A with A's own."""
    for name, expected in (("D65", (0.3127, 0.3290)), ("A", (0.4476, 0.4074))):
        xyz = white_xyz("1931-2", name)
        assert xyz[:2] / xyz.sum() == pytest.approx(expected, abs=2e-4)


def test_inverse_a_is_the_reciprocal_of_a() -> None:
    product = illuminant("A") * illuminant("inverse-A")
    assert product == pytest.approx(np.full(401, product[0]))
    assert illuminant("inverse-A").max() == 1


@pytest.mark.parametrize("name", ["D65", "A", "inverse-A", "LED-B3"])
def test_a_mirror_is_white_under_every_light(name: str) -> None:
    white = xyz_to_linear_srgb("1931-2", name) @ white_xyz("1931-2", name)
    assert white == pytest.approx([1, 1, 1])


def test_under_d65_the_matrix_is_that_of_srgb() -> None:
    """IEC 61966-2-1 prints 3.2406 −1.5372 −0.4986: a swapped adaptation would not show at white."""
    expected = [3.2406, -1.5372, -0.4986, -0.9689, 1.8758, 0.0415, 0.0557, -0.2040, 1.0570]
    assert xyz_to_linear_srgb("1931-2", "D65").ravel() == pytest.approx(expected, abs=1e-3)


def test_tints_are_the_primaries_of_srgb_under_d65() -> None:
    weights = illuminant("D65")[:, None] * colour_matching_functions()
    xyz = weights.T @ tint_basis() / weights[:, 1].sum()
    rgb = xyz_to_linear_srgb("1931-2", "D65") @ xyz
    assert rgb == pytest.approx(np.eye(3), abs=5e-3)


@pytest.mark.parametrize(("metal", "wavelength", "expected", "margin"), MIRRORS)
def test_metals_reflect_as_mirrors_were_measured_to(
    metal: Metal, wavelength: float, expected: float, margin: float
) -> None:
    assert metal_reflectance(metal, wavelength) == pytest.approx(expected, abs=margin)


@pytest.mark.parametrize(("column", "scale"), [("wavelength_um", 1.0), ("wavelength_nm", 1000.0)])
def test_illuminant_from_csv(tmp_path: Path, column: str, scale: float) -> None:
    file = tmp_path / "lamp.csv"
    rows = [f"{λ * scale},{power},x" for λ, power in [(0.45, 2), (0.55, 4), (0.65, 1)]]
    # As spreadsheets and people write them: a byte-order mark, a comment, an empty line.
    file.write_text("\n".join([f"{column},power,note", "# a lamp", "", *rows]), "utf-8-sig")
    light = dict(zip(WAVELENGTHS.tolist(), illuminant(file), strict=True))
    found = [light[λ] for λ in (0.44, 0.45, 0.5, 0.55, 0.6, 0.65, 0.66)]
    assert found == pytest.approx([0, 0.5, 0.75, 1, 0.625, 0.25, 0])


@pytest.mark.parametrize(
    ("text", "field", "value", "expected"),
    [
        ("", "header", "an empty file", "column names"),
        ("wavelength_um,watts\n0.4,1", "header", "wavelength_um,watts", "wavelength_um"),
        ("nm,power\n400,1\n700,1", "header", "nm,power", "wavelength_nm"),
        ("wavelength_um,power", "rows", "none below the header", "one or more rows"),
        ("wavelength_um,power\n0.5,1", "wavelength_um", [0.5], "two or more rising"),
        ("wavelength_um,power\n0.6,1\n0.5,1", "wavelength_um", [0.6, 0.5], "rising"),
        ("wavelength_um,power\n0.5,1\n0.6,nan", "power, line 3", "nan", "a finite number"),
        ("wavelength_um,power\n0.5,1\n0.6,inf", "power, line 3", "inf", "a finite number"),
        ("wavelength_um,power\n0.5,one\n0.6,1", "power, line 2", "one", "a finite number"),
        ("wavelength_um,power\n0.5,1\n0.6,-2", "power", [-2.0], "no negative"),
        ("wavelength_um,power\n0.5,1\n0.6", "line 3", "1 cells", "2 cells"),
        ("wavelength_um,power\n1,1\n2,1", "power", "no light between 0.38 and 0.78 um", "visible"),
        ("wavelength_um,power\n400,1\n700,1", "power", "no light between 0.38 and 0.78 um", "vis"),
    ],
)
def test_bad_illuminant_csv_is_refused(
    tmp_path: Path, text: str, field: str, value: object, expected: str
) -> None:
    file = tmp_path / "lamp.csv"
    file.write_text(text)
    with refused(file, field, value, expected):
        illuminant(file)


def test_missing_illuminant_csv_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "lamp.csv"
    problem = f"[Errno 2] No such file or directory: '{file}'"
    with refused(file, "contents", problem, "a readable file"):
        illuminant(file)


def test_unknown_names_are_refused() -> None:
    unknown = cast(Any, "unobtainium")
    with refused("spectrum", "illuminant", "unobtainium", "D65, A, inverse-A, LED-B1"):
        illuminant(unknown)
    with refused("spectrum", "metal", "unobtainium", "aluminium, silver, gold, copper"):
        metal_reflectance(unknown)
    with refused("spectrum", "observer", "unobtainium", "1931-2, 2015-2"):
        colour_matching_functions(unknown)
