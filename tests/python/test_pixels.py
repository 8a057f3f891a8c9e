"""What the browser draws against the reference, pixel by pixel, on float radiance.

One launch of Chromium on llvmpipe draws small versions of the scenes of tests/scenes.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from precompute.bake import bake
from precompute.errors import InputError
from precompute.renderings import Rendering, reference_xyz
from precompute.report import browser
from precompute.report.comparison import Comparison, compare
from precompute.report.furnace import PROFILES, furnace_description, measure_furnace
from precompute.report.scenes import METHOD_OPTIONS, Scene

ROOT = Path(__file__).resolve().parents[2]
MAPS = ROOT / "maps" / "baked"

CLOSED: dict[str, Any] = METHOD_OPTIONS["closed-form"]
LOOP: dict[str, Any] = METHOD_OPTIONS["wavelength-loop"]
NANOMETRES = LOOP | {"wavelengthStep": 0.001}
SERIES = {"method": "jacobi-anger", "wavelengthStep": 0.001}
ARC = LOOP | {"environmentNodes": 401}

# Scene, pixels, method, and the largest errors allowed: relative RMSE of XYZ radiance and 95th
# percentile of ΔE2000. The loop at 1 nm sums the reference's own wavelengths and the arc of 401
# nodes its own directions: what is left to them is tables of halves, and float32.
CASES: dict[str, tuple[str, tuple[int, int], dict[str, Any], float, float]] = {
    "rectangular, 0.6 µm": ("plane-sharp-rectangular", (192, 24), CLOSED, 0.01, 1),
    "rectangular, 0.6 µm, by 1 nm": ("plane-sharp-rectangular", (192, 24), NANOMETRES, 0.01, 0.2),
    "blazed, 3 µm": ("plane-sharp-blazed", (192, 24), CLOSED, 0.01, 1),
    "blazed, 50°": ("plane-sharp-blazed-steep", (192, 24), CLOSED, 0.01, 1),
    "blazed, 50°, by 1 nm": ("plane-sharp-blazed-steep", (192, 24), NANOMETRES, 0.01, 0.2),
    "triangular, sphere": ("sphere-sharp-triangular", (128, 128), CLOSED, 0.01, 1),
    "sampled, sphere": ("sphere-sharp-sampled", (64, 64), CLOSED, 0.01, 1),
    # At the sphere's edge the horizon cuts the lobes of all orders.
    "sampled, sphere, 3° rough": (
        "sphere-sharp-sampled",
        (24, 24),
        CLOSED | {"roughness": 0.05},
        0.005,
        1,
    ),
    "sinusoidal, Kirchhoff": ("plane-sharp-kirchhoff", (192, 24), CLOSED, 0.01, 1),
    "sinusoidal, gold, flash": ("plane-flash-gold", (96, 96), CLOSED, 0.01, 1),
    "sinusoidal, tinted flash": ("plane-flash-tinted", (96, 96), CLOSED, 0.01, 1),
    "foil, flash": ("foil-near", (96, 96), CLOSED, 0.01, 1),
    "disc, sun": ("disc-sun", (128, 128), CLOSED, 0.01, 1),
    "bumps, line by line": ("height-field-bumps", (96, 96), {"method": "line-sum"}, 0.01, 1),
    "bumps, Jacobi–Anger": ("height-field-bumps", (48, 48), SERIES, 0.005, 0.2),
    "bumps, Taylor": ("height-field-bumps", (48, 48), SERIES | {"method": "taylor"}, 0.005, 0.2),
    "bumps, baked": ("height-field-bumps-rough", (96, 96), {"method": "baked"}, 0.01, 1),
    "fingers, sun": ("height-field-fingers-sun", (64, 64), {"method": "line-sum"}, 0.01, 1),
    "bumps, 3 × 8 patches": ("height-field-bumps-repeats", (20, 20), SERIES, 0.01, 1),
    "cosine, 4 patches, sun": (
        "height-field-cosine-repeats-sun",
        (20, 20),
        SERIES | {"method": "taylor"},
        0.01,
        1.5,
    ),
    "blazed, line by line": ("height-field-blazed", (64, 12), {"method": "line-sum"}, 0.01, 1.5),
    "bumps, environment": ("height-field-bumps-studio", (24, 24), {}, 0.015, 5),
    "bumps, rough, environment": (
        "height-field-bumps-studio",
        (16, 16),
        {"roughness": 0.0175},
        0.015,
        6,
    ),
    # Thousands of lines in 192 lookups: the studio's strips cut their light into narrow stripes.
    "fingers, environment": ("height-field-fingers-studio", (10, 10), {}, 0.06, 8),
    "environment, 401 nodes": ("environment-studio", (16, 16), ARC, 0.0005, 0.1),
    "small lamps, 401 nodes": ("environment-warehouse", (16, 16), ARC, 0.0005, 0.1),
    "environment, 26 nodes": (
        "environment-studio",
        (16, 16),
        CLOSED | {"environmentNodes": 26},
        0.002,
        1,
    ),
    # A table over the view.
    "flat grating, 1°": ("flat-grating-rough", (12, 12), CLOSED, 0.005, 1),
    "flat grating, 1°, by nodes": (
        "flat-grating-rough",
        (12, 12),
        CLOSED | {"planarEnvironment": False},
        0.008,
        1,
    ),
    # Grazing views, where a round blur is least like that of tilts.
    "vase, 1°": ("vase-mixed", (15, 20), CLOSED, 0.025, 1.5),
    # Lamps about the environment's pole.
    "ceiling, 1°": ("ceiling-rough", (10, 10), CLOSED | {"environmentNodes": 24}, 0.07, 4),
}


# The mean of so many frames at rest of 12 nodes each.
FRAMES = (1, 4, 16)
REFINED: dict[str, tuple[str, tuple[int, int], dict[str, Any]]] = {
    "studio": ("environment-studio", (16, 16), CLOSED),
    "night": ("environment-night", (16, 16), CLOSED),
    "card, 1°": ("flat-grating-rough", (12, 12), CLOSED),
    # The papers' nodes are the same in each frame.
    "studio, all frames alike": ("environment-studio", (16, 16), LOOP | {"environmentNodes": 12}),
}


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where everything is drawn, in one launch."""
    if not (MAPS / "metals.json").is_file():
        for recipe in sorted((ROOT / "maps" / "recipes").glob("*.json")):
            bake(recipe, MAPS)
    descriptions = {}
    for name, (scene, size, method, _, _) in CASES.items():
        description = Scene.read(ROOT / "tests" / "scenes" / f"{scene}.json").description
        material = description.get("material", {}) | method
        descriptions[name] = description | {"size": size, "material": material}
    for name, (scene, size, method) in REFINED.items():
        description = Scene.read(ROOT / "tests" / "scenes" / f"{scene}.json").description
        for frames in FRAMES:
            # Pixels' centres stay where the reference has them.
            descriptions[f"{name}, {frames}"] = description | {
                "size": size,
                "material": description.get("material", {}) | method,
                "refinement": {"frames": frames, "antialias": False},
            }
    for profile in PROFILES:
        descriptions[f"furnace {profile}"] = furnace_description(profile, CLOSED)
    drawn = tmp_path_factory.mktemp("pixels")
    assert list(browser.render(descriptions, drawn)) == list(descriptions)
    return drawn


class References:
    """References by scene, size and roughness: those of methods that share them are made once."""

    def __init__(self) -> None:
        self._known: dict[tuple[Any, ...], np.ndarray] = {}

    def compare(self, rendering: Rendering, scene: str, size: tuple[int, int]) -> Comparison:
        key = (scene, size, rendering.material.get("roughness"))
        if key not in self._known:
            self._known[key] = reference_xyz(rendering, MAPS)
        return compare(rendering, self._known[key])


@pytest.fixture(scope="session")
def references() -> References:
    return References()


def compared(rendering: Rendering) -> Comparison:
    return compare(rendering, reference_xyz(rendering, MAPS))


@pytest.mark.parametrize("case", CASES)
def test_pixels_are_the_references(folder: Path, references: References, case: str) -> None:
    scene, size, _, rmse, delta_e = CASES[case]
    comparison = references.compare(Rendering.read(folder, case), scene, size)
    assert comparison.lit > 50
    assert comparison.rel_rmse <= rmse
    assert comparison.delta_e2000_p95 <= delta_e


@pytest.fixture(scope="session")
def refined(folder: Path, references: References) -> dict[str, list[float]]:
    """Relative RMSE of the means of each of FRAMES."""
    errors: dict[str, list[float]] = {}
    for name, (scene, size, _) in REFINED.items():
        renderings = [Rendering.read(folder, f"{name}, {frames}") for frames in FRAMES]
        compared = [references.compare(drawn, scene, size) for drawn in renderings]
        errors[name] = [comparison.rel_rmse for comparison in compared]
    return errors


@pytest.mark.parametrize("name", ["studio", "night"])
def test_a_picture_at_rest_goes_to_the_reference(
    refined: dict[str, list[float]], name: str
) -> None:
    one, four, sixteen = refined[name]
    # Four times the nodes have 1/16 of an error that falls as n⁻²; the frames' own white is left.
    assert four <= one / 8
    assert sixteen <= min(one / 10, 0.0005)


def test_a_rough_surface_gains_little_at_rest(refined: dict[str, list[float]]) -> None:
    # Its blur errs more than its nodes.
    one, four, sixteen = refined["card, 1°"]
    assert max(four, sixteen) <= one <= 0.006


def test_frames_that_are_all_alike_gain_nothing(refined: dict[str, list[float]]) -> None:
    one, four, sixteen = refined["studio, all frames alike"]
    assert one > 0.005
    assert [four, sixteen] == pytest.approx([one, one], rel=1e-3)


def longer_period(rendering: Rendering) -> None:
    rendering.layers["tangent"][..., 3] /= 1.01


def mirrored(rendering: Rendering) -> None:
    rendering.layers["grating"] *= -1


def aluminium(rendering: Rendering) -> None:
    del rendering.scene["material"]["metal"]


def higher(rendering: Rendering) -> None:
    rendering.scene["surface"]["height"] *= 1.03


def white(rendering: Rendering) -> None:
    grey = float(np.mean(rendering.view["lights"][0]["color"]))
    rendering.view["lights"][0]["color"] = [grey] * 3


def smooth(rendering: Rendering) -> None:
    rendering.scene["material"]["roughness"] *= 0.9


PLANTED: list[tuple[str, Callable[[Rendering], None]]] = [
    ("rectangular, 0.6 µm, by 1 nm", longer_period),
    ("blazed, 50°", mirrored),
    ("blazed, 3 µm", mirrored),
    ("sinusoidal, gold, flash", aluminium),
    ("sinusoidal, Kirchhoff", higher),
    ("sinusoidal, tinted flash", white),
    ("disc, sun", smooth),
]


@pytest.mark.parametrize(("case", "mistake"), PLANTED, ids=lambda p: getattr(p, "__name__", p))
def test_a_planted_mistake_is_seen(
    folder: Path, case: str, mistake: Callable[[Rendering], None]
) -> None:
    rendering = Rendering.read(folder, case)
    mistake(rendering)
    try:
        comparison = compared(rendering)
    except InputError as error:
        # Light thrown to the other side leaves nothing here.
        assert error.field == "reference"
        return
    assert comparison.rel_rmse > CASES[case][3]


@pytest.mark.parametrize("profile", PROFILES)
def test_white_furnace_returns_the_metal(folder: Path, profile: str) -> None:
    furnace = measure_furnace(Rendering.read(folder, f"furnace {profile}"))
    assert furnace.samples > 10_000
    assert furnace.non_finite == 0
    assert furnace.largest <= 1 + 1e-3
    # Where next to all light falls on orders that do not propagate, the shader stops normalising.
    assert furnace.smallest >= 1 - 1e-2


def test_a_scene_that_does_not_render_is_an_error(tmp_path: Path) -> None:
    description = furnace_description("no-such-profile", CLOSED)
    with pytest.raises(browser.BrowserError, match="profile-no-such-profile"):
        list(browser.render({"broken": description}, tmp_path))
