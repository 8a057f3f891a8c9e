"""The report's own arithmetic: rows, fronts, counts, comparisons and failures."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError
from rich.console import Console

from precompute.errors import InputError
from precompute.renderings import Rendering
from precompute.report import browser
from precompute.report.comparison import Comparison, compare
from precompute.report.furnace import measure_furnace
from precompute.report.measurements import MethodResult, SceneResult
from precompute.report.page import Bar, all_bars, index_page
from precompute.report.rows import Report, Row, mark_pareto
from precompute.report.run import SCENES, make_report
from precompute.report.scenes import Method, Scene, read_scenes
from precompute.report.shader_cost import (
    StaticCost,
    count_instructions,
    missing_packages,
    static_cost,
)
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
        *("stability", "left_out", "acquisition"),
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
        MethodResult(comparison, 100, None),
        MethodResult(comparison, 50, StaticCost(alu=1)),
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
