"""A minified foil against the mean over many subpixels that show the nearest texel each."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from precompute.bake import bake
from precompute.foils.polygons import polygons_foil
from precompute.foils.recipe import PolygonsFoilRecipe
from precompute.maps import Map
from precompute.report import browser
from precompute.report.minification import (
    FOILS,
    SCENE,
    Distance,
    minified,
    pictures,
    read_picture,
    seen_from_afar,
    with_surface,
)
from precompute.report.scenes import Scene

ROOT = Path(__file__).resolve().parents[2]
FEW, MANY = FOILS
DISTANCES = (Distance(FEW, 4, 16), Distance(FEW, 8, 16))
MANY_DISTANCES = (Distance(MANY, 4, 16), Distance(MANY, 16, 16))
TURNED = "turned by 2°"
WAVES = "waves"
SURROUNDED = "surrounded "
WAVES_DISTANCES = (Distance(WAVES, 4, 8), Distance(WAVES, 16, 16))


class _Files(SimpleHTTPRequestHandler):
    """Files for a page of another port."""

    def end_headers(self) -> None:
        self.send_header("Access-Control-Allow-Origin", "*")
        super().end_headers()

    def log_message(self, format: str, *args: object) -> None:
        pass


@contextmanager
def served(folder: Path) -> Iterator[str]:
    """The address of a folder's files."""
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(_Files, directory=str(folder)))
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_port}"
    finally:
        server.shutdown()
        server.server_close()


def waves() -> Map:
    """A foil whose orientation and period change evenly from place to place."""
    foil = polygons_foil(PolygonsFoilRecipe(kind="foil", design="polygons", size=256))
    table = foil.tables["grating"]
    texel = (np.arange(256) + 0.5) / 256
    x, y = np.meshgrid(texel, texel)
    θ = np.pi * (x + 0.3 * np.sin(2 * np.pi * y))
    frequency = (1 + 0.02 * np.sin(2 * np.pi * (x + y))) / 1.66
    top = float(frequency.max())
    channels = np.cos(2 * θ), np.sin(2 * θ), frequency, np.ones_like(x)
    table.values = np.stack(channels, axis=-1)
    table.decode = ((-1.0, 2.0), (-1.0, 2.0), (0.0, top), (0.0, 1.0))
    foil.constants |= {"min_frequency": float(frequency.min()), "max_frequency": top}
    return foil


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """All pictures, in one launch of Chromium."""
    maps = ROOT / "maps"
    if not (maps / "baked" / "metals.json").is_file():
        for recipe in sorted((maps / "recipes").glob("*.json")):
            bake(recipe, maps / "baked")
    scene = Scene.read(ROOT / "tests" / "scenes" / f"{SCENE}.json").description
    foil = scene["surface"] | {"filtered": True}
    scene |= {"surface": foil}
    x, y, z = scene["mesh"]["rotation_deg"]
    turned = scene | {"mesh": scene["mesh"] | {"rotation_deg": [x, y, z + 2]}}
    scenes: dict[str, dict[str, Any]] = dict(pictures(scene, DISTANCES + MANY_DISTANCES))
    for distance in DISTANCES:
        for name in [name for name in scenes if name.startswith(distance.name("filtered")[:-1])]:
            moved = scenes[name]
            scenes[name.replace("filtered", TURNED)] = moved | {"mesh": turned["mesh"]}
    for name in FOILS:
        covered = with_surface(scene, {"map": f"/maps/baked/{name}"})
        scenes[f"{name} magnified"] = seen_from_afar(covered, 0.4)
        nearest = with_surface(covered, {"filtered": False})
        scenes[f"{name} magnified nearest"] = seen_from_afar(nearest, 0.4)
    folder = tmp_path_factory.mktemp("foil")
    waves().write(folder, WAVES)
    with served(folder) as address:
        for name, picture in pictures(scene, WAVES_DISTANCES):
            scenes[name] = with_surface(picture, {"map": f"{address}/{WAVES}"})
            around = {"lights": [], "environment": {"asset": "studio"}}
            scenes[f"{SURROUNDED}{name}"] = scenes[name] | around
        assert list(browser.render(scenes, folder)) == list(scenes)
    return folder


@pytest.mark.parametrize("distance", DISTANCES, ids=lambda d: f"{d.texels} texels")
def test_a_pixel_shows_the_mean_of_its_texels(drawn: Path, distance: Distance) -> None:
    filtered = minified(drawn, distance, "filtered")
    assert filtered.mean_error <= 0.05
    assert filtered.brightness == pytest.approx(1, abs=0.01)
    # What the measure is worth: one texel for all of them, and a foil turned by 2° in its plane.
    assert minified(drawn, distance, "nearest texel").mean_error > 0.1
    assert minified(drawn, distance, TURNED).mean_error > 0.1


def test_it_flickers_no_more_than_its_mean(drawn: Path) -> None:
    distance = DISTANCES[-1]
    assert minified(drawn, distance, "filtered").flicker <= 1.02
    assert minified(drawn, distance, "nearest texel").flicker > 1.1


@pytest.mark.parametrize("distance", MANY_DISTANCES, ids=lambda d: f"{d.texels} texels")
def test_a_pixel_shows_the_mean_of_many_gratings(drawn: Path, distance: Distance) -> None:
    """180 of them: few texels are read one by one, many in clusters of what is alike."""
    filtered = minified(drawn, distance, "filtered")
    assert filtered.mean_error <= 0.09
    assert filtered.brightness == pytest.approx(1, abs=0.015)
    assert filtered.flicker <= 1.02
    assert minified(drawn, distance, "nearest texel").mean_error > 0.7


@pytest.mark.parametrize("distance", WAVES_DISTANCES, ids=lambda d: f"{d.texels} texels")
def test_a_pixel_shows_the_mean_where_gratings_turn_evenly(drawn: Path, distance: Distance) -> None:
    """What is shown as one grating has to be as wide as what it stands for: else it is 0.06 off."""
    filtered = minified(drawn, distance, "filtered")
    assert filtered.mean_error <= 0.05
    assert filtered.brightness == pytest.approx(1, abs=0.015)
    assert filtered.flicker <= 1.03
    assert minified(drawn, distance, "nearest texel").mean_error > 0.1


def test_it_does_so_in_an_environment(drawn: Path) -> None:
    """Clusters that were not as wide as their gratings would flicker by 1.056."""
    distance = WAVES_DISTANCES[-1]
    surrounded = Distance(f"{SURROUNDED}{distance.foil}", distance.texels, distance.subpixels)
    filtered = minified(drawn, surrounded, "filtered")
    assert filtered.mean_error <= 0.05
    assert filtered.brightness == pytest.approx(1, abs=0.01)
    assert filtered.flicker <= 1.04
    assert minified(drawn, surrounded, "nearest texel").mean_error > 0.07


@pytest.mark.parametrize("foil", FOILS)
def test_a_magnified_foil_shows_its_texels(drawn: Path, foil: str) -> None:
    """Every grating that a pixel can show is the texel's own; eight bits bend its angle no more."""
    shown, covered = read_picture(drawn, f"{foil} magnified")
    texels, _ = read_picture(drawn, f"{foil} magnified nearest")
    peak = texels[covered].max()
    assert np.abs(shown - texels)[covered].max() <= 1e-4 * peak
