"""A map of relative orientations and periods, made absolute by one flash photograph."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from refusals import refused
from typer.testing import CliRunner, Result

from precompute.acquisition.capture import read_capture
from precompute.acquisition.fusion import Fusion, fused
from precompute.acquisition.layout import tiling_of
from precompute.acquisition.observations import Shot, texel_places
from precompute.acquisition.pattern import Gratings, gratings_of
from precompute.acquisition.shots import read_shots
from precompute.acquisition.simulate import simulate_flash
from precompute.acquisition.tiling import Tiling
from precompute.cli import app
from precompute.foils.foil_map import foil_map
from precompute.maps import Map

TEXELS = 64
ROUGHNESS = np.radians(0.2)
FOIL: dict[str, Any] = {
    "kind": "foil",
    "design": "polygons",
    "size": TEXELS,
    "tile_mm": 15,
    "polygons": 16,
    "orientations": 16,
    "period_range": [1.2, 2.0],
}
RECIPE: dict[str, Any] = {
    "kind": "flash-capture",
    "foil": "foil.json",
    "surface": {"size_mm": [90, 75], "roughness_deg": 0.2},
    "camera": {"position_mm": [0, 0, 300], "focal_px": 900, "black": 256},
    "size_px": [283, 236],
    "photographs": [{"light": {"position_mm": [-45, 20, 150]}, "exposures_s": [0.002, 0.06]}],
    "sensor": {"file": "tif", "bits": 16, "full_well": 30000, "read_noise": 4},
    "step_nm": 20,
    "subpixels": 1,
}
Scene = tuple[Shot, Tiling, Gratings]


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A capture of one photograph, the truth beside it."""
    folder = tmp_path_factory.mktemp("fusion")
    (folder / "foil.json").write_text(json.dumps(FOIL))
    (folder / "bench.json").write_text(json.dumps(RECIPE))
    return simulate_flash(folder / "bench.json", folder)


@pytest.fixture(scope="module")
def scene(file: Path) -> Scene:
    """The photograph, where its tiles are, and the truth."""
    capture = read_capture(file, "flash")
    taken = read_shots(capture, file.parent, lambda _: None, lambda error: error)
    tiling, _ = tiling_of(capture, taken, str(file), lambda _: None)
    return taken.shots[0], tiling, gratings_of(Map.read(file.parent / "truth" / "foil"))


def polarisation_map(truth: Gratings, offset: float, scale: float, noise: float) -> Any:
    """θ and a without their offset, degrees, and scale, µm; noise in degrees, and % of periods."""
    rng = np.random.default_rng(3)
    errors = rng.standard_normal((2, *truth.orientation.shape))
    θ = truth.orientation - np.radians(offset - noise * errors[0])
    a = np.divide(1, truth.frequency * scale) * (1 + noise / 100 * errors[1])
    bare = truth.strength == 0
    return np.where(bare, np.nan, θ).ravel(), np.where(bare, np.nan, a).ravel()


def fuse(scene: Scene, θ: np.ndarray, a: np.ndarray) -> Fusion:
    shot, tiling, _ = scene
    return fused(θ, a, texel_places((TEXELS, TEXELS)), shot, tiling, 0.15, ROUGHNESS)


@pytest.mark.parametrize(
    ("offset", "scale", "noise"), [(0.0, 1.0, 0.0), (37.3, 2.0, 2.0), (120.0, 0.013, 2.0)]
)
def test_one_photograph_makes_a_map_absolute(
    scene: Scene, offset: float, scale: float, noise: float
) -> None:
    found = fuse(scene, *polarisation_map(scene[2], offset, scale, noise))
    off = (np.degrees(found.offset) - offset + 90) % 180 - 90
    assert abs(off) < 1
    assert found.scale == pytest.approx(scale, rel=0.02)
    assert found.correlation > 0.5
    assert found.elsewhere < 0.7


def test_a_map_of_another_foil_does_not_correlate(scene: Scene) -> None:
    """Mirrored, so that its orientations turn the other way."""
    θ, a = polarisation_map(scene[2], 0, 1, 0)
    mirrored = fuse(scene, -θ, a)
    assert mirrored.correlation < 0.6 * fuse(scene, θ, a).correlation


def test_one_period_for_all_is_found_too(scene: Scene) -> None:
    """Its scale is then about the mean of the periods, which light lobes at 1.2 to 2 µm."""
    θ, _ = polarisation_map(scene[2], 37.3, 1, 0)
    found = fuse(scene, θ, np.ones(1))
    assert np.degrees(found.offset) == pytest.approx(37.3, abs=1)
    assert 1.2 < found.scale < 2.0


def test_what_cannot_be_fused_is_refused(scene: Scene) -> None:
    θ, a = polarisation_map(scene[2], 0, 1, 0)
    with refused("fusion", "orientation", "no texel is known", "one, or more"):
        fuse(scene, θ * np.nan, a)
    with refused("fusion", "period", 0.0, "above 0"):
        fuse(scene, θ, a * 0)
    with pytest.raises(ValueError, match="longest over shortest"):
        fuse(scene, θ, np.where(np.arange(a.size) % 2, a, 100 * a))
    shot, tiling, truth = scene
    black = replace(shot, values=np.zeros_like(shot.values))
    dark = "nothing but one brightness beyond the highlight"
    with refused("fusion", shot.name, dark, "lit and dark"):
        fuse((black, tiling, truth), θ, a)


# ---- The command ---------------------------------------------------------------------------------


def command(folder: Path, file: Path, θ: np.ndarray, truth: Gratings, scale: float) -> Result:
    """Fuse a map of given orientations, its periods `scale` times too short."""
    foil = foil_map(
        θ,
        truth.frequency * scale,
        truth.strength,
        height=0.15,
        tile_mm=(15.0, 15.0),
        recipe={"kind": "foil", "design": "acquired"},
    )
    foil.write(folder, "relative")
    arguments = ["acquire", "fuse", folder / "relative.json", file, "-o", folder / "fused"]
    return CliRunner().invoke(app, [str(a) for a in arguments], catch_exceptions=False)


def test_the_command_makes_a_map_absolute(scene: Scene, file: Path, tmp_path: Path) -> None:
    _, _, truth = scene
    result = command(tmp_path, file, truth.orientation - np.radians(37.3), truth, 1.25)
    assert result.exit_code == 0
    made = Map.read(tmp_path / "fused.json")
    gratings, lit = gratings_of(made), truth.strength > 0
    off = np.mod(gratings.orientation - truth.orientation + np.pi / 2, np.pi) - np.pi / 2
    assert np.degrees(np.abs(off[lit])).max() < 1  # 0.2 of the offset, the rest of 8 bits
    assert np.allclose(gratings.frequency[lit] / truth.frequency[lit], 1, atol=0.02)
    assert made.recipe["fused"]["offset_deg"] == pytest.approx(37.3, abs=0.5)
    assert made.recipe["fused"]["periods_times"] == pytest.approx(1.25, rel=0.01)


def test_another_foil_is_refused(scene: Scene, file: Path, tmp_path: Path) -> None:
    _, _, truth = scene
    result = command(tmp_path, file, -truth.orientation, truth, 1.0)
    assert result.exit_code == 2 and not (tmp_path / "fused.json").exists()
    assert "of the same foil" in result.stderr.splitlines()[-1]
