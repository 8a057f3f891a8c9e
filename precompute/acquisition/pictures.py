"""Pictures of an acquisition's steps, for people to see where it goes wrong."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from matplotlib.colors import hsv_to_rgb
from matplotlib.figure import Figure
from numpy.typing import NDArray

from precompute.acquisition.evidence import shown
from precompute.acquisition.flash import Acquired
from precompute.acquisition.map_figure import map_figure
from precompute.acquisition.observations import Shot, half_vectors, looked_up, observed
from precompute.acquisition.pattern import Gratings, gratings_of, texel_indices
from precompute.acquisition.radiance import Lamp, Relief, foil_radiance
from precompute.acquisition.tiling import Tiling
from precompute.files import written_aside
from precompute.maps import Map
from precompute.profiles import Sinusoidal
from precompute.progress import tracked

Array = NDArray[np.float64]

WIDTH = 480
"""Points across the sample in pictures of it."""

RENDERED = 240
"""The same where each is evaluated by the reference."""

SHADES = 24
"""Different periods in a rendering, most: each is evaluated by itself."""

THRESHOLDS = (0.5, 0.2, 0.1, 0.05, 0.02, 0.01)
"""Of the brightest observation, at which lit texels are shown."""


def write_pictures(acquired: Acquired, folder: Path) -> list[Path]:
    """Draw every step.

    Args:
        acquired: What came of a capture.
        folder: Where; made if missing.

    Returns:
        The files: for each photograph ``rectified``, ``half-vectors`` and ``rendering``; ``lit``,
        ``orientation``, ``period`` and ``confidence``.
    """
    written = []
    for name, figure in tracked(_figures(acquired), "Drawing", 4 + 3 * len(_shots(acquired))):
        file = folder / f"{name}.png"
        with written_aside(file) as aside:
            figure.savefig(aside, format="png", dpi=120)
        written.append(file)
    return written


def _shots(acquired: Acquired) -> list[Shot]:
    return acquired.calibration.shots


def _figures(acquired: Acquired) -> Iterator[tuple[str, Figure]]:
    for number, shot in enumerate(_shots(acquired)):
        yield f"rectified-{number}", _rectified(acquired, number)
        yield f"half-vectors-{number}", _half_vectors(shot, acquired.tiling)
    yield "lit", _lit(acquired)
    gratings = acquired.completed.gratings
    extent = (0, float(acquired.tiling.size[0]), 0, float(acquired.tiling.size[1]))
    full = np.ones_like(gratings.strength)
    rgb = hsv_to_rgb(np.stack([gratings.orientation / np.pi, full, gratings.strength], axis=-1))
    yield "orientation", map_figure(rgb, extent, "orientation (deg)", "hsv", (0, 180))
    period = 1 / gratings.frequency
    yield "period", map_figure(period, extent, "period (µm)", "viridis", None)
    confidence = acquired.completed.confidence
    yield "confidence", map_figure(confidence, extent, "confidence", "magma", (0, 1))
    for number in range(len(_shots(acquired))):
        yield f"rendering-{number}", _rendering(acquired, number)


def sample_grid(tiling: Tiling, width: int) -> tuple[Array, tuple[int, int]]:
    """Points over the sample, mm, row by row from its top left, and their rows and columns.

    Args:
        tiling: Where the sample's tiles lie.
        width: Number of columns, pixels.
    """
    size = tiling.sample
    height = max(1, round(width * size[1] / size[0]))
    x = ((np.arange(width) + 0.5) / width - 0.5) * size[0]
    y = (0.5 - (np.arange(height) + 0.5) / height) * size[1]
    points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    return points, (height, width)


def _seen(shot: Shot, tiling: Tiling, width: int) -> Array:
    points, shape = sample_grid(tiling, width)
    values, _ = looked_up(shot, points)
    return values.reshape(*shape, -1).astype(np.float64)


def _sample_extent(tiling: Tiling) -> tuple[float, float, float, float]:
    x, y = tiling.sample / 2
    return (-x, x, -y, y)


def _rectified(acquired: Acquired, number: int) -> Figure:
    """A photograph with its tiles where they were found, and the highlight."""
    tiling, shot = acquired.tiling, _shots(acquired)[number]
    seen = _seen(shot, tiling, 2 * WIDTH)
    figure = Figure((9, 7), layout="constrained")
    axes = figure.subplots()
    axes.imshow(shown(seen, np.percentile(seen, 99.5)), extent=_sample_extent(tiling))
    corners = np.array([(0, 0), (1, 0), (1, 1), (0, 1), (0, 0)], dtype=np.float64)
    for row, column in tiling.tiles():
        x, y = tiling.points(row, column, corners).T
        axes.plot(x, y, color="white", linewidth=0.4)
    highlight = acquired.report.photographs[number].highlight_px
    place = shot.rectification.on_sample(np.array([highlight]))[0]
    axes.plot(*place, "+", color="red", markersize=12)
    axes.set(xlabel="mm", ylabel="mm", title=shot.name)
    axes.set(xlim=_sample_extent(tiling)[:2], ylim=_sample_extent(tiling)[2:])
    return figure


def _half_vectors(shot: Shot, tiling: Tiling) -> Figure:
    """(u, v) over the sample: its direction as hue, its length as brightness and contours."""
    points, shape = sample_grid(tiling, WIDTH)
    h, _ = half_vectors(points, shot.rectification.eye, shot.light)
    u, v = h[:, 0].reshape(shape), h[:, 1].reshape(shape)
    radius = np.hypot(u, v)
    hue = np.mod(np.arctan2(v, u) / np.pi, 1)
    rgb = hsv_to_rgb(np.stack([hue, np.ones_like(hue), np.clip(radius, 0, 1)], axis=-1))
    figure = Figure((8, 6), layout="constrained")
    axes = figure.subplots()
    extent = _sample_extent(tiling)
    image = axes.imshow(rgb, extent=extent, cmap="hsv", vmin=0, vmax=180)
    figure.colorbar(image, ax=axes, label="orientation of a grating lit here (deg)")
    lines = axes.contour(radius[::-1], levels=8, colors="white", linewidths=0.6, extent=extent)
    axes.clabel(lines, fontsize=7)
    axes.set(xlabel="mm", ylabel="mm", title=f"{shot.name}: √(u² + v²)")
    return figure


def _lit(acquired: Acquired) -> Figure:
    """Which texels are lit in any tile and photograph, down to ever lower thresholds."""
    calibration = acquired.calibration
    rows, columns = acquired.completed.seen.shape
    step = max(1, max(rows, columns) // 128)
    y, x = np.meshgrid(
        (np.arange(0, rows, step) + 0.5) / rows,
        (np.arange(0, columns, step) + 0.5) / columns,
        indexing="ij",
    )
    place = np.stack([x.ravel(), y.ravel()], axis=1)
    strip = observed(calibration.shots, acquired.tiling, place, calibration.highlight)
    best = np.where(strip.usable, strip.intensity.sum(axis=2), 0).max(axis=1).reshape(x.shape)
    figure = Figure((9, 6), layout="constrained")
    for axes, threshold in zip(figure.subplots(2, 3).flat, THRESHOLDS, strict=True):
        lit = best > threshold * np.percentile(best, 99.9)
        axes.imshow(lit, cmap="gray", vmin=0, vmax=1)
        axes.set(title=f"{threshold:g} of the brightest: {lit.mean():.0%}", xticks=[], yticks=[])
    return figure


def _rendering(acquired: Acquired, number: int) -> Figure:
    """A photograph, and what the map shows under the same light, by the reference."""
    shot = _shots(acquired)[number]
    points, shape = sample_grid(acquired.tiling, RENDERED)
    rendered = rendering(
        acquired.foil, acquired.tiling, shot, points, acquired.calibration.roughness
    )
    rendered = rendered.reshape(*shape, -1)
    seen = _seen(shot, acquired.tiling, RENDERED)
    figure = Figure((12, 5), layout="constrained")
    for axes, picture, title in zip(
        figure.subplots(1, 2), (seen, rendered), (shot.name, "the map"), strict=True
    ):
        # Each has its own exposure: the lamp's power is not known.
        tone = shown(picture, float(np.percentile(picture, 99)))
        axes.imshow(tone, extent=_sample_extent(acquired.tiling))
        axes.set(title=title, xlabel="mm", ylabel="mm")
    return figure


def rendering(foil: Map, tiling: Tiling, shot: Shot, points: Array, roughness: float) -> Array:
    """What a map shows at points of the sample in a photograph's light, by the reference.

    Args:
        foil: The map.
        tiling: Where its tiles are; each is taken to be in its place.
        shot: Lamp, camera and channels.
        points: mm, shape (n, 2).
        roughness: Of the normal, rad.

    Returns:
        Radiance, as `foil_radiance` has it, shape (n, channels).
    """
    texels = gratings_of(foil)
    place = (points - tiling.corner) / tiling.size
    index = texel_indices(texels.orientation.shape, place)
    flat = Gratings(*(part.ravel() for part in vars(texels).values()))[index]
    frequency = _coarser(flat.frequency)
    height = foil.constants["height_um"]
    assert isinstance(height, float)
    relief = Relief(height, Sinusoidal(), 16.25, roughness)
    lamp = Lamp(shot.light, shot.radius, shot.weights)
    eye = shot.rectification.eye
    gratings = Gratings(flat.orientation, frequency, flat.strength)
    return foil_radiance(points, np.zeros_like(points), gratings, relief, eye, lamp, step=8)


def _coarser(frequency: Array) -> Array:
    """Frequencies rounded to few, evenly in their logarithm."""
    low, high = np.log(frequency.min()), np.log(frequency.max())
    step = max((high - low) / SHADES, 1e-9)
    return np.exp(low + step * np.round((np.log(frequency) - low) / step))
