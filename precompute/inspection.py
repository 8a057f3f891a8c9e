"""What is in a map, as text and as pictures."""

from __future__ import annotations

from pathlib import Path

import colour
import numpy as np
from matplotlib.colors import hsv_to_rgb
from matplotlib.figure import Figure
from numpy.typing import NDArray
from rich.console import Group
from rich.table import Table as TextTable

from precompute.axes import Axis
from precompute.files import written_aside
from precompute.lobes import LAYERS
from precompute.maps import Map, Sidecar, Table, sidecar_file

Array = NDArray[np.float64]


def description(file: Path) -> Group:
    """A map's sidecar and the ranges of its values as text, its checksums verified.

    Raises:
        InputError: As `precompute.maps.Map.read`.
    """
    sidecar, tables = Sidecar.read(sidecar_file(file)), Map.read(file).tables
    facts = TextTable(show_header=False, box=None)
    facts.add_row("kind", sidecar.kind)
    facts.add_row("quantity", f"{sidecar.quantity}, {sidecar.symbol}")
    for name, constant in sidecar.constants.items():
        facts.add_row(name, _numbers(constant))
    if "normal" in tables:
        facts.add_row("bumps", _tilts(tables["normal"]))
    facts.add_row("error", ", ".join(f"{k} {_numbers(v)}" for k, v in sidecar.error.items()))
    facts.add_row("generator", " ".join(sidecar.generator.values()))
    facts.add_row("checksums", "match")
    parts: list[TextTable] = [facts]
    for name, spec in sidecar.arrays.items():
        size = (file.parent / spec.file).stat().st_size
        title = f"{name}: {spec.file}, {size} bytes, {spec.dtype}"
        text = TextTable(title=title, title_justify="left")
        for column in ("", "symbol", "unit", "size", "mapping", "from", "to"):
            text.add_column(column, justify="right" if column in ("size", "from", "to") else "left")
        for a in spec.axes:
            ends = _numbers(a.first), _numbers(a.last)
            text.add_row(a.name, a.symbol, a.unit, str(a.size), a.mapping, *ends)
        text.add_section()
        values = tables[name].values.reshape(-1, len(spec.channels))
        for channel, low, high in zip(
            spec.channels, values.min(axis=0), values.max(axis=0), strict=True
        ):
            text.add_row(channel, "", "", "", "values", _numbers(low), _numbers(high))
        parts.append(text)
    return Group(*parts)


def write_pictures(file: Path, folder: Path) -> list[Path]:
    """A picture of each array of a map, NAME-ARRAY.png in `folder`.

    Raises:
        InputError: As `precompute.maps.Map.read`.
    """
    baked = Map.read(file)
    name = sidecar_file(file).stem
    written = []
    for key, table in baked.tables.items():
        if baked.kind == "foil" and key == "grating":
            figure = _foil(baked, table)
        elif key == "normal":
            figure = _bumps(baked, table)
        elif key == "lobe":
            figure = _lobe(baked, table)
        else:
            figure = _values(baked, table)
        figure.suptitle(f"{name}: {baked.quantity}", fontsize=9)
        picture = folder / f"{name}-{key}.png"
        with written_aside(picture) as aside:
            figure.savefig(aside, format="png", dpi=150)
        written.append(picture)
    return written


def _tilts(table: Table) -> str:
    """How far the surface leans along u and v."""
    slopes = table.values[..., :2]
    along_u, along_v = np.degrees(np.arctan(slopes.std(axis=(0, 1))))
    most = np.degrees(np.arctan(np.hypot(slopes[..., 0], slopes[..., 1]).max()))
    return f"deviation {along_u:.3g} deg along u, {along_v:.3g} deg along v; {most:.3g} deg at most"


def _bumps(baked: Map, table: Table) -> Figure:
    """How far the normal leans towards growing u and growing v."""
    figure = Figure((9, 4), layout="constrained")
    tilts = np.degrees(np.arctan(table.values[..., :2]))
    most = np.abs(tilts).max()
    for axes, tilt, name in zip(
        figure.subplots(1, 2), np.moveaxis(tilts, -1, 0), "uv", strict=True
    ):
        image = axes.imshow(tilt, extent=_extent(baked), cmap="RdBu_r", vmin=-most, vmax=most)
        figure.colorbar(image, ax=axes, label=f"tilt towards {name} (deg)")
        axes.set(xlabel="mm", ylabel="mm")
    return figure


def _extent(baked: Map) -> tuple[float, float, float, float]:
    """Left, right, bottom and top of a foil's tile, mm."""
    width, height = np.broadcast_to(baked.constants["tile_mm"], 2)
    return (0.0, float(width), 0.0, float(height))


def _foil(baked: Map, table: Table) -> Figure:
    """Orientation as hue, strength as brightness, and the spatial frequency beside it."""
    figure = Figure((9, 4), layout="constrained")
    orientations, frequencies = figure.subplots(1, 2)
    extent = _extent(baked)
    cos2, sin2, frequency, strength = np.moveaxis(table.values, -1, 0)
    hue = np.mod(np.arctan2(sin2, cos2) / (2 * np.pi), 1)
    rgb = hsv_to_rgb(np.stack([hue, np.ones_like(hue), np.clip(strength, 0, 1)], axis=-1))
    image = orientations.imshow(rgb, extent=extent, cmap="hsv", vmin=0, vmax=180)
    figure.colorbar(image, ax=orientations, label="orientation θ (deg)")
    image = frequencies.imshow(frequency, extent=extent)
    figure.colorbar(image, ax=frequencies, label="1/a (1/µm)")
    for axes in (orientations, frequencies):
        axes.set(xlabel="mm", ylabel="mm")
    return figure


def _lobe(baked: Map, table: Table) -> Figure:
    """The colours of lobes, each layer scaled to its brightest channel."""
    layers, widths, positions = table.axes
    matrix = np.reshape(baked.constants["xyz_to_rgb"], (3, 3))
    figure = Figure((8, 5), layout="constrained")
    panels = figure.subplots(layers.size, 1, sharex=True)
    for panel, layer, tint in zip(panels, table.values, LAYERS, strict=True):
        rgb = layer[..., :3] @ matrix.T
        shown = colour.cctf_encoding(np.clip(rgb / rgb.max(), 0, 1), function="sRGB")
        panel.pcolormesh(positions.parameters(), widths.parameters(), shown, shading="nearest")
        panel.set(yscale=_scale(widths), ylabel=f"{tint}\n{_label(widths)}")
    panels[-1].set_xlabel(_label(positions))
    return figure


def _values(baked: Map, table: Table) -> Figure:
    """Curves over one axis, or an image over two."""
    axes = [(i, axis) for i, axis in enumerate(table.axes) if axis.size > 1]
    figure = Figure((7, 4), layout="constrained")
    panel = figure.subplots()
    if len(axes) == 1:
        _, axis = axes[0]
        curves = table.values.reshape(axis.size, -1)
        panel.plot(axis.parameters(), curves, label=table.channels)
        panel.set(xlabel=_label(axis), xscale=_scale(axis))
        panel.legend(fontsize=7)
        return figure
    (_, rows), (_, columns) = axes[-2:]
    values = table.values[..., 0].reshape(-1, rows.size, columns.size)[0]
    image = panel.pcolormesh(
        columns.parameters(), rows.parameters(), values, shading="nearest", cmap="magma"
    )
    figure.colorbar(image, ax=panel, label=baked.symbol)
    panel.set(xlabel=_label(columns), ylabel=_label(rows))
    return figure


def _label(axis: Axis) -> str:
    return f"{axis.name} {axis.symbol}" + ("" if axis.unit == "1" else f" ({axis.unit})")


def _scale(axis: Axis) -> str:
    return "log" if axis.mapping == "log" else "linear"


def _numbers(value: object) -> str:
    if isinstance(value, tuple | list):
        return ", ".join(_numbers(v) for v in value)
    return f"{value:.6g}" if isinstance(value, float | np.floating) else str(value)
