"""A polarisation map made absolute by a flash photograph of the same foil."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from precompute.acquisition.capture import read_capture
from precompute.acquisition.fusion import Fusion, fused
from precompute.acquisition.marked_tile import reference_tiling
from precompute.acquisition.observations import texel_places
from precompute.acquisition.pattern import gratings_of
from precompute.acquisition.shots import ROUGHNESS, read_shots
from precompute.acquisition.tiling import Tiling
from precompute.errors import InputError
from precompute.foils.foil_map import foil_map
from precompute.maps import Map

ALIKE = 0.5
"""Correlation of what the photograph shows and the map would from which they are of one foil: the
same foil's is 0.8 or more, its mirror image's 0.35."""


def acquire_fused(
    map_file: Path,
    capture_file: Path,
    say: Callable[[str], None],
    draw: Callable[[InputError], InputError],
) -> tuple[Map, Fusion]:
    """Give a map its orientations' offset and its periods' scale.

    The map is a tile of what the capture shows, which may be all of it: tiles of its size begin at
    the reference tile's corner, or at the sample's top left.

    Args:
        map_file: A foil's, of `acquire polarization`.
        capture_file: Of flash photographs, of which the first that can be used is.
        say: Takes remarks.
        draw: See `read_shots`.

    Returns:
        The map, and how it was found.

    Raises:
        InputError: The map is no foil, the capture cannot be used (see `read_shots`), the
            photograph shows nothing of the map (see `fused`), or it shows another foil.
    """
    foil = Map.read(map_file)
    if foil.kind != "foil":
        raise InputError(map_file, "kind", foil.kind, "foil")
    capture = read_capture(capture_file, "flash")
    taken = read_shots(capture, capture_file.parent, say, draw)
    sample = np.array(capture.sample.size_mm)
    corner, marked = sample / 2 * [-1, 1], capture.sample.reference_tile_px
    if marked is not None:
        corner = np.array(reference_tiling(marked, taken.rectifications[0], str(capture_file))[1])
    tile = np.broadcast_to(foil.constants["tile_mm"], 2)
    height = float(np.ravel(foil.constants["height_um"])[0])
    gratings = gratings_of(foil)
    rows, columns = gratings.orientation.shape
    known = gratings.strength > 0
    if "confidence" in foil.tables:
        known &= foil.tables["confidence"].values[..., 0] > 0
    fusion = fused(
        np.where(known, gratings.orientation, np.nan).ravel(),
        np.where(known, 1 / np.maximum(gratings.frequency, 1e-3), np.nan).ravel(),
        texel_places((columns, rows)),
        taken.shots[0],
        Tiling.covering(sample, tile, corner),
        height,
        ROUGHNESS,
    )
    if fusion.correlation < ALIKE:
        found = f"light that correlates with the map's by {fusion.correlation:.2f}"
        raise InputError(capture_file, "photographs", found, f"{ALIKE:g} or more, of the same foil")
    told = {
        "offset_deg": float(np.degrees(fusion.offset)),
        "periods_times": fusion.scale,
        "correlation": fusion.correlation,
        "photograph": taken.shots[0].name,
    }
    made = foil_map(
        gratings.orientation + fusion.offset,
        gratings.frequency / fusion.scale,
        gratings.strength,
        height=height,
        tile_mm=(float(tile[0]), float(tile[1])),
        recipe={**foil.recipe, "fused": told},
    )
    made.tables |= {name: table for name, table in foil.tables.items() if name != "grating"}
    return made, fusion
