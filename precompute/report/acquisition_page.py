"""The page of acquired foils: docs/report/acquisition.md."""

from __future__ import annotations

from precompute.report import filtered_foils, polarization_model, polarized_foils
from precompute.report.acquisition import DESIGNS
from precompute.report.acquisition_bars import acquisition_bars
from precompute.report.page import table
from precompute.report.rows import Acquisition

TEXT = """Photographs are simulated by the reference (`maps/captures`), with what their recipes say
of noise, bumps and tiles off their places, and solved by `diffraction acquire`. In cases named
*flash-…* errors are those of all texels that diffract in truth, edges and texels that no photograph
shows included; of periods at one wavelength, those of texels that are seen. *seed* marks the 2018
paper's methods: the brightest observation decides, tiles lie where they are marked; a filter of
constant width. Cases named *polarization-…* are explained below.
"""

MODEL = """## Polarised light

*polarization-model* is the light of gratings under retarding plastic through a turning polariser,
without camera and noise; orientations are half the phase of what is fitted to it, photographs being
taken as they are, or over their means. Metals are those of facets at 10° to the light; ζ is the
phase of a ratio of 1.001, here under plastic of 3°:
"""

PHOTOGRAPHS = """Other cases are photographs that are registered, fitted and masked. Errors are of
texels that are seen to diffract, and do, the offset from phases to orientations being known. *as
seen* is without, *filtered* with the three passes of the filter that are usual. The disc, 100 mm
wide, has the noise stated, and so have polygons whose photographs are counted; other designs have
what their recipes say:
"""

FILTER = """*step of 30°* is a map of two halves with independent errors of 5°: how far from the
step any texel is off by 5° or more after passes of the filter, ours and one of the paper's width of
0.35 rad throughout. Below is a tile whose bumps deviate by {bumps}° and whose photographs have a
noise of {noise:.0%}, under three flashes: as it was photographed, its map as seen and after passes
of the filter, and the last of these with bumps:
"""

FUSED = """*made absolute by a flash photograph*: offset and periods of maps that were told neither
(`diffraction acquire fuse`), by the first flash photograph of the same design.
"""


def acquisition_page(rows: list[Acquisition]) -> str:
    """The page's Markdown."""
    header = ["case", "figure", "unit", "truth", "value", "spread", "paper", "photographs", "noise"]
    cells = [
        [
            row.case,
            row.figure,
            row.unit,
            f"{row.truth:g}",
            f"{row.value:.4g}",
            f"{row.spread:.3g}",
            _paper(row),
            str(row.photographs),
            "none" if row.noise_db is None else f"{row.noise_db:.0f} dB",
            "seed" if row.seed else "",
        ]
        for row in rows
    ]
    pictures = [
        f"### {design}\n\nThe foil and its map, under a light from which no photograph was taken"
        f"{', by the seed' if mark else ''}:\n\n![{design}](acquisition-{design}{mark}.png)\n"
        for design in DESIGNS
        for mark in ("", "-seed")
    ]
    bars = table(
        ["asked", "bar", "measured", "", "worst in"],
        [bar.cells() for bar in acquisition_bars(rows)],
    )
    polarised = [
        f"{MODEL}\n![orientations in polarised light]({polarization_model.PICTURE})\n",
        f"{PHOTOGRAPHS}\n![errors over noise and photographs]({polarized_foils.PICTURE})\n",
        FILTER.format(bumps=filtered_foils.BUMPS_DEG, noise=filtered_foils.NOISE),
        f"![raw and filtered maps under flashes]({filtered_foils.PICTURE})\n",
        FUSED,
    ]
    parts = ["# Acquired foils\n", TEXT, bars, table([*header, ""], cells), *pictures, *polarised]
    return "\n".join(parts)


def _paper(row: Acquisition) -> str:
    if row.paper is None:
        return "–"
    return f"{row.paper:g}" if row.paper_spread is None else f"{row.paper:g} ± {row.paper_spread:g}"
