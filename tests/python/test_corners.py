"""The sample's corners: found where the camera projects them, refused where there is no sample."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from precompute.acquisition.capture import Camera
from precompute.acquisition.corners import find_corners
from precompute.acquisition.simulate import simulate_flash
from precompute.acquisition.view import View
from precompute.errors import InputError
from precompute.images import read_exr

SIZE_PX = (400, 300)
SIZE_MM = np.array([200.0, 150.0])


def camera(tilt=0.0, towards=0.0, focal=600.0, turn=None, lens=(0.0, 0.0, 0.0, 0.0, 0.0)):
    """A camera 500 mm away that looks at the sample, `tilt` degrees off its normal."""
    t, a = np.radians([tilt, towards])
    position = 500 * np.array([np.sin(t) * np.cos(a), np.sin(t) * np.sin(a), np.cos(t)])
    return Camera(
        position_mm=tuple(position.tolist()), rotation_deg=turn, focal_px=focal, distortion=lens
    )


def photograph(cam, table=0.3, lamp=(30.0, 20.0, 200.0), seed=0, share=0.06, size_px=SIZE_PX):
    """A picture of a sheet of squares, a share of them lit, and its true corners.

    16 rays a pixel, then a lens that blurs a little; the lamp is near, so the light is uneven.
    """
    view = View.of(cam, size_px)
    (width, height), steps = size_px, (np.arange(4) + 0.5) / 4 - 0.5
    x, y = np.meshgrid(
        *((np.arange(n)[:, None] + steps).ravel() for n in (width, height)), copy=False
    )
    points = view.on_sample(np.stack([x.ravel(), y.ravel()], axis=1))
    rng = np.random.default_rng(seed)
    # Squares of 5 mm, slanted, so that their edges are none of the sheet's.
    slanted = points @ np.array([[0.88, -0.475], [0.475, 0.88]]) / 5
    column, row = np.mod(np.floor(slanted), 80).astype(int).T
    shine = np.where(rng.random((80, 80)) < share, rng.uniform(0.1, 3, (80, 80)), 0)
    towards = np.array(lamp) - np.concatenate([points, np.zeros((len(points), 1))], axis=1)
    squared = np.sum(towards**2, axis=1)
    irradiance = lamp[2] / squared**1.5 * np.sum(np.square(lamp))
    mirror = np.sum((points - 0.7 * np.array(lamp[:2])) ** 2, axis=1)
    foil = (0.02 + shine[row, column]) * irradiance / np.pi + 50 * np.exp(-mirror / (2 * 4**2))
    on = np.all(np.abs(points) <= SIZE_MM / 2, axis=1)
    values = np.where(on, foil, table * irradiance / np.pi)
    values = values.reshape(height, 4, width, 4).mean(axis=(1, 3))
    values = cv2.GaussianBlur(values, (0, 0), 0.6)[..., None].astype(np.float32)
    corners = np.array([(-1, 1, 0), (1, 1, 0), (1, -1, 0), (-1, -1, 0)]) / 2
    return values, view.pixels(corners * [*SIZE_MM, 0])


def noisy(values, rng, deviation=0.1 * 10**-1.5):
    """Noise 30 dB below what a table under an even light shows."""
    return (values + deviation * rng.standard_normal(values.shape)).astype(np.float32)


def off(found, truth):
    """The largest distance of a corner from where it belongs, px."""
    return float(np.linalg.norm(np.array(found) - truth, axis=1).max())


CAMERAS = {
    "straight": camera(),
    "oblique to the right": camera(30, 20, 560),
    "oblique from above": camera(30, 100, 560),
    "turned back": camera(focal=480, turn=(0.0, 0.0, -40.0)),
    "barrel": camera(lens=(-0.2, 0.05, 0.0, 0.0, 0.0)),
    "pincushion, oblique": camera(15, 50, 560, lens=(0.15, -0.3, 0.001, 0.0, 0.0)),
}


@pytest.mark.parametrize("name", CAMERAS)
def test_corners_are_found_where_the_camera_sees_them(name):
    values, truth = photograph(CAMERAS[name])
    assert off(find_corners([values], name), truth) < 0.3
    rng = np.random.default_rng(1)
    assert off(find_corners([noisy(values, rng)], name), truth) < 1


@pytest.mark.parametrize("table", [0.008, 0.04, 1.0])
def test_what_the_sample_lies_on_may_be_darker_or_lighter(table):
    values, truth = photograph(camera(20, 200, 560), table)
    assert off(find_corners([values], "table"), truth) < 0.3


def test_a_lamp_near_a_corner_lights_the_table_unevenly():
    values, truth = photograph(camera(), lamp=(70.0, 50.0, 80.0))
    assert off(find_corners([values], "near"), truth) < 0.3


def test_pictures_of_one_camera_find_together_what_one_does_not_show():
    lamps = [(30.0, 20.0, 200.0), (-45.0, 10.0, 180.0), (10.0, -40.0, 220.0)]
    shown = [
        photograph(camera(10, 60), lamp=lamp, seed=seed, share=0.18)
        for seed, lamp in enumerate(lamps)
    ]
    truth = shown[0][1]
    together = find_corners([values for values, _ in shown], "three")
    assert off(together, truth) < 0.5
    with pytest.raises(InputError):
        find_corners([shown[1][0]], "one")


def test_the_reference_s_photograph_shows_its_corners(tmp_path):
    foil = {"kind": "foil", "design": "polygons", "size": 64}
    (tmp_path / "foil.json").write_text(json.dumps(foil))
    recipe = {
        "kind": "flash-capture",
        "foil": "foil.json",
        "surface": {"size_mm": [100, 75]},
        "camera": {
            "position_mm": [60, -40, 400],
            "focal_px": 720,
            "channels": "grey",
            "distortion": [-0.1, 0, 0, 0, 0],
        },
        "size_px": [240, 180],
        "photographs": [{"light": {"position_mm": [20, 10, 200]}, "exposures_s": [1.0]}],
        "sensor": {"file": "exr"},
        "step_nm": 20,
        "subpixels": 4,
    }
    (tmp_path / "small.json").write_text(json.dumps(recipe))
    capture: Path = simulate_flash(tmp_path / "small.json", tmp_path)
    said = json.loads(capture.read_text())["photographs"][0]
    values = read_exr(capture.parent / said["file"])
    values = values.reshape(*values.shape[:2], -1)
    assert off(find_corners([values], "small"), np.array(said["corners_px"])) < 0.3


def even(rng):
    return np.full((*SIZE_PX[::-1], 3), 0.2, np.float32)


def noise(rng):
    return noisy(even(rng), rng)


def disc(rng):
    y, x = np.mgrid[: SIZE_PX[1], : SIZE_PX[0]]
    return np.where(np.hypot(x - 200, y - 150) < 110, 0.02, 0.2)[..., None].astype(np.float32)


def small(rng):
    """One twentieth of the picture."""
    values = even(rng)
    values[100:170, 150:236] = 0.02
    return values


def band(rng):
    """Two edges from side to side."""
    values = even(rng)
    values[80:220] = 0.02
    return values


def scattered(rng):
    """Lit squares that fill the picture: the sheet's edges are outside."""
    values, _ = photograph(camera(focal=2000))
    return values


@pytest.mark.parametrize("picture", [even, noise, disc, small, band, scattered])
def test_what_shows_no_sample_is_refused(picture):
    values = picture(np.random.default_rng(3))
    with pytest.raises(InputError, match="four corners of a sample") as caught:
        find_corners([values], "flash-0.tif")
    assert caught.value.file == "flash-0.tif"
    assert caught.value.field == "corners_px"
