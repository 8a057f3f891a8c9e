"""index.md: the report as an answer, bars first."""

from __future__ import annotations

from precompute.report.bake_cost import COMPARED_SIZE
from precompute.report.bars import Bar
from precompute.report.grating_bars import grating_bars
from precompute.report.height_field_bars import height_field_bars
from precompute.report.measurements import SceneResult
from precompute.report.pictures import DIFFERENCE_GAIN
from precompute.report.rows import BakeCost, Report, Row, Stability
from precompute.report.stability import PHASE_SAMPLES
from precompute.report.timing import FRAMES, IRIDESCENT, LAUNCHES, STANDARD, WITHOUT

BAKE_PICTURE = "bake-cost.png"
"""File of the picture of `_bake_cost`, beside index.md."""

ACQUIRED = " Foils acquired from photographs have [their own page](acquisition.md)."
"""Made with whole reports, as bake costs are."""


def index_page(report: Report, results: dict[str, SceneResult], lacking: list[str]) -> str:
    """The page's Markdown.

    Args:
        report: The numbers.
        results: The scenes they come from, by name.
        lacking: Debian packages without which instructions were not counted.
    """
    bars = all_bars(report, results)
    held = [bar for bar in bars if bar.limit is not None]
    met = sum(bar.is_met for bar in held)
    parts = [
        "# Error against run time\n",
        f"Made by `{report.generated_by}`, version {report.version}, on {report.backend}.\n",
        f"{met} of {len(held)} bars are met.{ACQUIRED if report.bake_cost else ''}\n",
        table(["asked", "bar", "measured", "", "worst in"], [bar.cells() for bar in bars]),
        _method_of_measurement(lacking),
        "## Added time\n",
        f"Time that a method adds to the same material with `{WITHOUT}`, and whole frames.\n",
        _added_times(results),
        "## White furnace\n",
        "Luminance over that of a polished surface of the same metal, on a sphere up to 89°.\n",
        table(
            ["case", "pixels", "not finite", "negative", "largest", "RMS from 1"],
            [_stability_cells(entry, ".5f") for entry in report.furnaces()],
        ),
        *_grating_edges(report),
        *_height_field_stability(report),
        *_table_memory(results),
        *_bake_cost(report.bake_cost),
        *_left_out(report),
        *_minified(report),
        "## Scenes\n",
        f"Pictures show reference, result and {DIFFERENCE_GAIN} × their difference.\n",
        *(_scene(result) for result in results.values()),
    ]
    return "\n".join(parts)


def all_bars(report: Report, results: dict[str, SceneResult]) -> list[Bar]:
    """Every bar that these scenes can be held against."""
    return [*grating_bars(report, results), *height_field_bars(report, results)]


def _method_of_measurement(lacking: list[str]) -> str:
    static = (
        f"Instructions are not counted: packages {', '.join(lacking)} are not installed."
        if lacking
        else """Instructions are those of the fragment shader's optimised SPIR-V (without gamut
  mapping), arithmetic / transcendental / texture. One on a vector counts once; one in a loop as
  often as the loop runs where its length is fixed, once where a pixel decides it."""
    )
    return f"""## How it is measured

- Errors: linear XYZ radiance, read back as float32, against the float64 reference at 1 nm, over
  all covered pixels; where the reference is zero, what is found there counts as error. ΔE2000
  (pixels above a thousandth of white) and FLIP are taken at the exposure at which the reference's
  99th percentile of luminance is white.
- Times: llvmpipe on one thread, materials interleaved frame by frame, the shortest of {FRAMES}
  frames over that of {STANDARD} in the same launch; the median, least and most of
  {LAUNCHES} launches. The material maps its colours into the gamut, as it does by default.
- {static}
- A bar of a height field's method holds for the settings that err least in each scene, and its
  time is that of the fastest settings within the bar of the error.
- Bytes are those of all tables that the shader reads, but for the environment itself.
- *seed* marks a method of the papers, *front* a row that no other beats in both error and time.
"""


def _added_times(results: dict[str, SceneResult]) -> str:
    rows = []
    for name, result in results.items():
        times, methods = result.times, result.scene.methods
        ours = "0"  # each scene's first method is the one that it is to show
        rows.extend(
            [
                name,
                method.label,
                f"{times.ratio(ours, over=str(index), beyond=WITHOUT):.4f}",
                f"{times.ratio(ours, over=IRIDESCENT):.2f}",
                f"{times.ratio(IRIDESCENT):.2f}",
                f"{times.ratio(ours):.2f}",
            ]
            for index, method in enumerate(methods)
            if method.seed
        )
    header = [
        "scene",
        "seed",
        "first method / seed, added",
        "frame / iridescent",
        "iridescent / standard",
        "frame / standard",
    ]
    return table(header, rows)


def _stability_cells(entry: Stability, digits: str) -> list[str]:
    albedo, error = entry.max_albedo, entry.rel_rmse
    return [
        entry.case,
        str(entry.samples),
        str(entry.non_finite),
        str(entry.negative_energy),
        "–" if albedo is None else format(albedo, digits),
        "–" if error is None else f"{error:.2g}",
    ]


def _grating_edges(report: Report) -> list[str]:
    if not report.edges():
        return []
    text = """Radiance of the closed form, from the tables that the shader reads, against the
reference; half of the views are in a lobe. A sinusoid of 1.66 µm, 0.15 µm high, but for what a line
says. Powers of orders are added: where the coherence is shorter than the period they interfere.
The shader itself is driven to these edges, and to those of meshes, uv and scale, by `npm test`.
"""
    header = ["case", "pairs", "not finite", "negative", "largest", "relative RMSE"]
    rows = [_stability_cells(entry, ".5f") for entry in report.edges()]
    return ["## Gratings at the edges\n", text, table(header, rows)]


def _height_field_stability(report: Report) -> list[str]:
    rows = [
        [
            entry.method,
            {"fp16": "halves", "fp32": "floats"}[entry.float],
            *_stability_cells(entry, ".4f"),
            "" if entry.refused is None else f"refused, asking for {entry.refused}",
        ]
        for entry in report.stability
        if entry.method != "closed-form"
    ]
    if not rows:
        return []
    header = ["method", "tables", "case", "samples", "not finite", "negative", "largest"]
    text = f"""Series: amplitudes of all lines at {PHASE_SAMPLES} values of x, summed in float32 as
the shader does, against float64; the largest share of the light in all lines, and the largest
relative RMSE at any x. Taylor's tables are baked as floats alone: rounded to halves they lose more.
The baked pattern: radiance where both directions graze.
"""
    return [
        "## Height fields at the edges\n",
        text,
        table([*header, "relative RMSE", "bake"], rows),
    ]


def _table_memory(results: dict[str, SceneResult]) -> list[str]:
    sizes: dict[tuple[str, str, str], tuple[int, int]] = {}
    for result in results.values():
        scene = result.scene
        if scene.surface != "height_field":
            continue
        lighting = "environment" if scene.lighting == "environment" else "lights"
        for method, drawn in zip(scene.methods, result.methods, strict=True):
            key = scene.field, method.method, lighting
            least = drawn.own_bytes, drawn.texture_bytes
            sizes[key] = min(sizes.get(key, least), least)
    if not sizes:
        return []
    rows = [[*key, str(own), str(whole)] for key, (own, whole) in sorted(sizes.items())]
    header = ["field", "method", "under", "its own tables, bytes", "with the light's"]
    return ["## Tables of height fields\n", table(header, rows)]


def _bake_cost(costs: list[BakeCost]) -> list[str]:
    if not costs:
        return []
    steps = {cost.size: cost.seconds_per_step for cost in costs}
    rows = [
        [
            f"{cost.size}²",
            f"{cost.seconds:.2f}",
            f"{cost.baking_seconds:.2f}",
            f"{cost.seconds_per_step / steps[COMPARED_SIZE]:.2f}",
            f"{cost.peak_bytes / 1e6:.0f}",
            f"{cost.map_bytes / 1e6:.2f}",
        ]
        for cost in costs
    ]
    header = [
        "samples",
        "seconds",
        "of them baking",
        f"per n log n, over {COMPARED_SIZE}²",
        "peak memory, MB",
        "map, MB",
    ]
    return [
        "## Baking a height field\n",
        f"`diffraction bake` of {costs[0].terms} terms of Jacobi–Anger, each in a process of its "
        "own; what is not baking is starting Python. n is the number of samples.\n",
        table(header, rows),
        f"![time and memory over size]({BAKE_PICTURE})\n",
    ]


def _left_out(report: Report) -> list[str]:
    if not report.left_out:
        return []
    rows = [
        [
            entry.scene,
            entry.feature,
            entry.why,
            f"{entry.saved_time:.2f}",
            str(entry.saved_instructions),
            str(entry.saved_bytes),
        ]
        for entry in report.left_out
    ]
    header = ["scene", "left out", "why", "standard frames saved", "instructions", "bytes"]
    text = """What a material leaves out by itself, forced into the scene's first method, where it
adds nothing to the picture: what that would cost.
"""
    return ["## Left out\n", text, table(header, rows)]


def _minified(report: Report) -> list[str]:
    if not report.minified:
        return []
    rows = [
        [
            entry.foil,
            f"{entry.texels:g}",
            entry.shown,
            f"{entry.mean_error:.4f}",
            f"{entry.brightness:.4f}",
            f"{entry.flicker:.3f}",
        ]
        for entry in report.minified
    ]
    header = ["foil", "texels to a pixel", "shown", "error / mean", "brightness", "flicker"]
    text = """Foils of polygons, 37 texels wide and of few gratings, or 5 wide and of many, against
the mean over subpixels that show the nearest texel each: mean absolute difference over mean
radiance, mean radiance over the mean's, and the deviation of a pixel while the camera moves by less
than one, over the mean's.
"""
    return ["## Foils from afar\n", text, table(header, rows)]


def _scene(result: SceneResult) -> str:
    name = result.scene.name
    compared = result.methods[0].comparison
    size = " × ".join(str(pixels) for pixels in result.scene.description["size"])
    timed = " × ".join(str(pixels) for pixels in result.scene.timing_size)
    header = [
        "method",
        "relative RMSE",
        "ΔE2000 median",
        "p95",
        "FLIP",
        "time",
        "least to most",
        "instructions",
        "bytes",
        "",
    ]
    labels = [method.label for method in result.scene.methods]
    rows = [_cells(row, label) for row, label in zip(result.rows(), labels, strict=True)]
    pictures = [
        f"![{label}]({name}.{index}.png)\n\n{label}\n" for index, label in enumerate(labels)
    ]
    return "\n".join(
        [
            f"### {name}\n",
            f"{size} pixels, {compared.covered} covered and compared, {compared.lit} lit; "
            f"timed at {timed}.\n",
            table(header, rows),
            f"![error over time]({name}.png)\n",
            *pictures,
        ]
    )


def _cells(row: Row, label: str) -> list[str]:
    static = "–"
    if row.static is not None:
        static = " / ".join(str(count) for count in row.static.model_dump().values())
    marks = [word for word, said in (("seed", row.seed), ("front", row.pareto)) if said]
    return [
        label,
        f"{row.rel_rmse:.2g}",
        f"{row.delta_e2000_median:.2f}",
        f"{row.delta_e2000_p95:.2f}",
        f"{row.flip_mean:.4f}",
        f"{row.time_ratio:.2f}",
        f"{row.time_ratio_min:.2f} to {row.time_ratio_max:.2f}",
        static,
        str(row.texture_bytes),
        ", ".join(marks),
    ]


def table(header: list[str], rows: list[list[str]]) -> str:
    """A table in Markdown."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"
