"""The report's own arithmetic: rows, fronts, counts, comparisons and failures."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError
from rich.console import Console

from precompute.errors import InputError
from precompute.height_fields.expansion import Expansion
from precompute.height_fields.generate import generated
from precompute.height_fields.recipe import HeightFieldRecipe
from precompute.height_fields.terms import terms_map
from precompute.recipes import read_recipe
from precompute.renderings import Rendering
from precompute.report import bake_cost, browser, left_out
from precompute.report.bake_cost import SIZES, BakeError, bake_recipe, measured
from precompute.report.bars import Bar, worst
from precompute.report.browser import ROOT
from precompute.report.comparison import Comparison, compare
from precompute.report.furnace import measure_furnace
from precompute.report.grating_stability import Edge, grating_stability
from precompute.report.grating_stability import compared as radiance_compared
from precompute.report.left_out import Drawn, forced, left_out_parts, left_out_row
from precompute.report.measured_errors import MeasuredErrors, measured_errors, surface_class
from precompute.report.measurements import MethodResult, SceneResult
from precompute.report.page import BAKE_PICTURE, all_bars, index_page
from precompute.report.pictures import draw_bake_cost
from precompute.report.rows import (
    BakeCost,
    MinifiedFoil,
    Report,
    Row,
    Stability,
    mark_pareto,
)
from precompute.report.run import MEASURED_ERRORS, SCENES, is_whole, make_report
from precompute.report.scenes import Method, Scene, read_scenes
from precompute.report.shader_cost import (
    StaticCost,
    count_instructions,
    missing_packages,
    static_cost,
)
from precompute.report.stability import compared, relief, series_stability, with_tables_in
from precompute.report.timing import IRIDESCENT, STANDARD, WITHOUT, Times, timing_request

ROW: dict[str, Any] = {
    "scene": "foil-plane-directional",
    "surface": "foil",
    "lighting": "directional",
    "method": "closed-form",
    "seed": False,
    "knobs": {"wavelength_step": 0.005},
    "rel_rmse": 0.004,
    "delta_e2000_median": 0.1,
    "delta_e2000_p95": 0.6,
    "flip_mean": 0.003,
    "time_ratio": 1.31,
    "time_ratio_min": 1.28,
    "time_ratio_max": 1.34,
    "static": {"alu": 210, "transcendental": 9, "texture": 4},
    "texture_bytes": 65536,
    "pareto": True,
}


def row(**changes: Any) -> Row:
    return Row.model_validate(ROW | changes)


def rendering(radiance: np.ndarray) -> Rendering:
    """A picture without a scene, covered all over, normals towards the viewer."""
    shape = radiance.shape[:2]
    ahead = np.broadcast_to([0.0, 0.0, 1.0, 1.0], (*shape, 4))
    return Rendering(
        scene={},
        view={},
        radiance=radiance,
        covered=np.ones(shape, bool),
        layers={"position": -ahead, "normal": ahead},
        environment=None,
        backend="",
    )


def gradient() -> np.ndarray:
    rows, columns = np.mgrid[0:32, 0:32] / 31
    return np.stack([rows, columns, 1 - rows], axis=-1) + 0.05


def test_a_row_is_written_as_it_is_read() -> None:
    report = Report(backend="llvmpipe", threads=1, rows=[row()])
    written = json.loads(report.to_json())
    assert written["rows"] == [ROW]
    assert list(written) == [
        *("generated_by", "version", "backend", "threads", "rows"),
        *("stability", "left_out", "acquisition", "minified", "bake_cost"),
    ]
    assert Report.model_validate(written) == report


def test_a_row_without_counts_says_nothing_of_them() -> None:
    report = Report(backend="llvmpipe", threads=1, rows=[row(static=None)])
    assert "static" not in json.loads(report.to_json())["rows"][0]


@pytest.mark.parametrize(
    "changes",
    [
        {"rel_rmse": float("nan")},
        {"rel_rmse": -0.1},
        {"time_ratio": 0.0},
        {"surface": "hologram"},
        {"lighting": "moonlight"},
        {"texture_bytes": -1},
        {"comment": "fine"},
    ],
)
def test_rows_that_cannot_be_are_refused(changes: dict[str, Any]) -> None:
    with pytest.raises(ValidationError):
        row(**changes)


def test_the_front_is_what_nothing_beats_in_both() -> None:
    rows = [
        row(rel_rmse=0.01, time_ratio=1.0),
        row(rel_rmse=0.001, time_ratio=5.0),
        row(rel_rmse=0.02, time_ratio=1.5),  # beaten by the first
        row(rel_rmse=0.01, time_ratio=2.0),  # as wrong as the first, slower: lower in one only
        row(rel_rmse=0.5, time_ratio=9.0, scene="another"),
    ]
    mark_pareto(rows)
    assert [entry.pareto for entry in rows] == [True, True, False, True, True]


def test_a_comparison_sees_a_planted_error() -> None:
    truth = rendering(gradient())
    same = compare(truth, truth.xyz())
    assert same.rel_rmse < 1e-12
    assert same.delta_e2000_p95 < 1e-6
    assert same.flip_mean == 0
    brighter = compare(rendering(1.1 * gradient()), truth.xyz())
    assert brighter.rel_rmse == pytest.approx(0.1)
    assert brighter.delta_e2000_p95 > 1
    turned = compare(rendering(gradient()[:, ::-1]), truth.xyz())
    assert turned.rel_rmse > 0.1
    assert turned.flip_mean > 0.1


def test_a_picture_with_a_nan_is_refused() -> None:
    radiance = gradient()
    radiance[3, 4, 1] = np.nan
    with pytest.raises(InputError) as caught:
        compare(rendering(radiance), rendering(gradient()).xyz())
    assert (caught.value.field, caught.value.value) == ("radiance", "1 pixels")


def test_a_reference_without_light_is_refused() -> None:
    with pytest.raises(InputError) as caught:
        compare(rendering(gradient()), np.zeros((1024, 3)))
    assert caught.value.field == "reference"


def test_a_furnace_sees_gain_and_loss() -> None:
    radiance = np.full((8, 8, 3), 0.5)
    radiance[0, 0] = 1.0
    radiance[0, 1] = np.inf
    radiance[0, 2] = -0.5
    furnace = measure_furnace(rendering(radiance))
    assert furnace.largest / abs(furnace.smallest) == pytest.approx(2)
    # Aluminium reflects 0.91 to 0.92 of visible light.
    assert 1 / 0.93 < furnace.largest < 1 / 0.90
    assert (furnace.samples, furnace.non_finite, furnace.negative) == (64, 1, 1)


LOOPS = """
       %1 = OpFMul %float %a %b
       %2 = OpLabel
       %3 = OpSLessThan %bool %i %int_81
               OpLoopMerge %20 %19 Unroll
               OpBranchConditional %3 %4 %20
       %4 = OpLabel
       %5 = OpImageFetch %v4float %t %i
       %6 = OpSLessThanEqual %bool %j %k
               OpLoopMerge %12 %11 Unroll
               OpBranchConditional %6 %7 %12
       %7 = OpLabel
       %8 = OpExtInst %float %glsl Exp %x
       %12 = OpLabel
       %13 = OpExtInst %float %glsl FMax %x %y
      %20 = OpLabel
      %21 = OpImageSampleExplicitLod %v4float %s %uv Lod %float_0
      %22 = OpCompositeExtract %float %21 0
"""


def test_instructions_count_with_the_length_of_fixed_loops() -> None:
    # The loop's own condition stands before its body, and counts once.
    assert count_instructions(LOOPS) == StaticCost(
        alu=1 + 1 + 81 + 81, transcendental=81, texture=81 + 1
    )


@pytest.mark.skipif(bool(missing_packages()), reason=f"apt-get install {missing_packages()}")
def test_a_shader_is_counted() -> None:
    shader = """#version 300 es
        precision highp float;
        uniform sampler2D map;
        uniform bool flag;
        in vec2 uv;
        out vec4 color;
        float average(vec3 v) { return dot(v, vec3(1.0 / 3.0)); }
        void main() {
            color = vec4(average(texture(map, uv).rgb));
            for (int i = 0; i < 4; i++) color.x += exp(uv.x + float(i));
            if (flag) color.y = sin(uv.y);
        }"""
    cost = static_cost(shader)
    assert (cost.transcendental, cost.texture) == (4, 1)
    with pytest.raises(RuntimeError, match="glslangValidator"):
        static_cost(shader.replace("exp(", "expo("))


def test_times_are_ratios_within_a_launch() -> None:
    # The second launch ran on a machine half as fast.
    times = Times(
        [
            {STANDARD: 2.0, IRIDESCENT: 3.0, WITHOUT: 1.0, "0": 3.0, "1": 21.0},
            {STANDARD: 4.0, IRIDESCENT: 6.0, WITHOUT: 2.0, "0": 6.0, "1": 42.0},
        ]
    )
    assert times.ratios("0") == [1.5, 1.5]
    assert times.ratio("0", over=IRIDESCENT) == 1
    assert times.ratio("0", over="1", beyond=WITHOUT) == pytest.approx(0.1)


SCENE: dict[str, Any] = {
    "size": [4, 4],
    "surface": {"kind": "grating", "period": 1, "height": 0.1},
    "material": {"metal": "gold"},
    "lights": [{"kind": "directional", "direction": [0, 0, 1]}],
    "methods": [
        {"method": "closed-form"},
        {"method": "taylor", "seed": True, "knobs": {"wavelength_step": 0.005}},
    ],
    "timing_size": [8, 8],
}


def written(folder: Path, **changes: Any) -> Path:
    file = folder / "plane.json"
    file.write_text(json.dumps(SCENE | changes), "utf-8")
    return file


def test_a_scene_is_drawn_with_its_methods_and_its_material(tmp_path: Path) -> None:
    scene = Scene.read(written(tmp_path))
    assert scene.drawn_by(scene.methods[1])["material"] == {
        "metal": "gold",
        "method": "wavelength-loop",
        "efficiencies": "taylor",
        "wavelengthStep": 0.005,
    }
    request = timing_request(scene)
    assert request["scene"]["size"] == (8, 8)
    assert [material["name"] for material in request["materials"][3:]] == ["0", "1"]
    assert request["frames"] >= 15


@pytest.mark.parametrize(
    ("lights", "environment", "expected"),
    [
        (["directional"], False, "directional"),
        (["point", "point"], False, "point"),
        ([], True, "environment"),
        (["directional"], True, "mixed"),
        (["directional", "point"], False, "mixed"),
    ],
)
def test_lighting(tmp_path: Path, lights: list[str], environment: bool, expected: str) -> None:
    changes: dict[str, Any] = {"lights": [{"kind": kind} for kind in lights]}
    if environment:
        changes["environment"] = {"asset": "studio"}
    assert Scene.read(written(tmp_path, **changes)).lighting == expected


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"methods": [{"method": "magic"}]}, "methods.0.method"),
        ({"methods": [{"method": "taylor", "knobs": {"nodes": 3}}]}, "methods.0.knobs.nodes"),
        ({"timing_size": [0]}, "timing_size.1"),
    ],
)
def test_a_bad_scene_is_refused(tmp_path: Path, changes: dict[str, Any], field: str) -> None:
    with pytest.raises(InputError) as caught:
        Scene.read(written(tmp_path, **changes))
    assert caught.value.field == field


def test_a_scene_must_say_how_it_is_compared(tmp_path: Path) -> None:
    file = tmp_path / "plane.json"
    file.write_text("{}", "utf-8")
    with pytest.raises(InputError) as caught:
        Scene.read(file)
    assert caught.value.field == "methods"


def test_all_scenes_can_be_read_and_cover_profiles_and_periods() -> None:
    scenes = read_scenes(SCENES)
    gratings = [scene.description["surface"] for scene in scenes if scene.surface == "grating"]
    profiles = {"sinusoidal", "rectangular", "blazed", "triangular", "sampled"}
    assert {grating["profile"] for grating in gratings} == profiles
    assert {0.6, 1.0, 1.66, 3.0} <= {grating["period"] for grating in gratings}
    assert {scene.lighting for scene in scenes} == {"directional", "point", "environment", "mixed"}
    with pytest.raises(InputError, match="no-such-scene"):
        read_scenes(SCENES, ["no-such-scene"])


def result(tmp_path: Path, name: str) -> SceneResult:
    scene = Scene.read(written(tmp_path)).model_copy(update={"name": name})
    comparison = Comparison(0.004, 0.1, 0.6, 0.003, 16, 12, np.zeros((2, 4, 4, 3)))
    launch = {STANDARD: 1.0, IRIDESCENT: 2.0, WITHOUT: 0.5, "0": 3.0, "1": 10.5}
    methods = (
        MethodResult(comparison, {"uLobeTable": 100}, None),
        MethodResult(comparison, {"uEfficiencyTable": 50}, StaticCost(alu=1)),
    )
    return SceneResult(scene, methods, Times([launch]))


def test_the_page_says_where_a_bar_is_missed(tmp_path: Path) -> None:
    drawn = result(tmp_path, "plane-directional")
    drawn = SceneResult(
        drawn.scene.model_copy(
            update={"methods": (Method(method="closed-form"), Method(method="wavelength-loop"))}
        ),
        drawn.methods,
        drawn.times,
    )
    report = Report(backend="llvmpipe", threads=1, rows=drawn.rows())
    bars = {bar.asked: bar for bar in all_bars(report, {drawn.scene.name: drawn})}
    assert bars["added time, closed form over loop of 5 nm"].value == pytest.approx(0.25)
    assert bars["whole frame over iridescent MeshPhysicalMaterial"].value == pytest.approx(1.5)
    page = index_page(report, {drawn.scene.name: drawn}, lacking=["spirv-tools"])
    assert "**missed**" in page
    assert "packages spirv-tools are not installed" in page
    assert "2 of 4 bars are met" in page


def test_a_bar_is_met_at_its_limit() -> None:
    assert Bar("error", 0.01, 0.01, "").is_met
    assert not Bar("error", 0.01, 0.0101, "").is_met


FIELD_METHODS: list[dict[str, Any]] = [
    {"method": "line-sum"},
    {"method": "jacobi-anger", "knobs": {"wavelength_step": 0.005}},
    {"method": "jacobi-anger", "knobs": {"wavelength_step": 0.001}},
    {"method": "taylor", "seed": True},
    {"method": "baked"},
]


def field_result(
    tmp_path: Path, name: str, errors: Sequence[float], frames: Sequence[float], **changes: Any
) -> SceneResult:
    """A height field drawn by the first of `FIELD_METHODS`, added times being frames less one."""
    drawn_by = changes.pop("methods", FIELD_METHODS)[: len(errors)]
    field = {"kind": "height-field", "field": changes.pop("field", "bumps")}
    surface = changes.pop("surface", field)
    file = written(tmp_path, surface=surface, methods=drawn_by, **changes)
    scene = Scene.read(file).model_copy(update={"name": name})
    methods = [
        MethodResult(
            Comparison(error, 0.1, 0.6, 0.003, 16, 12, np.zeros((2, 4, 4, 3))),
            {"uTerms": 1000 * (i + 1), "uLobeTable": 64512},
            None,
        )
        for i, error in enumerate(errors)
    ]
    launch = {STANDARD: 1.5, IRIDESCENT: 2.0, WITHOUT: 1.0}
    launch |= {str(i): frame for i, frame in enumerate(frames)}
    return SceneResult(scene, tuple(methods), Times([launch]))


def field_bars(*drawn: SceneResult, **report: Any) -> dict[str, Bar]:
    made = Report(
        backend="llvmpipe", threads=1, rows=[row for d in drawn for row in d.rows()], **report
    )
    return {bar.asked: bar for bar in all_bars(made, {d.scene.name: d for d in drawn})}


def test_a_method_counts_by_the_settings_that_err_least_in_its_worst_field(tmp_path: Path) -> None:
    bumps = field_result(tmp_path, "sharp", [0.002, 0.03, 0.004, 0.003], [2, 6, 11, 21])
    blazed = field_result(tmp_path, "steep", [0.016, 0.002], [2, 6], field="blazed")
    around = field_result(
        *(tmp_path, "studio", [0.2], [2]),
        **{"lights": [], "environment": {"asset": "studio"}},
    )
    bars = field_bars(bumps, blazed, around)
    lines = bars["height fields by line-sum, relative RMSE"]
    assert (lines.value, lines.where, lines.is_met) == (0.016, "blazed, steep", False)
    series = bars["height fields by jacobi-anger, relative RMSE"]
    assert (series.value, series.where, series.is_met) == (0.004, "bumps, sharp", True)
    assert bars["height fields by taylor, relative RMSE"].value == 0.003
    assert "height fields by baked, relative RMSE" not in bars
    studio = bars["height fields in environments, relative RMSE"]
    assert (studio.value, studio.limit) == (0.2, None)


def test_speed_is_compared_at_equal_error(tmp_path: Path) -> None:
    sharp = field_result(tmp_path, "sharp", [0.002, 0.03, 0.004, 0.003], [2, 6, 11, 21])
    bars = field_bars(sharp)
    # The step of 5 nm is faster, and not within a hundredth.
    assert bars["added time, jacobi-anger over the seed's series"].value == pytest.approx(0.5)
    assert bars["added time, line-sum over the seed's series"].value == pytest.approx(0.05)
    wrong = field_result(tmp_path, "sharp", [0.02, 0.03, 0.04, 0.003], [2, 6, 11, 21])
    assert not any(asked.startswith("added time") for asked in field_bars(wrong))


def arcs_result(
    tmp_path: Path, name: str, errors: Sequence[float], frames: Sequence[float]
) -> SceneResult:
    """A grating in an environment: 21 uniform nodes first, then ours; one frame without."""
    seed = {"method": "wavelength-loop", "seed": True, "knobs": {"environment_nodes": 21}}
    ours = [{"method": "closed-form", "knobs": {"environment_nodes": n}} for n in (8, 12, 26)]
    return field_result(
        *(tmp_path, name, errors, frames),
        **{"methods": [seed, *ours], "lights": [], "environment": {"asset": "studio"}},
        surface=SCENE["surface"],
    )


def test_arcs_are_held_against_the_papers_at_equal_time_and_at_equal_error(tmp_path: Path) -> None:
    in_time = "error over that of the papers' arcs, in their time"
    at_error = "added time over that of the papers' arcs, at their error"
    good = arcs_result(tmp_path, "studio", [0.01, 0.02, 0.01, 0.001], [21, 4, 6, 21])
    bars = field_bars(good)
    assert bars[in_time].value == pytest.approx(0.1)
    assert bars[at_error].value == pytest.approx(0.25)
    assert bars[in_time].is_met and bars[at_error].is_met
    # The most nodes are a little slower than the papers', the middle ones a little worse.
    slow = arcs_result(tmp_path, "night", [0.01, 0.02, 0.0101, 0.001], [21, 4, 6, 21.1])
    bars = field_bars(good, slow)
    assert (bars[in_time].where, bars[at_error].where) == ("night", "night")
    assert bars[in_time].value == pytest.approx(1.01)
    assert bars[at_error].value == pytest.approx(1.005)
    assert not bars[in_time].is_met and not bars[at_error].is_met
    never = arcs_result(tmp_path, "venice", [0.01, 0.02, 0.03, 0.04], [21, 22, 23, 24])
    assert field_bars(never)[in_time].value == field_bars(never)[at_error].value == np.inf


def test_the_baked_pattern_is_timed_with_roughness_and_others_without(tmp_path: Path) -> None:
    rough = field_result(
        *(tmp_path, "height-field-bumps-rough", [0.003, 0.002, 0.001], [1.5, 3, 101]),
        methods=[FIELD_METHODS[4], FIELD_METHODS[0], FIELD_METHODS[3]],
        material={"roughness": 0.0175},
    )
    bars = field_bars(rough)
    assert bars["added time, baked over the seed's series"].value == pytest.approx(0.005)
    assert "added time, line-sum over the seed's series" not in bars
    assert bars["whole frame, baked, over iridescence"].value == pytest.approx(0.75)
    memory = bars["tables of the baked pattern at 1° of roughness, MB"]
    assert memory.value == pytest.approx(0.065512)
    page = index_page(Report(backend="", threads=1, rows=rough.rows()), {"rough": rough}, [])
    # The light's tables are told from the field's.
    assert "| bumps | baked | lights | 1000 | 65512 |" in page


def test_every_shipped_field_is_drawn_by_every_method_it_is_baked_for() -> None:
    drawn: dict[str, set[str]] = {}
    for scene in read_scenes(SCENES):
        if scene.surface == "height_field" and scene.lighting != "environment":
            drawn.setdefault(scene.field, set()).update(m.method for m in scene.methods)
    files = sorted((browser.ROOT / "maps" / "recipes").glob("height-field-*.json"))
    assert files
    for file in files:
        recipe = read_recipe(file)
        assert isinstance(recipe, HeightFieldRecipe)
        expected = {"line-sum", *recipe.methods}
        assert drawn[file.stem.removeprefix("height-field-")] >= expected, file


def test_a_worst_figure_says_where() -> None:
    (bar,) = worst("error", [("one", 0.1), ("two", 0.3), ("three", 0.2)], 0.2)
    assert (bar.where, bar.value, bar.is_met) == ("two", 0.3, False)
    assert list(worst("error", [], 0.2)) == []


@pytest.mark.parametrize("precision", ["fp16", "fp32"])
def test_the_stability_of_a_series_is_measured(precision: Any) -> None:
    entry = series_stability("jacobi-anger", precision, 10.0)
    assert (entry.non_finite, entry.refused) == (0, None)
    assert entry.samples > 0
    assert entry.rel_rmse is not None and entry.rel_rmse <= 0.02
    # All the power of |exp(ikwh)|² = 1 is in the lines.
    assert entry.max_albedo == pytest.approx(1, abs=1e-3)


def test_where_taylor_is_refused_the_row_says_so_and_the_page_too() -> None:
    taken, refused = (series_stability("taylor", "fp32", phase) for phase in (6.5, 10.0))
    assert taken.refused is None
    assert taken.rel_rmse is not None and taken.rel_rmse <= 0.02
    assert refused.refused is not None and "jacobi-anger" in refused.refused
    report = Report(backend="", threads=1, rows=[], stability=[taken, refused])
    rows = json.loads(report.to_json())["stability"]
    assert "refused" not in rows[0]
    assert rows[1]["rel_rmse"] is None and rows[1]["max_albedo"] is None
    assert "refused, asking for jacobi-anger: at x = k w Δ = 20.0" in index_page(report, {}, [])


def test_the_edges_of_gratings_are_measured_and_on_the_page() -> None:
    near, short = (
        grating_stability(Edge("tilted", {"roughness": 0.01745}, degrees=(80, 89.99), pairs=40)),
        # Neighbouring orders interfere, which powers that are added cannot show.
        grating_stability(Edge("short", {"coherence": 0.4}, pairs=40)),
    )
    for entry in (near, short):
        assert (entry.samples, entry.non_finite, entry.negative_energy) == (40, 0, 0)
    assert near.rel_rmse is not None and short.rel_rmse is not None
    assert near.rel_rmse < 0.01 < short.rel_rmse
    report = Report(backend="", threads=1, rows=[], stability=[near, short])
    assert report.furnaces() == []
    page = index_page(report, {}, [])
    assert "| tilted | 40 | 0 | 0 | – |" in page
    assert "closed form at the edges, not finite | ≤ 0 | 0 | met" in page


def test_planted_errors_of_radiance_are_seen() -> None:
    exact = np.array([[1.0, 2, 3], [0.5, 1, 1.5]])
    assert radiance_compared(exact, exact) == {
        "non_finite": 0,
        "negative_energy": 0,
        "rel_rmse": 0.0,
    }
    scaled = radiance_compared(1.01 * exact, exact)
    assert scaled["rel_rmse"] == pytest.approx(0.01, rel=1e-6)
    dark = radiance_compared(exact * [[1], [-1]], exact)
    assert dark["negative_energy"] == 1
    missing = exact.copy()
    missing[0, 2] = np.nan
    assert radiance_compared(missing, exact)["non_finite"] == 1
    assert radiance_compared(missing, exact)["rel_rmse"] is None


def test_planted_errors_of_amplitudes_are_seen() -> None:
    exact = np.array([[1, 0], [0.6, 0.8j]], complex)
    found = exact.astype(np.complex64)
    assert compared(found, exact)["rel_rmse"] == pytest.approx(0, abs=1e-6)
    found[1] *= 1.1
    off = compared(found, exact)
    assert off["rel_rmse"] == pytest.approx(0.1, rel=1e-4)
    assert off["max_albedo"] == pytest.approx(1.21, rel=1e-4)
    found[0, 1] = np.nan
    assert compared(found, exact) == {"samples": 4, "non_finite": 1}


@pytest.mark.parametrize(("expansion", "own"), [("jacobi-anger", "fp16"), ("taylor", "fp32")])
def test_tables_in_the_precision_of_the_bake_are_the_bakes(expansion: Expansion, own: Any) -> None:
    field = relief(2.4)
    baked = terms_map(field, expansion, None, 1e-3, {}, "hump")
    terms = baked.tables["terms"]
    same = with_tables_in(own, baked, expansion, field).tables["terms"]
    assert same.dtype == terms.dtype
    # Of two transforms; a half float turns a difference at a rounding's edge into its last digit.
    step = np.finfo(terms.dtype).eps
    assert np.allclose(same.values, terms.values, rtol=step, atol=1e-7)
    other = with_tables_in("fp32" if own == "fp16" else "fp16", baked, expansion, field)
    assert other.tables["terms"].dtype != terms.dtype


def stability(**changes: Any) -> Stability:
    entry = {"case": "hump", "method": "jacobi-anger", "samples": 9, "non_finite": 0}
    entry |= {"negative_energy": 0, "max_albedo": 1.0, "rel_rmse": 0.001, "float": "fp16"}
    return Stability.model_validate(entry | changes)


def test_an_unstable_series_misses_its_bar() -> None:
    broken = stability(case="high hump", non_finite=1, max_albedo=None, rel_rmse=None)
    bars = field_bars(stability=[stability(), broken, stability(method="closed-form")])
    asked = "jacobi-anger at x = k w Δ/2 from 0 to 80"
    for figure in ("not finite", "relative RMSE"):
        bar = bars[f"{asked}, {figure}"]
        assert (bar.is_met, bar.where) == (False, "high hump")
    # A refusal is no failure, and half floats are none of Taylor's.
    unstable = {"method": "taylor", "rel_rmse": None, "float": "fp32"}
    refused = stability(**unstable, refused="jacobi-anger")
    rounded = stability(method="taylor", rel_rmse=2.5)
    good = stability(method="taylor", float="fp32")
    asked = "taylor where the bake takes it, relative RMSE"
    assert field_bars(stability=[refused, rounded, good])[asked].is_met
    assert not field_bars(stability=[stability(**unstable), good])[asked].is_met


def test_the_memory_of_a_bake_is_its_own() -> None:
    ours = bytearray(300 * 2**20)
    ours[::4096] = b"x" * len(ours[::4096])
    _, empty, _ = measured([sys.executable, "-c", "pass"])
    assert empty < 100 * 2**20
    hungry = "held = bytearray(b'x') * (200 * 2**20); print('done')"
    seconds, peak, printed = measured([sys.executable, "-c", hungry])
    assert 200 * 2**20 <= peak < 300 * 2**20
    assert (seconds > 0, printed) == (True, "done")


def test_a_bake_that_fails_is_an_error_with_its_own_words() -> None:
    with pytest.raises(BakeError, match="no room"):
        measured([sys.executable, "-c", "import sys; sys.exit('no room')"])


@pytest.mark.parametrize("size", SIZES[:3])
def test_fields_are_baked_at_the_sizes_that_are_stated(size: int) -> None:
    recipe = HeightFieldRecipe.model_validate(bake_recipe(size))
    assert recipe.source.kind == "fingers"
    assert generated(recipe.source, recipe.pitch).heights.shape == (size, size)
    assert recipe.terms == 30


def test_a_bake_is_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bake_cost, "RUNS", 1)
    cost = bake_cost.bake_cost(128)
    assert (cost.size, cost.terms) == (128, 30)
    assert 0 < cost.baking_seconds < cost.seconds
    assert cost.peak_bytes > 30 * 2**20  # Python, numpy and scipy alone hold more
    # Half of the visible lines of 6.4 µm, ±40 a side, as fifteen pairs of terms of eight bytes.
    assert 15 * 8 * 41 * 81 / 2 < cost.map_bytes < 15 * 8 * 41 * 81 * 2


def test_only_the_whole_report_bakes() -> None:
    scenes = read_scenes(SCENES)
    assert is_whole(scenes)
    assert not is_whole(scenes[:-1])


def bake_costs(*growth: float) -> list[BakeCost]:
    """Bakes whose time grows as n log n but for the factors."""
    costs = []
    for size, factor in zip(SIZES, growth, strict=True):
        n = size**2
        seconds = 1e-7 * factor * n * np.log2(n)
        costs.append(
            BakeCost(
                **{"size": size, "terms": 30, "seconds": seconds + 2, "baking_seconds": seconds},
                **{"peak_bytes": 2 * 10**8 + 1000 * n, "map_bytes": 20 * n},
            )
        )
    return costs


def test_the_growth_of_a_bake_is_seen(tmp_path: Path) -> None:
    costs = bake_costs(1, 1, 1, 1.5, 3)
    report = Report(backend="", threads=1, rows=[], bake_cost=costs)
    page = index_page(report, {}, [])
    for size, factor in zip(SIZES, ("1.00", "1.00", "1.00", "1.50", "3.00"), strict=True):
        (line,) = [line for line in page.splitlines() if line.startswith(f"| {size}² |")]
        assert line.split(" | ")[3] == factor
    assert BAKE_PICTURE in page
    bars = field_bars(bake_cost=costs)
    assert bars["bake of 512², 30 terms, s"].value == pytest.approx(2 + 1e-7 * 512**2 * 18)
    assert bars["bake of 512², 30 terms, GB"].value == pytest.approx(0.2 + 512**2 / 1e6)
    assert bars["bake of 2048², 30 terms, GB"].is_met
    slow, large = (costs[2].model_copy(update=u) for u in ({"seconds": 21}, {"peak_bytes": 3e9}))
    assert not field_bars(bake_cost=[slow])["bake of 512², 30 terms, s"].is_met
    assert not field_bars(bake_cost=[large])["bake of 512², 30 terms, GB"].is_met
    draw_bake_cost(costs, tmp_path / "bake.png")
    assert (tmp_path / "bake.png").stat().st_size > 1000
    assert BAKE_PICTURE not in index_page(report.model_copy(update={"bake_cost": []}), {}, [])


def test_a_scene_that_does_not_render_fails_the_report(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(descriptions: dict[str, Any], folder: Path) -> Any:
        yield next(iter(descriptions))
        raise browser.BrowserError("the shader does not compile")

    monkeypatch.setattr(browser, "render", broken)
    output = tmp_path / "report"
    scene = Scene.read(written(tmp_path))
    with pytest.raises(browser.BrowserError, match="does not compile"):
        make_report([scene], output, Console(quiet=True))
    assert not output.exists()


def test_a_program_that_fails_is_an_error_with_its_own_words(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    script = tmp_path / "tests" / "browser" / "render.mjs"
    script.parent.mkdir(parents=True)
    script.write_text("console.log('first'); throw new Error('second')", "utf-8")
    monkeypatch.setattr(browser, "ROOT", tmp_path)
    drawn = browser.render({"first": {}, "second": {}}, tmp_path)
    assert next(drawn) == "first"
    with pytest.raises(browser.BrowserError, match="second"):
        next(drawn)


def explained(**included: bool) -> list[dict[str, Any]]:
    return [
        {"feature": feature.replace("_", " "), "included": said, "why": f"because of {feature}"}
        for feature, said in included.items()
    ]


def test_what_a_material_left_out_is_forced_in(tmp_path: Path) -> None:
    scene = Scene.read(written(tmp_path))
    said = explained(lacquer=False, matt_base=True, tinted_light=False, gamut_mapping=False)
    said += [{"feature": "orders beyond ±5", "included": False, "why": "too weak"}]
    parts = left_out_parts(scene, said)
    assert [part.feature for part, _ in parts] == ["tinted light", "lacquer", "orders beyond"]
    request = left_out.timing_request(scene, [part for part, _ in parts])
    plain, *with_part = request["materials"][1:]
    assert "force" not in plain
    assert [material["force"] for material in with_part] == [part.force for part, _ in parts]
    assert forced(scene, parts[0][0])["force"] == {"defines": {"TINTED": ""}}
    dark = Scene.read(written(tmp_path, lights=[]))
    assert [part.feature for part, _ in left_out_parts(dark, said)] == ["lacquer", "orders beyond"]


def test_what_is_left_out_saves_the_difference(tmp_path: Path) -> None:
    scene = Scene.read(written(tmp_path))
    (part, entry) = left_out_parts(scene, explained(lacquer=False))[0]
    plain = Drawn(StaticCost(alu=100, transcendental=5, texture=2), tables=1000)
    coated = Drawn(StaticCost(alu=140, transcendental=8, texture=2), tables=1016)
    # The second launch ran on a machine half as fast.
    launches = [
        {STANDARD: 2.0, "plain": 3.0, "lacquer": 3.5},
        {STANDARD: 4.0, "plain": 6.0, "lacquer": 7.0},
    ]
    row = left_out_row(scene, part, entry, plain, coated, launches)
    assert (row.feature, row.why) == ("lacquer", "because of lacquer")
    assert row.saved_time == pytest.approx(0.25)
    assert (row.saved_instructions, row.saved_bytes) == (43, 16)
    page = index_page(Report(backend="", threads=1, rows=[], left_out=[row]), {}, [])
    assert "| lacquer | because of lacquer | 0.25 | 43 | 16 |" in page


def test_the_committed_table_of_errors_is_the_committed_reports() -> None:
    report = Report.model_validate_json((ROOT / "docs/report/report.json").read_text("utf-8"))
    table = MeasuredErrors.model_validate_json(MEASURED_ERRORS.read_text("utf-8"))
    assert table == measured_errors(report.rows, read_scenes(SCENES))
    assert table.to_json() == MEASURED_ERRORS.read_text("utf-8")


def rows_of(scene: Scene, *measured: tuple[str, dict[str, Any], float, float]) -> list[Row]:
    kinds = {"scene": scene.name, "surface": scene.surface, "lighting": scene.lighting}
    return [
        row(**kinds, method=name, knobs=knobs, rel_rmse=error, time_ratio=time)
        for name, knobs, error, time in measured
    ]


def test_a_setting_counts_by_its_worst_scene_and_only_where_all_have_it(tmp_path: Path) -> None:
    first = Scene.read(written(tmp_path))
    second = first.model_copy(update={"name": "second"})
    rows = [
        *rows_of(
            first,
            ("closed-form", {}, 0.003, 2),
            ("wavelength-loop", {"wavelength_step": 0.005}, 0.01, 50),
            ("wavelength-loop", {"wavelength_step": 0.001}, 0.001, 250),
            ("taylor", {"wavelength_step": 0.005}, 0.5, 20),
        ),
        *rows_of(
            second,
            ("closed-form", {}, 0.002, 3),
            ("wavelength-loop", {"wavelength_step": 0.005}, 0.004, 40),
        ),
    ]
    lights = measured_errors(rows, [first, second]).classes["grating"]["lights"]
    assert lights.scenes == 2
    loop = {"method": "wavelength-loop", "efficiencies": "table"}
    assert [setting.model_dump() for setting in lights.settings] == [
        {"options": {"method": "closed-form"}, "rel_rmse": 0.003, "time_ratio": 3},
        {"options": loop | {"wavelengthStep": 0.005}, "rel_rmse": 0.01, "time_ratio": 50},
        # The second has no finer loop: it would err by no more than the coarser.
        {"options": loop | {"wavelengthStep": 0.001}, "rel_rmse": 0.004, "time_ratio": 250},
    ]


def test_an_environment_is_drawn_by_nodes_whatever_the_loop(tmp_path: Path) -> None:
    around = {"environment": {"asset": "studio"}}
    surface = {"kind": "height-field", "field": "bumps"}
    fields = Scene.read(written(tmp_path, surface=surface, lights=[], **around))
    mixed = Scene.read(written(tmp_path, **around)).model_copy(update={"name": "disc"})
    loop = ("wavelength-loop", {"environment_nodes": 9, "wavelength_step": 1}, 0.1, 8)
    lines = [("line-sum", {"environment_nodes": 48}, 0.02, 99), ("line-sum", {}, 0.04, 9)]
    rows = [*rows_of(fields, *lines), *rows_of(mixed, loop)]
    classes = measured_errors(rows, [fields, mixed]).classes
    options = {
        name: [setting.options for setting in parts["environment"].settings]
        for name, parts in classes.items()
    }
    assert options == {
        "sharp height field": [{}, {"environmentNodes": 48}],
        "grating": [{"method": "wavelength-loop", "efficiencies": "table", "environmentNodes": 9}],
    }


def test_the_table_of_a_flat_surface_is_held_to_bars_and_stands_for_no_other(
    tmp_path: Path,
) -> None:
    scene = Scene.read(written(tmp_path, lights=[], environment={"asset": "studio"}))
    table, nodes = ("closed-form", {}, 0.021, 2.1), ("closed-form", {"planar": False}, 0.03, 40)
    report = Report(backend="", threads=1, rows=rows_of(scene, table, nodes))
    bars = {bar.asked: bar for bar in all_bars(report, {})}
    missed = [
        bar.value for name, bar in bars.items() if name.startswith("flat and 0.7 to 1° rough")
    ]
    assert missed == [0.021, 2.1]
    assert not any(bar.is_met for name, bar in bars.items() if name.startswith("flat"))
    read = Report.model_validate_json(report.to_json())
    (setting,) = measured_errors(read.rows, [scene]).classes["grating"]["environment"].settings
    assert setting.rel_rmse == 0.03


def test_a_foil_that_flickers_misses_its_bar() -> None:
    far = [
        MinifiedFoil(
            foil="foil-polygons",
            texels=8,
            shown=shown,
            mean_error=error,
            brightness=1,
            flicker=flicker,
        )
        for shown, error, flicker in (("filtered", 0.04, 1.1), ("nearest texel", 0.3, 2))
    ]
    report = Report(backend="", threads=1, rows=[], minified=far)
    bars = {bar.asked: bar for bar in all_bars(report, {})}
    assert bars["foils from afar, error over mean radiance"].is_met
    flicker = bars["foils from afar, flicker over the mean's"]
    assert (flicker.value, flicker.where, flicker.is_met) == (
        1.1,
        "foil-polygons, 8 texels to a pixel",
        False,
    )
    assert "| foil-polygons | 8 | nearest texel | 0.3000 | 1.0000 | 2.000 |" in index_page(
        report, {}, []
    )


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({}, "grating"),
        ({"surface": {"kind": "foil", "map": "x"}}, "foil"),
        ({"material": {"roughness": 0.01}}, "rough grating"),
        ({"surface": {"kind": "height-field", "field": "x"}}, "sharp height field"),
        (
            {"surface": {"kind": "height-field", "field": "x"}, "material": {"roughness": 0.01}},
            "rough height field",
        ),
        (
            {"surface": {"kind": "height-field", "field": "x", "tiles": 4}},
            "repeated height field",
        ),
    ],
)
def test_scenes_fall_into_classes(tmp_path: Path, changes: dict[str, Any], expected: str) -> None:
    assert surface_class(Scene.read(written(tmp_path, **changes))) == expected
