"""The capture file: what it may say, and what it must not."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from precompute.acquisition.capture import Capture, read_capture
from precompute.errors import InputError

FLASH: dict[str, Any] = {
    "format": "capture",
    "version": 1,
    "method": "flash",
    "sample": {
        "size_mm": [297, 210],
        "tile_mm": [40, 30],
        "reference_tile_px": [[10, 10], [50, 12], [52, 42], [9, 40]],
        "stochastic": False,
    },
    "camera": {
        "position_mm": [10, -20, 500],
        "rotation_deg": [1, 2, 3],
        "focal_px": 4200,
        "principal_point_px": [1999.5, 1499.5],
        "distortion": [0.1, -0.02, 0.001, 0.002, 0.003],
        "channels": "rgb",
        "response": "srgb",
        "black": 256,
        "white": 65535,
        "spectral_response_csv": "camera.csv",
    },
    "photographs": [
        {
            "file": "flash-0.exr",
            "exposure_s": 0.02,
            "corners_px": [[0, 0], [100, 0], [100, 80], [0, 80]],
            "light": {"position_mm": [30, 20, 200], "radius_deg": 0.7, "spectrum": "A"},
            "filter": {"peak_um": 0.53, "fwhm_um": 0.03},
        },
        {
            "brackets": [
                {"file": "a.tif", "exposure_s": 0.01},
                {"file": "b.tif", "exposure_s": 0.1},
            ],
            "light": {"position_mm": [30, 20, 200], "spectrum": "lamp.csv"},
        },
    ],
}
POLARIZATION: dict[str, Any] = {
    "method": "polarization",
    "sample": {"size_mm": [100, 80]},
    "photographs": [{"file": "a.tif", "polariser_deg": 15}, {"file": "b.tif", "polariser_deg": 0}],
}


def read(folder: Path, fields: dict[str, Any], method: Any = "flash") -> Capture:
    file = folder / "capture.json"
    file.write_text(json.dumps(fields))
    return read_capture(file, method)


def with_change(path: str, value: object) -> dict[str, Any]:
    """The flash capture with the field at a dotted path set; None removes it."""
    fields = copy.deepcopy(FLASH)
    *parents, last = path.split(".")
    part: Any = fields
    for name in parents:
        part = part[int(name)] if isinstance(part, list) else part[name]
    if value is None:
        del part[last]
    else:
        part[last] = value
    return fields


def test_all_that_it_may_say_is_read_and_written_again(tmp_path: Path) -> None:
    capture = read(tmp_path, FLASH)
    assert capture.camera.distortion == (0.1, -0.02, 0.001, 0.002, 0.003)
    assert [photograph.name for photograph in capture.photographs] == ["flash-0.exr", "a.tif"]
    capture.write(tmp_path / "again.json")
    assert read_capture(tmp_path / "again.json", "flash") == capture
    written = json.loads((tmp_path / "again.json").read_text())
    assert written["sample"] == FLASH["sample"] and written["camera"] == FLASH["camera"]
    assert written["photographs"][0] == FLASH["photographs"][0]
    assert "file" not in written["photographs"][1]  # what is unknown is left out


def test_what_may_be_left_out(tmp_path: Path) -> None:
    capture = read(
        tmp_path,
        {
            "method": "flash",
            "sample": {"size_mm": [100, 80]},
            "photographs": [{"file": "a.tif", "light": {"position_mm": [0, 0, 100]}}],
        },
    )
    assert capture.camera.position_mm is None and capture.camera.distortion == (0,) * 5
    assert (capture.camera.channels, capture.camera.response) == ("rgb", "linear")
    assert capture.photographs[0].corners_px is None
    assert read(tmp_path, POLARIZATION, "polarization").photographs[0].polariser_deg == 15


@pytest.mark.parametrize(
    ("path", "value", "said"),
    [
        ("colour", 1, "colour"),
        ("sample.width", 1, "sample.width"),
        ("camera.fokal_px", 1, "camera.fokal_px"),
        ("photographs.0.light.power", 1, "photographs.0.light.power"),
        ("photographs.1.brackets.1.iso", 1, "photographs.1.brackets.1.iso"),
        ("version", 2, "version"),
        ("format", "map", "format"),
        ("method", None, "method"),
        ("sample.size_mm", [297, 0], "size_mm"),
        ("sample.tile_mm", [40, -1], "tile_mm"),
        ("camera.position_mm", [0, 0, 0], "its z above 0"),
        ("camera.position_mm", [0, 0, -500], "its z above 0"),
        ("photographs.0.light.position_mm", [0, 0, -1], "its z above 0"),
        ("photographs.0.light.radius_deg", 0, "radius_deg"),
        ("photographs.0.light.radius_deg", 31, "radius_deg"),
        ("photographs.0.light.spectrum", "candle", "candle"),
        ("camera.focal_px", 0, "focal_px"),
        ("camera.distortion", [0.1, 0.2], "distortion"),
        ("camera.white", 256, "above black, 256"),
        ("camera.white", 100, "above black, 256"),
        ("camera.black", float("nan"), "black"),
        ("photographs.0.filter.peak_um", 530, "peak_um"),
        ("photographs.0.exposure_s", 0, "exposure_s"),
        ("photographs.0.file", None, "file or brackets"),
        ("photographs.1.file", "c.tif", "file or brackets"),
        ("photographs.1.exposure_s", 0.1, "the exposure of each bracket"),
        ("photographs.1.brackets", [], "brackets"),
        ("photographs.0.light", None, "photographs.0.light"),
        ("photographs.1.polariser_deg", 15, "photographs.1.polariser_deg"),
        ("photographs", [], "photographs"),
    ],
)
def test_what_it_must_not_say(tmp_path: Path, path: str, value: object, said: str) -> None:
    with pytest.raises(InputError) as caught:
        read(tmp_path, with_change(path, value))
    assert said in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("what", "change"),
    [
        ("counter-clockwise", lambda c: [c[0], c[3], c[2], c[1]]),
        ("crossing", lambda c: [c[0], c[2], c[1], c[3]]),
        ("two in one place", lambda c: [c[0], c[0], c[2], c[3]]),
        ("not convex", lambda c: [c[0], c[1], [30, 30], c[3]]),
        ("on a line", lambda c: [[0, 0], [10, 0], [20, 0], [30, 0]]),
        ("a corner on an edge", lambda c: [c[0], [50, 0], c[1], c[2]]),
        ("three", lambda c: c[:3]),
    ],
)
def test_corners_that_make_no_quadrilateral(
    tmp_path: Path, what: str, change: Callable[[list[list[float]]], list[list[float]]]
) -> None:
    corners = change([[0, 0], [100, 0], [100, 80], [0, 80]])
    for path in ("photographs.0.corners_px", "sample.reference_tile_px"):
        with pytest.raises(InputError) as caught:
            read(tmp_path, with_change(path, corners))
        assert path.split(".")[-1] in str(caught.value), what


def test_a_tilted_quadrilateral_may_begin_anywhere_but_goes_clockwise(tmp_path: Path) -> None:
    corners = [[0, 0], [100, 0], [100, 80], [0, 80]]
    turned = corners[2:] + corners[:2]  # the sample upside down in the picture
    assert read(tmp_path, with_change("photographs.0.corners_px", turned))


def test_a_capture_of_the_other_method(tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        read(tmp_path, FLASH, "polarization")
    assert (caught.value.field, caught.value.value) == ("method", "flash")
    both = copy.deepcopy(POLARIZATION)
    both["photographs"][1]["light"] = {"position_mm": [0, 0, 100]}
    with pytest.raises(InputError, match=r"photographs\.1\.light"):
        read(tmp_path, both, "polarization")
    del both["photographs"][1]["light"], both["photographs"][0]["polariser_deg"]
    with pytest.raises(InputError, match=r"photographs\.0\.polariser_deg"):
        read(tmp_path, both, "polarization")
