"""A minified foil against the mean over many subpixels of the foil as its nearest texels show it.

The light and the camera are so far away that directions hardly change within a pixel: what a
pixel's texels differ in is the map alone.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from precompute.bake import bake
from precompute.renderings import Rendering
from precompute.report import browser

ROOT = Path(__file__).resolve().parents[2]
SCENE = ROOT / "tests" / "scenes" / "foil-far.json"
FAR = 8
"""How much further away light and camera are than in the scene's file."""
PIXELS = 32
SUBPIXELS = 16
"""Along each axis: a quarter of a texel at 4 times, half a texel at 8 times."""
MAP_TEXELS = 256
MINIFIED = (4, 8)
"""Texels to a pixel. Polygons are 37 texels wide: a pixel of 8 holds up to three of them."""
SHIFTS = (0.0, 0.25, 0.5, 0.75)
"""Where the camera moves to, in pixels."""

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


def scene(
    texels: float, *, subpixels: int = 1, shift: float = 0.0, **surface: Any
) -> dict[str, Any]:
    """A foil that shows so many texels to a pixel, seen from where the camera has moved."""
    description = json.loads(SCENE.read_text("utf-8"))
    half_angle = np.deg2rad(description["camera"]["fov_deg"] / 2)
    distance = description["camera"]["position"][2]
    pixel = 2 * distance * np.tan(half_angle) / PIXELS  # in units of the scene
    width = description["mesh"]["size"][0]
    repeat = texels * width / pixel / MAP_TEXELS
    x, y = shift * pixel, 0.4 * shift * pixel
    light = description["lights"][0]
    return description | {
        "size": [subpixels * PIXELS] * 2,
        "camera": {
            "position": [x, y, FAR * distance],
            "target": [x, y, 0],
            "fov_deg": float(2 * np.rad2deg(np.arctan(np.tan(half_angle) / FAR))),
        },
        "surface": description["surface"] | {"repeat": [repeat] * 2} | surface,
        "lights": [
            light
            | {
                "position": [FAR * c for c in light["position"]],
                "intensity": FAR**2 * light["intensity"],
            }
        ],
    }


def block_means(values: Array, block: int) -> Array:
    """Means over block × block pixels; values: shape (height, width, …)."""
    height, width = (size // block for size in values.shape[:2])
    blocks = values.reshape(height, block, width, block, *values.shape[2:])
    return blocks.mean(axis=(1, 3))


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """All pictures, in one launch of Chromium."""
    maps = ROOT / "maps"
    if not (maps / "baked" / "metals.json").is_file():
        for recipe in sorted((maps / "recipes").glob("*.json")):
            bake(recipe, maps / "baked")
    scenes = {}
    for texels in MINIFIED:
        for shift in SHIFTS if texels == MINIFIED[-1] else SHIFTS[:1]:
            at = f"{texels} {shift}"
            scenes[f"mean {at}"] = scene(texels, shift=shift, subpixels=SUBPIXELS, filtered=False)
            scenes[f"filtered {at}"] = scene(texels, shift=shift, filtered=True)
            scenes[f"nearest {at}"] = scene(texels, shift=shift, filtered=False)
        scenes[f"turned {texels} 0.0"] = scene(texels, filtered=True) | {
            "mesh": json.loads(SCENE.read_text("utf-8"))["mesh"] | {"rotation_deg": [-20, 15, 2]}
        }
    scenes["magnified"] = scene(0.4, filtered=True)
    scenes["magnified nearest"] = scene(0.4, filtered=False)
    folder = tmp_path_factory.mktemp("foil")
    assert list(browser.render(scenes, folder)) == list(scenes)
    return folder


def picture(folder: Path, name: str) -> tuple[Array, Mask]:
    """Radiance, and which pixels the foil covers wholly."""
    rendering = Rendering.read(folder, name)
    block = SUBPIXELS if name.startswith("mean") else 1
    covered = block_means(rendering.covered.astype(np.float64), block)
    return block_means(rendering.radiance, block), covered == 1


def error(folder: Path, what: str, at: str) -> float:
    """Mean absolute difference from the reference over its mean radiance."""
    (mean, whole), (shown, covered) = picture(folder, f"mean {at}"), picture(folder, f"{what} {at}")
    inside = whole & covered
    assert inside.sum() > 400
    return float(np.abs(shown - mean)[inside].mean() / mean[inside].mean())


@pytest.mark.parametrize("texels", MINIFIED)
def test_a_pixel_shows_the_mean_of_its_texels(drawn: Path, texels: int) -> None:
    at = f"{texels} 0.0"
    assert error(drawn, "filtered", at) <= 0.05
    # What the measure is worth: one texel for all of them, and a foil turned by 2° in its plane.
    assert error(drawn, "nearest", at) > 0.1
    assert error(drawn, "turned", at) > 0.1


def test_the_picture_is_as_bright_as_its_texels(drawn: Path) -> None:
    for texels in MINIFIED:
        mean, whole = picture(drawn, f"mean {texels} 0.0")
        shown, covered = picture(drawn, f"filtered {texels} 0.0")
        inside = whole & covered
        assert shown[inside].mean() == pytest.approx(mean[inside].mean(), rel=0.01)


def test_it_flickers_no_more_than_its_mean(drawn: Path) -> None:
    def deviation(what: str) -> float:
        pictures = [picture(drawn, f"{what} {MINIFIED[-1]} {shift}") for shift in SHIFTS]
        inside = np.all([covered for _, covered in pictures], axis=0)
        return float(np.std([radiance[inside] for radiance, _ in pictures], axis=0).mean())

    assert deviation("filtered") <= 1.02 * deviation("mean")
    assert deviation("nearest") > 1.1 * deviation("mean")


def test_a_magnified_foil_shows_its_texels(drawn: Path) -> None:
    """Every grating that a pixel can show is the texel's own; eight bits bend its angle no more."""
    shown, covered = picture(drawn, "magnified")
    texels, _ = picture(drawn, "magnified nearest")
    peak = texels[covered].max()
    assert np.abs(shown - texels)[covered].max() <= 1e-4 * peak
