"""The report, from scenes to files."""

from __future__ import annotations

import json
import shutil
import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import Progress

from precompute.errors import unreadable
from precompute.files import written_aside
from precompute.renderings import Rendering, reference_xyz
from precompute.report import acquisition, browser, left_out, minification
from precompute.report.acquisition_page import acquisition_page
from precompute.report.bake_cost import SIZES, bake_cost
from precompute.report.comparison import compare
from precompute.report.furnace import PROFILES, Furnace, furnace_description, measure_furnace
from precompute.report.grating_stability import EDGES, grating_stability
from precompute.report.left_out import Drawn, forced, left_out_parts, left_out_row
from precompute.report.measured_errors import measured_errors
from precompute.report.measurements import MethodResult, SceneResult
from precompute.report.page import BAKE_PICTURE, index_page
from precompute.report.pictures import draw_bake_cost, draw_comparison, draw_pareto
from precompute.report.rows import Acquisition, BakeCost, LeftOut, MinifiedFoil, Report, Stability
from precompute.report.scenes import METHOD_OPTIONS, Scene, read_scenes
from precompute.report.shader_cost import StaticCost, missing_packages, static_cost
from precompute.report.stability import CASES, GRAZING, grazing_stability, series_stability
from precompute.report.timing import LAUNCHES, Times, timing_request

MAPS = browser.ROOT / "maps" / "baked"
SCENES = browser.ROOT / "tests" / "scenes"
MEASURED_ERRORS = browser.ROOT / "web" / "materials" / "measured-errors.json"
"""Which method errs by how much, for `DiffractionMaterial` to choose from."""

THREADS = 1
"""Of the renderer when it is timed: tests/browser/time.mjs."""


def make_report(scenes: list[Scene], output: Path, console: Console) -> Report:
    """Measure scenes and write report.json, index.md and the pictures.

    The folder is written aside and takes its name when it is complete. The report of all scenes
    also renews the table from which a material chooses its method.

    Args:
        scenes: What to measure.
        output: The folder; what it held before goes.
        console: For progress and remarks.

    Raises:
        BrowserError: A scene did not render.
        InputError: A rendering cannot be compared.
    """
    lacking = missing_packages()
    if lacking:
        console.print(
            f"No static instruction counts: apt-get install {' '.join(lacking)}", style="yellow"
        )
    with tempfile.TemporaryDirectory() as folder, Progress(console=console) as progress:
        work = Path(folder)
        _render(scenes, work, progress)
        methods = _compare(scenes, work, progress, count=not lacking)
        furnaces = {name: Rendering.read(work, _furnace(name)) for name in PROFILES}
        stability = _stability(furnaces, progress)
        times = _time(scenes, work, progress)
        saved = [] if lacking else _left_out(scenes, work, progress)
        minified = _minified(scenes, work, progress)
        costs = _bake(progress) if is_whole(scenes) else []
    results = {s.name: SceneResult(s, methods[s.name], times[s.name]) for s in scenes}
    report = Report(
        backend=furnaces[PROFILES[0]].backend,
        threads=THREADS,
        rows=[row for result in results.values() for row in result.rows()],
        stability=stability,
        left_out=saved,
        minified=minified,
        bake_cost=costs,
    )
    _write(report, results, output, lacking)
    if is_whole(scenes):
        MEASURED_ERRORS.write_text(measured_errors(report.rows, scenes).to_json(), "utf-8")
        report = renew_acquisition(output, console)
    return report


def renew_acquisition(output: Path, console: Console) -> Report:
    """Measure acquired foils alone, and put them into a report that is there.

    They need neither browser nor a quiet machine.

    Args:
        output: The report's folder.
        console: For progress.

    Raises:
        InputError: There is no report.
    """
    file = output / "report.json"
    try:
        report = Report.model_validate_json(file.read_bytes())
    except OSError as failure:
        raise unreadable(file, failure) from failure
    with tempfile.TemporaryDirectory() as folder:
        with Progress(console=console) as progress:
            report.acquisition = _acquired(Path(folder), progress)
        for picture in Path(folder).iterdir():
            shutil.copy(picture, output / picture.name)
    with written_aside(output / "acquisition.md") as aside:
        aside.write_text(acquisition_page(report.acquisition), "utf-8")
    with written_aside(file) as aside:
        aside.write_text(report.to_json(), "utf-8")
    return report


def _acquired(pictures: Path, progress: Progress) -> list[Acquisition]:
    rows = []
    with _stage(progress, "Acquisition", acquisition.COUNT) as advance:
        for row in acquisition.acquisition_rows(pictures):
            rows.append(row)
            advance(f"{row.case}, {row.figure}: {row.value:.4g}")
    return rows


def is_whole(scenes: list[Scene]) -> bool:
    """Whether these are all scenes: what a bake costs depends on none of them, and comes last."""
    return [scene.name for scene in scenes] == [scene.name for scene in read_scenes(SCENES)]


@contextmanager
def _stage(progress: Progress, name: str, total: int) -> Iterator[Callable[[object], None]]:
    """A bar that fills; a log, which shows no bars, gets a line with the hour for each item."""
    task = progress.add_task(name, total=total)

    def done(item: object) -> None:
        progress.advance(task)
        if not progress.console.is_terminal:
            progress.console.log(f"{name}: {item}")

    yield done


def _furnace(profile: str) -> str:
    return f"furnace.{profile}"


def _render(scenes: list[Scene], work: Path, progress: Progress) -> None:
    descriptions: dict[str, dict[str, Any]] = {
        scene.picture_name(index): scene.drawn_by(method)
        for scene in scenes
        for index, method in enumerate(scene.methods)
    }
    for profile in PROFILES:
        description = furnace_description(profile, METHOD_OPTIONS["closed-form"])
        descriptions[_furnace(profile)] = description
    with _stage(progress, "Rendering", len(descriptions)) as advance:
        for name in browser.render(descriptions, work):
            advance(name)


def _compare(
    scenes: list[Scene], work: Path, progress: Progress, count: bool
) -> dict[str, tuple[MethodResult, ...]]:
    results: dict[str, tuple[MethodResult, ...]] = {}
    with (
        _stage(progress, "Reference", len(scenes)) as advance,
        ProcessPoolExecutor(mp_context=get_context("spawn")) as pool,
    ):
        measured = [pool.submit(_compare_scene, scene, work, count) for scene in scenes]
        try:
            for scene, future in zip(scenes, measured, strict=True):
                results[scene.name] = future.result()
                advance(scene.name)
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    return results


def _compare_scene(scene: Scene, work: Path, count: bool) -> tuple[MethodResult, ...]:
    names = [scene.picture_name(index) for index in range(len(scene.methods))]
    renderings = [Rendering.read(work, name) for name in names]
    # All methods draw the same geometry.
    reference = reference_xyz(renderings[0], MAPS)
    return tuple(
        MethodResult(
            comparison=compare(rendering, reference),
            tables=_tables(work / f"{name}.json"),
            static=_static(work / f"{name}.frag") if count else None,
        )
        for name, rendering in zip(names, renderings, strict=True)
    )


def _tables(file: Path) -> dict[str, int]:
    tables = json.loads(file.read_text("utf-8"))["tables"]
    return {table["uniform"]: table["bytes"] for table in tables}


def _static(file: Path) -> StaticCost:
    return static_cost(file.read_text("utf-8"))


def _time(scenes: list[Scene], work: Path, progress: Progress) -> dict[str, Times]:
    requests = {scene.name: timing_request(scene) for scene in scenes}
    times = {scene.name: Times() for scene in scenes}
    with _stage(progress, "Timing", LAUNCHES * len(scenes)) as advance:
        for _ in range(LAUNCHES):
            for name, milliseconds in browser.time(requests, work):
                times[name].launches.append(milliseconds)
                advance(name)
    return times


def _left_out(scenes: list[Scene], work: Path, progress: Progress) -> list[LeftOut]:
    chosen = [scene for scene in scenes if scene.name in left_out.SCENES]
    plain = {scene.name: work / f"{scene.picture_name(0)}.json" for scene in chosen}
    parts = {
        scene.name: left_out_parts(
            scene, json.loads(plain[scene.name].read_text("utf-8"))["explanation"]
        )
        for scene in chosen
    }
    descriptions = {
        _forced(scene, index): forced(scene, part)
        for scene in chosen
        for index, (part, _) in enumerate(parts[scene.name])
    }
    requests = {
        scene.name: left_out.timing_request(scene, [part for part, _ in parts[scene.name]])
        for scene in chosen
    }
    launches: dict[str, list[dict[str, float]]] = {scene.name: [] for scene in chosen}
    with _stage(progress, "Left out", len(descriptions) + LAUNCHES * len(chosen)) as advance:
        for name in browser.render(descriptions, work) if descriptions else ():
            advance(name)
        for _ in range(LAUNCHES):
            for name, milliseconds in browser.time(requests, work) if requests else ():
                launches[name].append(milliseconds)
                advance(name)
    return [
        left_out_row(
            scene,
            part,
            entry,
            _drawn(plain[scene.name]),
            _drawn(work / f"{_forced(scene, index)}.json"),
            launches[scene.name],
        )
        for scene in chosen
        for index, (part, entry) in enumerate(parts[scene.name])
    ]


def _minified(scenes: list[Scene], work: Path, progress: Progress) -> list[MinifiedFoil]:
    foils = [scene for scene in scenes if scene.name == minification.SCENE]
    if not foils:
        return []
    description = foils[0].drawn_by(foils[0].methods[0])
    surface = {k: v for k, v in description["surface"].items() if k != "filtered"}
    description |= {"surface": surface}
    drawn = dict(minification.pictures(description, minification.DISTANCES))
    with _stage(progress, "Foils from afar", len(drawn)) as advance:
        for name in browser.render(drawn, work):
            advance(name)
    return [
        minification.minified(work, distance, shown)
        for distance in minification.DISTANCES
        for shown in minification.SHOWN
    ]


def _forced(scene: Scene, index: int) -> str:
    return f"{scene.name}.forced.{index}"


def _drawn(file: Path) -> Drawn:
    return Drawn(_static(file.with_suffix(".frag")), sum(_tables(file).values()))


def _stability(furnaces: dict[str, Rendering], progress: Progress) -> list[Stability]:
    entries = [_furnace_entry(name, measure_furnace(drawn)) for name, drawn in furnaces.items()]
    with _stage(progress, "Stability", len(EDGES) + len(CASES) + len(GRAZING)) as advance:
        for edge in EDGES:
            entries.append(grating_stability(edge))
            advance(edge.case)
        for case in CASES:
            entries.append(series_stability(*case))
            advance(entries[-1].case)
        for degrees in GRAZING:
            entries.append(grazing_stability(MAPS, degrees))
            advance(entries[-1].case)
    return entries


def _bake(progress: Progress) -> list[BakeCost]:
    costs = []
    with _stage(progress, "Baking", len(SIZES)) as advance:
        for size in SIZES:
            costs.append(bake_cost(size))
            advance(size)
    return costs


def _furnace_entry(profile: str, furnace: Furnace) -> Stability:
    return Stability(
        case=f"white furnace to 89°, {profile}, period 1 µm, height 0.3 µm",
        method="closed-form",
        samples=furnace.samples,
        non_finite=furnace.non_finite,
        negative_energy=furnace.negative,
        max_albedo=furnace.largest,
        rel_rmse=furnace.rms_from_one,
        float="fp32",
    )


def _write(
    report: Report, results: dict[str, SceneResult], output: Path, lacking: list[str]
) -> None:
    aside = output.with_name(f"{output.name}.new")
    before = output.with_name(f"{output.name}.old")
    shutil.rmtree(aside, ignore_errors=True)
    aside.mkdir(parents=True)
    try:
        (aside / "report.json").write_text(report.to_json(), "utf-8")
        (aside / "index.md").write_text(index_page(report, results, lacking), "utf-8")
        if report.bake_cost:
            draw_bake_cost(report.bake_cost, aside / BAKE_PICTURE)
        for name, result in results.items():
            labels = [method.label for method in result.scene.methods]
            draw_pareto(result.rows(), labels, aside / f"{name}.png")
            for index, method in enumerate(result.methods):
                draw_comparison(method.comparison, aside / f"{name}.{index}.png")
        shutil.rmtree(before, ignore_errors=True)
        if output.exists():
            output.rename(before)
        aside.rename(output)
        shutil.rmtree(before, ignore_errors=True)
    finally:
        shutil.rmtree(aside, ignore_errors=True)
