"""What the browser rendered, and what the reference says of the same pixels."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from precompute.errors import InputError, unreadable
from precompute.gratings import Grating, Light
from precompute.height_fields.environment import (
    environment_radiance as height_field_environment_radiance,
)
from precompute.height_fields.field import HeightField
from precompute.height_fields.optics import HeightFieldOptics
from precompute.height_fields.prepare import prepared
from precompute.height_fields.recipe import HeightFieldRecipe
from precompute.height_fields.reference import colour_brdf as height_field_colour_brdf
from precompute.maps import Map
from precompute.profiles import Profile
from precompute.recipes import ProfileRecipe, read_recipe
from precompute.reference import colour_brdf, environment_radiance
from precompute.spectra import WAVELENGTHS, xyz_to_linear_srgb

Array = NDArray[np.float64]
ColourBrdf = Callable[[Array, Array, Light], Array]
"""XYZ in 1/sr, shape (n, 3), for ω_i and ω_o in the surface's frame and a light."""

OPTICS = ("metal", "coherence", "roughness", "energy")
"""Options of the material that the reference shares."""

TILTS = 17
"""Nodes per axis of a rough surface's tilts under an environment, over ±3 standard deviations. At
1° of roughness they are 0.04 % off in a studio and 0.8 % under a hall's small lamps; 9 were 1 and
20 %."""

BLURRED = 0.01
"""Roughness, rad, from which every fourth nanometre of an environment is enough."""

LAYERS = ("position", "normal", "tangent", "grating", "uv")


@dataclass
class Rendering:
    """One scene as `tests/browser/render.mjs` wrote it.

    Attributes:
        scene: The scene's description (tests/scenes/README.md).
        view: Camera and lights in view space.
        radiance: Linear sRGB, signed, shape (height, width, 3).
        covered: Where the surface is, shape (height, width).
        layers: Geometry by name, view space, shape (height, width, 4).
        environment: Texels of the equirectangular environment, first row at the bottom, or None.
        backend: What rendered it.
    """

    scene: dict[str, Any]
    view: dict[str, Any]
    radiance: Array
    covered: NDArray[np.bool_]
    layers: dict[str, Array]
    environment: Array | None
    backend: str

    @staticmethod
    def read(folder: Path, name: str) -> Rendering:
        """Read NAME.json and the arrays beside it.

        Raises:
            InputError: A file is missing or cannot be read.
        """
        file = folder / f"{name}.json"
        try:
            description = json.loads(file.read_text("utf-8"))
            shape = (description["height"], description["width"], 4)
            radiance = np.fromfile(folder / f"{name}.radiance.f32", np.float32).reshape(shape)
            geometry = np.fromfile(folder / f"{name}.geometry.f32", np.float32)
            layers = geometry.reshape(len(LAYERS), *shape).astype(np.float64)
            environment = None
            if description["environment"] is not None:
                size = (description["environment"]["height"], description["environment"]["width"])
                texels = np.fromfile(folder / f"{name}.environment.f32", np.float32)
                environment = np.maximum(texels.reshape(*size, 4)[..., :3].astype(np.float64), 0)
        except (OSError, ValueError, KeyError) as failure:
            raise unreadable(file, failure) from failure
        return Rendering(
            scene=description["scene"],
            view=description["view"],
            radiance=radiance[..., :3].astype(np.float64),
            covered=layers[0][..., 3] > 0.5,
            layers=dict(zip(LAYERS, layers, strict=True)),
            environment=environment,
            backend=description["backend"],
        )

    @property
    def material(self) -> dict[str, Any]:
        """The material's options as the scene states them."""
        return self.scene.get("material", {})

    @property
    def light(self) -> Light:
        """Illuminant and observer of the scene."""
        names = {k: v for k, v in self.material.items() if k in ("illuminant", "observer")}
        return Light.model_validate(names)

    def xyz(self) -> Array:
        """The rendered radiance as XYZ, covered pixels only, shape (n, 3)."""
        matrix = xyz_to_linear_srgb(self.light.observer, self.light.illuminant)
        return self.radiance[self.covered] @ np.linalg.inv(matrix).T


def reference_xyz(rendering: Rendering, maps: Path, stride: int = 1) -> Array:
    """The reference's radiance at the pixels the browser covered, strength applied.

    Args:
        rendering: Geometry, lights and environment.
        maps: Folder of the baked maps; only their recipes are read, those of height fields from
            the folder ``recipes`` beside it.
        stride: Keeps every so-many-th covered pixel.

    Returns:
        XYZ, shape (covered pixels / stride, 3).
    """
    layers = {k: v[rendering.covered][::stride] for k, v in rendering.layers.items()}
    n, t = layers["normal"][:, :3], layers["grating"][:, :3]
    frame = np.stack([t, np.cross(n, t), n], axis=1)
    frame /= np.linalg.norm(frame, axis=2, keepdims=True)
    position = layers["position"][:, :3]
    wo = _local(frame, -position / np.linalg.norm(position, axis=1, keepdims=True))
    if rendering.scene["surface"]["kind"] == "height-field":
        result = _height_field_xyz(rendering, maps, position, frame, wo)
    else:
        frequencies = layers["tangent"][:, 3]
        result = _gratings_xyz(rendering, maps, position, frame, wo, frequencies)
    return layers["normal"][:, 3:] * result


def _height_field_xyz(
    rendering: Rendering, maps: Path, position: Array, frame: Array, wo: Array
) -> Array:
    field, optics = _height_field(rendering, maps)

    def brdf(wi: Array, wo: Array, light: Light) -> Array:
        return height_field_colour_brdf(field, optics, wi, wo, light)

    result = np.zeros((len(wo), 3))
    for light in rendering.view["lights"]:
        result += _lit_by(light, brdf, rendering, position, frame, wo)
    if rendering.environment is not None:
        environment, view = _environment(rendering)
        rows = np.flatnonzero(wo[:, 2] > 0)
        result[rows] += height_field_environment_radiance(
            field,
            optics,
            wo[rows],
            environment,
            rendering.light,
            frame=frame[rows] @ view,
        )
    return result


def _gratings_xyz(
    rendering: Rendering, maps: Path, position: Array, frame: Array, wo: Array, frequencies: Array
) -> Array:
    profile, height = _relief(rendering, maps)
    options = {k: v for k, v in rendering.material.items() if k in OPTICS}
    result = np.zeros((len(wo), 3))
    for frequency in np.unique(frequencies):
        if frequency <= 0:
            continue
        rows = frequencies == frequency
        grating = Grating(period=1 / frequency, height=height, profile=profile, **options)

        def brdf(wi: Array, wo: Array, light: Light, grating: Grating = grating) -> Array:
            return colour_brdf(grating, wi, wo, light)

        for light in rendering.view["lights"]:
            result[rows] += _lit_by(light, brdf, rendering, position[rows], frame[rows], wo[rows])
        if rendering.environment is not None:
            result[rows] += _lit_by_environment(rendering, grating, frame[rows], wo[rows])
    return result


def _height_field(rendering: Rendering, maps: Path) -> tuple[HeightField, HeightFieldOptics]:
    """The prepared field that the surface names, by name or by address, and the material."""
    surface = rendering.scene["surface"]
    name = Path(surface["field"]).name.removeprefix("height-field-")
    file = maps.parent / "recipes" / f"height-field-{name}.json"
    recipe = read_recipe(file)
    if not isinstance(recipe, HeightFieldRecipe):
        raise InputError(file, "kind", recipe.kind, "height-field")
    options = {k: v for k, v in rendering.material.items() if k in OPTICS}
    if surface.get("tiles") is not None:
        options["tiles"] = surface["tiles"]
    if surface.get("ior") is not None:
        # A dielectric shows nothing of the material's metal.
        options |= {"ior": surface["ior"], "metal": None}
    return prepared(recipe, file.parent), HeightFieldOptics.model_validate(options)


def _relief(rendering: Rendering, maps: Path) -> tuple[Profile, float]:
    surface = rendering.scene["surface"]
    if surface["kind"] == "foil":
        foil = Map.read(maps / Path(surface["map"]).name)
        name, height = foil.recipe["profile"], foil.constants["height_um"]
        height = surface.get("height", height)
    else:
        name, height = surface.get("profile", "sinusoidal"), surface["height"]
    recipe = ProfileRecipe.model_validate(Map.read(maps / f"profile-{name}").recipe)
    return recipe.profile, float(height)


def _local(frame: Array, direction: Array) -> Array:
    return np.einsum("nij,nj->ni", frame, direction)


def _lit_by(
    light: dict[str, Any],
    brdf: ColourBrdf,
    rendering: Rendering,
    position: Array,
    frame: Array,
    wo: Array,
) -> Array:
    colour = np.asarray(light["color"], dtype=np.float64)
    if light["kind"] == "directional":
        towards = np.broadcast_to(np.asarray(light["direction"]), position.shape)
        distance = np.ones((len(position), 1))
    elif light["kind"] == "point":
        towards = np.asarray(light["position"]) - position
        distance = np.linalg.norm(towards, axis=1, keepdims=True)
        towards = towards / distance
    else:
        raise ValueError(f"the reference has no light of kind {light['kind']}")
    wi = _local(frame, towards)
    radius = light["angularRadius"] or rendering.material.get("lightAngularRadius") or 0.0
    source = rendering.light.model_copy(
        update={"angular_radius": radius, "tint": tuple(colour.tolist())}
    )
    irradiance = np.maximum(wi[:, 2:], 0) / distance**2
    return irradiance * brdf(wi, wo, source)


def _lit_by_environment(rendering: Rendering, grating: Grating, frame: Array, wo: Array) -> Array:
    environment, view = _environment(rendering)
    wavelengths = WAVELENGTHS[2::4] if grating.roughness >= BLURRED else WAVELENGTHS
    result = np.zeros((len(wo), 3))
    for start in range(0, len(wo), 512):
        part = slice(start, start + 512)
        rows = np.flatnonzero(wo[part, 2] > 0) + start
        result[rows] = environment_radiance(
            grating,
            wo[rows],
            environment,
            rendering.light,
            wavelengths,
            tilts=TILTS,
            frame=frame[rows] @ view,
        )
    return result


def _environment(rendering: Rendering) -> tuple[_Equirectangular, Array]:
    """The environment, and the rotation from the world to the view, shape (3, 3)."""
    assert rendering.environment is not None
    view = np.array(rendering.view["viewMatrix"]).reshape(4, 4)[:3, :3].T  # stored by columns
    intensity = rendering.view["environmentIntensity"]
    return _Equirectangular(rendering.environment, intensity), view


class _Equirectangular:
    """Bilinear lookups by directions in the world, as WebGL makes them."""

    def __init__(self, texels: Array, intensity: float) -> None:
        self.texels = texels
        self.intensity = intensity

    def __call__(self, direction: Array) -> Array:
        x, y, z = direction.T
        height, width = self.texels.shape[:2]
        column = (np.arctan2(z, x) / (2 * np.pi) + 0.5) * width - 0.5
        row = np.clip((np.arcsin(np.clip(y, -1, 1)) / np.pi + 0.5) * height - 0.5, 0, height - 1)
        i, j = np.floor(column).astype(int), np.minimum(np.floor(row).astype(int), height - 2)
        s, t = (column - i)[:, None], (row - j)[:, None]
        left, right = i % width, (i + 1) % width
        low = (1 - s) * self.texels[j, left] + s * self.texels[j, right]
        high = (1 - s) * self.texels[j + 1, left] + s * self.texels[j + 1, right]
        return self.intensity * ((1 - t) * low + t * high)
