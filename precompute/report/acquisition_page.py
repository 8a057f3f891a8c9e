"""The page of acquired foils: docs/report/acquisition.md."""

from __future__ import annotations

from precompute.report.acquisition import DESIGNS
from precompute.report.acquisition_bars import acquisition_bars
from precompute.report.acquisition_polarization import PICTURE
from precompute.report.page import table
from precompute.report.rows import Acquisition

TEXT = """Photographs are simulated by the reference (`maps/captures`), with what their recipes say
of noise, bumps and tiles off their places, and solved by `diffraction acquire flash`. Errors are
those of all texels that diffract in truth, edges and texels that no photograph shows included; of
periods at one wavelength, those of texels that are seen. *seed* marks the 2018 paper's method: the
brightest observation decides, tiles lie where they are marked.
"""

POLARISED = """### Polarised light

*polarization-model* is the light of gratings under retarding plastic through a turning polariser,
without camera and noise; orientations are half the phase of what is fitted to it, photographs being
taken as they are, or over their means. Metals are those of facets at 10° to the light; ζ is the
phase of a ratio of 1.001, here under plastic of 3°:
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
            "–" if row.paper is None else f"{row.paper:g} ± {row.paper_spread:g}",
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
    polarised = f"{POLARISED}\n![orientations in polarised light]({PICTURE})\n"
    parts = ["# Acquired foils\n", TEXT, bars, table([*header, ""], cells), *pictures, polarised]
    return "\n".join(parts)
