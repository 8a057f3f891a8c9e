"""index.md: the report as an answer, bars first."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from precompute.report.measurements import SceneResult
from precompute.report.pictures import DIFFERENCE_GAIN
from precompute.report.rows import Report, Row
from precompute.report.timing import FRAMES, IRIDESCENT, LAUNCHES, STANDARD, WITHOUT

TIMED_SCENE = "plane-directional"
"""The scene whose times are held against the bars: a plane under one directional light."""


@dataclass(frozen=True)
class Bar:
    """Something asked for, and what is measured.

    Attributes:
        asked: What, in words.
        limit: The largest value that meets it; None where no bar is set.
        value: What was measured.
        where: In which scene, at its worst.
        digits: Format of both numbers.
    """

    asked: str
    limit: float | None
    value: float
    where: str
    digits: str = ".3g"

    @property
    def is_met(self) -> bool:
        return self.limit is None or self.value <= self.limit

    def cells(self) -> list[str]:
        value = format(self.value, self.digits)
        if self.limit is None:
            return [self.asked, "none set", value, "", self.where]
        verdict = "met" if self.is_met else "**missed**"
        return [self.asked, f"≤ {format(self.limit, self.digits)}", value, verdict, self.where]


def index_page(report: Report, results: dict[str, SceneResult], lacking: list[str]) -> str:
    """The page's Markdown.

    Args:
        report: The numbers.
        results: The scenes they come from, by name.
        lacking: Debian packages without which instructions were not counted.
    """
    bars = list(all_bars(report, results))
    held = [bar for bar in bars if bar.limit is not None]
    met = sum(bar.is_met for bar in held)
    parts = [
        "# Error against run time\n",
        f"Made by `{report.generated_by}`, version {report.version}, on {report.backend}.\n",
        f"{met} of {len(held)} bars are met.\n",
        _table(["asked", "bar", "measured", "", "worst in"], [bar.cells() for bar in bars]),
        _method_of_measurement(lacking),
        "## Added time\n",
        f"Time that a method adds to the same material with `{WITHOUT}`, and whole frames.\n",
        _added_times(results),
        "## White furnace\n",
        "Luminance over that of a polished surface of the same metal, on a sphere up to 89°.\n",
        _table(
            ["case", "pixels", "not finite", "negative", "largest", "RMS from 1"],
            [
                [
                    entry.case,
                    str(entry.samples),
                    str(entry.non_finite),
                    str(entry.negative_energy),
                    f"{entry.max_albedo:.5f}",
                    f"{entry.rel_rmse:.2g}",
                ]
                for entry in report.stability
            ],
        ),
        *_left_out(report),
        "## Scenes\n",
        f"Pictures show reference, result and {DIFFERENCE_GAIN} × their difference.\n",
        *(_scene(result) for result in results.values()),
    ]
    return "\n".join(parts)


def all_bars(report: Report, results: dict[str, SceneResult]) -> Iterable[Bar]:
    """Every bar that these scenes can be held against."""
    closed = [row for row in report.rows if row.method == "closed-form"]
    lit = [row for row in closed if row.lighting in ("directional", "point")]
    around = [row for row in closed if row.lighting in ("environment", "mixed")]
    loops = [row for row in report.rows if row.method == "wavelength-loop"]
    fine = [row for row in loops if row.knobs.get("wavelength_step") == 0.001]
    arcs = [row for row in report.rows if row.knobs.get("environment_nodes") == 401]
    yield from _worst("closed form under lights, relative RMSE", lit, "rel_rmse", 0.01)
    yield from _worst("closed form under lights, ΔE2000 p95", lit, "delta_e2000_p95", 1)
    yield from _worst("closed form in environments, relative RMSE", around, "rel_rmse", None)
    yield from _worst("closed form in environments, ΔE2000 p95", around, "delta_e2000_p95", None)
    yield from _worst("loop at 1 nm, relative RMSE", fine, "rel_rmse", 0.01)
    yield from _worst("environment by 401 nodes, relative RMSE", arcs, "rel_rmse", 0.005)
    if report.stability:
        worst = max(report.stability, key=lambda entry: entry.max_albedo)
        asked = "white furnace, largest albedo over the metal's"
        yield Bar(asked, 1.001, worst.max_albedo, worst.case, ".5f")
    if TIMED_SCENE in results:
        result = results[TIMED_SCENE]
        ours, loop = _first(result, "closed-form"), _first(result, "wavelength-loop")
        added = result.times.ratio(ours, over=loop, beyond=WITHOUT)
        frame = result.times.ratio(ours, over=IRIDESCENT)
        yield Bar("added time, closed form over loop of 5 nm", 0.1, added, TIMED_SCENE)
        yield Bar("whole frame over iridescent MeshPhysicalMaterial", 1.2, frame, TIMED_SCENE)
    frames: dict[str, float] = {}
    shares: dict[str, float] = {}
    for name, result in results.items():
        scene = result.scene
        if scene.surface == "height_field" or scene.lighting not in ("directional", "point"):
            continue
        ours, loop = _first(result, "closed-form"), _first(result, "wavelength-loop")
        frames[name] = result.times.ratio(ours, over=IRIDESCENT)
        shares[name] = result.times.ratio(ours, over=loop, beyond=WITHOUT)
    for asked, ratios in (("added time", shares), ("whole frame", frames)):
        if ratios:
            worst = max(ratios, key=lambda name: ratios[name])
            yield Bar(f"{asked}, likewise, of all scenes under lights", None, ratios[worst], worst)
    yield from _height_field_bars(report, results)


def _height_field_bars(report: Report, results: dict[str, SceneResult]) -> Iterable[Bar]:
    """Bars of height fields: each method's error, and its added time over the seed's."""
    fields = {
        name: result for name, result in results.items() if result.scene.surface == "height_field"
    }
    for method, share in (("line-sum", 0.1), ("jacobi-anger", 0.5), ("baked", 0.01)):
        rows = [
            row
            for row in report.rows
            if row.scene in fields
            and row.method == method
            and row.lighting in ("directional", "point")
        ]
        yield from _worst(f"height fields by {method}, relative RMSE", rows, "rel_rmse", 0.01)
        ratios = {}
        for name, result in fields.items():
            methods = result.scene.methods
            ours = [str(i) for i, m in enumerate(methods) if m.method == method]
            seeds = [str(i) for i, m in enumerate(methods) if m.seed]
            # What is asked of the others is asked without roughness.
            is_rough = result.scene.description.get("material", {}).get("roughness", 0) > 0
            if ours and seeds and is_rough == (method == "baked"):
                ratios[name] = result.times.ratio(ours[0], over=seeds[0], beyond=WITHOUT)
        if ratios:
            worst = max(ratios, key=lambda name: ratios[name])
            asked = f"added time, {method} over the seed's series"
            yield Bar(asked, share, ratios[worst], worst)
            if method == "baked":
                frame = fields[worst].times.ratio("0", over=IRIDESCENT)
                yield Bar("whole frame, baked, over iridescence", 1.5, frame, worst)


def _worst(asked: str, rows: list[Row], figure: str, limit: float | None) -> Iterable[Bar]:
    if rows:
        worst = max(rows, key=lambda row: getattr(row, figure))
        yield Bar(asked, limit, getattr(worst, figure), worst.scene)


def _first(result: SceneResult, method: str) -> str:
    """Name, among the timed materials, of the scene's first method of that name."""
    return next(str(i) for i, m in enumerate(result.scene.methods) if m.method == method)


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
    return _table(header, rows)


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
    header = ["scene", "left out", "why", "standard frames", "instructions", "bytes"]
    return ["## Left out\n", _table(header, rows)]


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
            _table(header, rows),
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


def _table(header: list[str], rows: list[list[str]]) -> str:
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"
