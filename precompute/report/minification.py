"""A foil seen from afar: a pixel's colour against the mean over many subpixels.

Light and camera are so far away that directions hardly change within a pixel: what a pixel's
texels differ in is the map alone. The subpixels show the nearest texel each, drawn by the closed
form, which is compared with the reference elsewhere.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from precompute.renderings import Rendering
from precompute.report.rows import MinifiedFoil

SCENE = "foil-far"
"""The scene that is seen from further away."""
FOILS = ("foil-polygons", "foil-glitter")
"""Maps that it shows: of few gratings, each of which has its share, and of many."""

FAR = 8
"""How much further away light and camera are than in the scene given."""
PIXELS = 32
"""Along each side of the picture."""
MAP_TEXELS = 256
"""Along each side of the foil's map."""
SHOWN: dict[str, dict[str, Any]] = {"filtered": {}, "nearest texel": {"filtered": False}}
"""Options of the foil, by what its pixels then show."""
SHIFTS = (0.0, 0.25, 0.5, 0.75)
"""Where the camera moves to, in pixels."""
MEAN = "mean of subpixels"

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Distance:
    """From where a foil is seen.

    Attributes:
        foil: Name of its map.
        texels: Of the map to a pixel, along each axis.
        subpixels: Of the mean, along each axis.
    """

    foil: str
    texels: float
    subpixels: int

    def name(self, shown: str, shift: float = 0.0) -> str:
        """Name of a picture's files."""
        return f"{self.foil}, {shown}, {self.texels:g} texels to a pixel, moved by {shift:g}"


def seen_from_afar(
    scene: dict[str, Any], texels: float, *, subpixels: int = 1, shift: float = 0.0
) -> dict[str, Any]:
    """A scene's description with so many texels to a pixel, the camera moved by `shift` pixels.

    Args:
        scene: With a plane that shows a foil, and one point light.
        texels: Of the map to a pixel.
        subpixels: That a pixel is drawn as, along each axis.
        shift: Of the camera along x; along y it is 0.4 of that.
    """
    half_angle = np.deg2rad(scene["camera"]["fov_deg"] / 2)
    distance = scene["camera"]["position"][2]
    pixel = 2 * distance * np.tan(half_angle) / PIXELS  # in units of the scene
    repeat = texels * scene["mesh"]["size"][0] / pixel / MAP_TEXELS
    x, y = shift * pixel, 0.4 * shift * pixel
    light = scene["lights"][0]
    return scene | {
        "size": [subpixels * PIXELS] * 2,
        "camera": {
            "position": [x, y, FAR * distance],
            "target": [x, y, 0],
            "fov_deg": float(2 * np.rad2deg(np.arctan(np.tan(half_angle) / FAR))),
        },
        "surface": scene["surface"] | {"repeat": [repeat] * 2},
        "lights": [
            light
            | {
                "position": [FAR * c for c in light["position"]],
                "intensity": FAR**2 * light["intensity"],
            }
        ],
    }


DISTANCES = tuple(
    Distance(foil, texels, subpixels)
    for foil in FOILS
    for texels, subpixels in ((2, 8), (4, 16), (8, 16), (16, 32), (32, 32), (64, 32))
)
"""To 64 texels a pixel; there every second texel is in the mean, of patches 37 or 5 wide."""


def pictures(
    scene: dict[str, Any], distances: Iterable[Distance]
) -> Iterator[tuple[str, dict[str, Any]]]:
    """What the browser has to draw: each distance in each place, as it is shown and as the mean.

    Args:
        scene: See `seen_from_afar`; its foil with the default options.
        distances: From where, and of which foil.
    """
    for distance in distances:
        covered = with_surface(scene, {"map": f"/maps/baked/{distance.foil}"})
        nearest = with_surface(covered, SHOWN["nearest texel"])
        for shift in SHIFTS:
            texels, subpixels = distance.texels, distance.subpixels
            mean = seen_from_afar(nearest, texels, subpixels=subpixels, shift=shift)
            yield distance.name(MEAN, shift), mean
            for shown, surface in SHOWN.items():
                drawn = seen_from_afar(with_surface(covered, surface), texels, shift=shift)
                yield distance.name(shown, shift), drawn


def with_surface(scene: dict[str, Any], options: dict[str, Any]) -> dict[str, Any]:
    """The scene with options of its surface."""
    return scene | {"surface": scene["surface"] | options}


def read_picture(folder: Path, name: str, subpixels: int = 1) -> tuple[Array, Mask]:
    """Linear sRGB radiance (height, width, 3) by pixel, and which of them are wholly the foil's."""
    rendering = Rendering.read(folder, name)
    covered = _block_means(rendering.covered.astype(np.float64), subpixels)
    return _block_means(rendering.radiance[..., :3], subpixels), covered == 1


def minified(folder: Path, distance: Distance, shown: str) -> MinifiedFoil:
    """What of `pictures` was drawn, compared with the mean of its subpixels."""

    def moved(name: str, subpixels: int) -> tuple[Array, Mask]:
        pictures = [read_picture(folder, distance.name(name, at), subpixels) for at in SHIFTS]
        radiance, covered = zip(*pictures, strict=True)
        return np.stack(radiance), np.all(covered, axis=0)

    mean, whole = moved(MEAN, distance.subpixels)
    found, covered = moved(shown, 1)
    inside = whole & covered
    mean, found = mean[:, inside], found[:, inside]
    return MinifiedFoil(
        foil=distance.foil,
        texels=distance.texels,
        shown=shown,
        mean_error=float(np.abs(found - mean).mean() / mean.mean()),
        brightness=float(found.mean() / mean.mean()),
        flicker=float(found.std(axis=0).mean() / mean.std(axis=0).mean()),
    )


def _block_means(values: Array, block: int) -> Array:
    """Means over block × block pixels; values: shape (height, width, …)."""
    height, width = (size // block for size in values.shape[:2])
    blocks = values.reshape(height, block, width, block, *values.shape[2:])
    return blocks.mean(axis=(1, 3))
