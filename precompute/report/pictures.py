"""The report's pictures."""

from __future__ import annotations

from pathlib import Path

import colour
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

from precompute.report.bake_cost import COMPARED_SIZE
from precompute.report.comparison import Comparison
from precompute.report.rows import BakeCost, Row

Array = NDArray[np.float64]

DIFFERENCE_GAIN = 10
"""Differences are shown so many times brighter."""

SMALLEST = 256
"""Pictures smaller than this are enlarged by whole pixels."""

GAP = 4


def draw_comparison(comparison: Comparison, file: Path) -> None:
    """Reference, result and `DIFFERENCE_GAIN` times their difference, side by side.

    Pictures much broader than high go one under the other.
    """
    reference, result = comparison.pictures
    panels = [reference, result, DIFFERENCE_GAIN * np.abs(result - reference)]
    height, width = reference.shape[:2]
    axis = 0 if width > 2 * height else 1
    gap = np.ones((GAP, width, 3) if axis == 0 else (height, GAP, 3))
    joined = np.concatenate([panels[0], gap, panels[1], gap, panels[2]], axis=axis)
    encoded = colour.cctf_encoding(np.clip(joined, 0, 1), function="sRGB")
    picture = Image.fromarray(np.round(255 * encoded).astype(np.uint8))
    enlarge = max(1, -(-SMALLEST // max(height, width)))
    picture = picture.resize(
        (picture.width * enlarge, picture.height * enlarge), Image.Resampling.NEAREST
    )
    picture.save(file, optimize=True)


def draw_pareto(rows: list[Row], labels: list[str], file: Path) -> None:
    """Error over run time of one scene's rows, those of the Pareto front joined.

    Args:
        rows: The rows of one scene.
        labels: What to write beside each.
        file: Where the PNG goes.
    """
    figure = Figure(figsize=(6.4, 3.2), dpi=100, layout="constrained")
    axes = figure.subplots()
    front = sorted((row for row in rows if row.pareto), key=lambda row: row.time_ratio)
    axes.plot(
        [row.time_ratio for row in front],
        [row.rel_rmse for row in front],
        color="tab:green",
        linewidth=1,
        zorder=1,
    )
    for index, (row, label) in enumerate(zip(rows, labels, strict=True)):
        span = [row.time_ratio_min], [row.time_ratio_max]
        axes.hlines([row.rel_rmse], *span, color="grey", linewidth=1)
        dot = "tab:orange" if row.seed else "tab:blue"
        axes.scatter([row.time_ratio], [row.rel_rmse], color=dot, zorder=2)
        axes.annotate(
            f"{label} (seed)" if row.seed else label,
            (row.time_ratio, row.rel_rmse),
            xytext=(0, 6 if index % 2 == 0 else -14),  # neighbours' labels do not meet
            textcoords="offset points",
            ha="center",
            fontsize=8,
        )
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.margins(0.25)
    axes.set_xlabel("frame time / MeshStandardMaterial")
    axes.set_ylabel("relative RMSE")
    axes.grid(alpha=0.3)
    figure.savefig(file, metadata={"Software": None})


def draw_bake_cost(costs: list[BakeCost], file: Path) -> None:
    """Time and peak memory of baking over the number of samples, with a line that grows as n log n.

    Args:
        costs: One of each size; the line goes through that of `COMPARED_SIZE`.
        file: Where the PNG goes.
    """
    figure = Figure(figsize=(6.4, 3.2), dpi=100, layout="constrained")
    seconds, memory = figure.subplots(1, 2)
    sizes = np.array([cost.size for cost in costs])
    samples = sizes.astype(np.float64) ** 2
    step = next(cost.seconds_per_step for cost in costs if cost.size == COMPARED_SIZE)
    growth = step * samples * np.log2(samples)
    seconds.plot(sizes, growth, color="grey", linewidth=1, label="n log n")
    baking = [cost.baking_seconds for cost in costs]
    seconds.scatter(sizes, baking, color="tab:blue", zorder=2, label="baking")
    whole = [cost.seconds for cost in costs]
    seconds.scatter(sizes, whole, color="tab:orange", zorder=2, label="whole command")
    seconds.set_ylabel("s")
    seconds.legend(fontsize=8)
    memory.scatter(sizes, [cost.peak_bytes / 1e6 for cost in costs], color="tab:blue", zorder=2)
    memory.set_ylabel("peak memory, MB")
    for axes in (seconds, memory):
        axes.set_xscale("log", base=2)
        axes.set_yscale("log")
        axes.set_xlabel("samples along a side")
        axes.set_xticks(sizes, [str(size) for size in sizes])
        axes.grid(alpha=0.3)
    figure.savefig(file, metadata={"Software": None})
