"""Photographs: files read as linear light, and exposures merged."""

from __future__ import annotations

import tracemalloc
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import tifffile
from PIL import Image
from PIL.TiffImagePlugin import IFDRational, ImageFileDirectory_v2
from refusals import refused

from precompute.acquisition.capture import Bracket, Camera, Capture, FlashLight, Photograph, Sample
from precompute.acquisition.image_files import read_image
from precompute.acquisition.photographs import (
    Photo,
    dark_noise,
    read_photograph,
    read_photographs,
    write_photograph,
)
from precompute.errors import InputError
from precompute.images import write_exr

LIGHT = FlashLight(position_mm=(30, 20, 200))
RGB, GREY = Camera(), Camera(channels="grey")
SRGB = Camera(response="srgb")
EXIF_IFD, EXPOSURE_TIME, FOCAL_LENGTH_35MM = 34665, 33434, 41989


def ramp(channels: int = 3, height: int = 40, width: int = 50) -> np.ndarray:
    """Light from 0 to 1, other in every channel, shape (height, width, channels)."""
    along = np.linspace(0, 1, width * height).reshape(height, width)
    return np.stack([along, along**2, 1 - along], axis=-1)[..., :channels]


def srgb_light(code: np.ndarray) -> np.ndarray:
    """IEC 61966-2-1, from codes 0 to 1."""
    return np.where(code <= 0.04045, code / 12.92, ((np.maximum(code, 0) + 0.055) / 1.055) ** 2.4)


def read(folder: Path, name: str, camera: Camera = RGB, exposure_s: float | None = None) -> Photo:
    photograph = Photograph(file=name, exposure_s=exposure_s, light=LIGHT)
    return read_photograph(photograph, camera, folder)


def merged(folder: Path, exposures: dict[str, float], camera: Camera = RGB) -> Photo:
    brackets = tuple(Bracket(file=name, exposure_s=t) for name, t in exposures.items())
    return read_photograph(Photograph(brackets=brackets, light=LIGHT), camera, folder)


# ---- Files ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("channels", [1, 3])
@pytest.mark.parametrize(
    ("name", "bits", "kind"),
    [
        ("a.tif", 8, "8-bit TIFF"),
        ("a.tif", 12, "16-bit TIFF"),
        ("a.TIFF", 16, "16-bit TIFF"),
        ("a.png", 8, "8-bit PNG"),
        ("a.png", 12, "16-bit PNG"),
        ("a.png", 16, "16-bit PNG"),
    ],
)
def test_what_is_written_is_read_to_half_a_step(
    tmp_path: Path, name: str, bits: int, kind: str, channels: int
) -> None:
    values, black = ramp(channels), 2 ** (bits - 4)
    camera = Camera(channels="rgb" if channels == 3 else "grey", black=black, white=2.0**bits - 1)
    write_photograph(tmp_path / name, values, bits, camera, 1 / 60)
    image = read_image(tmp_path / name, camera)
    assert (image.kind, image.size) == (kind, (50, 40))
    assert image.exposure_s == pytest.approx(1 / 60, rel=1e-6)
    step = 1 / (2**bits - 1 - black)
    assert image.step == pytest.approx(step)
    found = image.linear()
    assert found.dtype == np.float32
    # float32 itself rounds by 6e-8.
    assert np.abs(found - values).max() <= step / 2 + 2e-7
    assert np.array_equal(image.linear(slice(7, 9)), found[7:9])
    assert [f.name for f in tmp_path.iterdir()] == [name]


@pytest.mark.parametrize(("bits", "tolerance"), [(16, 2**-11), (32, 2**-24)])
def test_exr_is_taken_as_it_is(tmp_path: Path, bits: int, tolerance: float) -> None:
    values = 40 * ramp() - 0.1
    write_exr(tmp_path / "a.exr", values.astype(np.float16 if bits == 16 else np.float32))
    found = read_image(tmp_path / "a.exr", RGB).linear()
    assert np.abs(found - values).max() <= 40 * tolerance
    photo = read(tmp_path, "a.exr")
    assert np.array_equal(photo.values, found)
    assert not photo.saturated.any()
    clipped = read(tmp_path, "a.exr", Camera(white=39))
    np.testing.assert_allclose(clipped.values, np.minimum(found / 39, 1), rtol=1e-6)
    assert np.array_equal(clipped.saturated, (found >= 0.98 * 39).any(axis=-1))


def test_numbers_below_black_stay_below(tmp_path: Path) -> None:
    camera = Camera(black=1000)
    write_photograph(tmp_path / "a.tif", ramp() - 0.01, 16, camera)
    found = read_image(tmp_path / "a.tif", camera).linear()
    assert found.min() == pytest.approx(-0.01, abs=1e-5)


@pytest.mark.parametrize("camera", [Camera(black=0.25), Camera(black=0.25, white=2)])
def test_exr_is_written_with_the_levels_and_not_cut_off(tmp_path: Path, camera: Camera) -> None:
    values = 0.9 * ramp() - 0.1
    write_photograph(tmp_path / "a.exr", values, 16, camera)
    np.testing.assert_allclose(read_image(tmp_path / "a.exr", camera).linear(), values, atol=2e-7)
    write_photograph(tmp_path / "b.exr", 1e5 * ramp(), 16, RGB)
    assert read_image(tmp_path / "b.exr", RGB).linear().max() == 1e5


def test_srgb_is_written_and_read_to_half_a_code(tmp_path: Path) -> None:
    values, camera = ramp(), Camera(response="srgb", black=16, white=235)
    write_photograph(tmp_path / "a.png", values, 8, camera)
    found = read_image(tmp_path / "a.png", camera).linear()
    # The curve is steepest at its end: a slope of 2.4 / 1.055.
    assert np.abs(found - values).max() <= 0.5 / (235 - 16) * 2.4 / 1.055


def test_float_and_compressed_tiff(tmp_path: Path) -> None:
    values = ramp().astype(np.float32)
    tifffile.imwrite(tmp_path / "a.tif", 3 * values, photometric="rgb", compression="zlib")
    image = read_image(tmp_path / "a.tif", RGB)
    assert image.kind == "float TIFF"
    assert np.array_equal(image.linear(), 3 * values)
    numbers = np.rint(values * 65535).astype(np.uint16)
    lzw = [cv2.IMWRITE_TIFF_COMPRESSION, 5]
    cv2.imwrite(str(tmp_path / "b.tif"), np.ascontiguousarray(numbers[..., ::-1]), lzw)
    assert np.array_equal(read_image(tmp_path / "b.tif", RGB).numbers, numbers)


def test_every_srgb_code(tmp_path: Path) -> None:
    codes = np.arange(256, dtype=np.uint8).reshape(16, 16)
    Image.fromarray(codes).save(tmp_path / "a.png")
    camera = Camera(channels="grey", response="srgb")
    found = read_image(tmp_path / "a.png", camera).linear()[..., 0]
    np.testing.assert_allclose(found, srgb_light(codes / 255), atol=1e-7)
    levels = Camera(channels="grey", response="srgb", black=16, white=235)
    found = read_image(tmp_path / "a.png", levels).linear()[..., 0]
    share = np.minimum((codes - 16.0) / (235 - 16), 1)
    np.testing.assert_allclose(found, srgb_light(share), atol=1e-7)


def test_jpeg_of_flat_colours(tmp_path: Path) -> None:
    codes = np.zeros((32, 32, 3), np.uint8)
    codes[:16], codes[16:] = (200, 120, 60), (30, 90, 180)
    Image.fromarray(codes).save(tmp_path / "a.jpg", quality=98, subsampling=0)
    image = read_image(tmp_path / "a.jpg", SRGB)
    assert image.kind == "8-bit JPEG"
    # JPEG may be a code or two off.
    assert np.all(image.linear() >= srgb_light((codes - 2.0) / 255))
    assert np.all(image.linear() <= srgb_light((codes + 2.0) / 255))
    with refused(tmp_path / "a.jpg", "camera.response", None, "srgb or linear"):
        read_image(tmp_path / "a.jpg", RGB)


def write_dng(file: Path, mosaic: np.ndarray, black: tuple[int, ...], white: int) -> None:
    """A camera raw file of the pattern R G / G B, with a black level for each of its places."""
    tags: list[tuple[Any, ...]] = [
        (33421, "H", 2, (2, 2), True),  # CFARepeatPatternDim
        (33422, "B", 4, (0, 1, 1, 2), True),  # CFAPattern
        (EXPOSURE_TIME, "2I", 1, (1, 50), True),
        (FOCAL_LENGTH_35MM, "H", 1, (26,), True),
        (50706, "B", 4, (1, 4, 0, 0), True),  # DNGVersion
        (50707, "B", 4, (1, 1, 0, 0), True),  # DNGBackwardVersion
        (50708, "s", 0, "Camera of a test", True),  # UniqueCameraModel
        (50713, "H", 2, (2, 2), True),  # BlackLevelRepeatDim
        (50714, "H", 4, black, True),  # BlackLevel
        (50717, "H", 1, (white,), True),  # WhiteLevel
        (50721, "2i", 9, (1, 1, 0, 1, 0, 1, 0, 1, 1, 1, 0, 1, 0, 1, 0, 1, 1, 1), True),  # XYZ
        (50728, "2I", 3, (1, 2, 1, 1, 2, 3), True),  # AsShotNeutral, which is not to be applied
        (274, "H", 1, (6,), True),  # Orientation, which is not to be applied
    ]
    tifffile.imwrite(file, mosaic, photometric=32803, extratags=tags, metadata=None)


def test_camera_raw_gives_the_light_of_the_sensor(tmp_path: Path) -> None:
    black, white = (500, 508, 516, 530), 16383
    light = np.empty((120, 160, 3))
    light[:60, :80], light[:60, 80:] = (0.5, 0.25, 0.125), (0.1, 0.9, 0.6)
    light[60:, :80], light[60:, 80:] = 0, 1.2
    mosaic = np.empty(light.shape[:2])
    for place, channel in enumerate((0, 1, 1, 2)):
        at = np.s_[place // 2 :: 2, place % 2 :: 2]
        mosaic[at] = black[place] + light[at][..., channel] * (white - black[place])
    noise = np.random.default_rng(1).normal(0, 20, mosaic.shape)
    mosaic[60:, :80] += noise[60:, :80]
    write_dng(
        tmp_path / "a.dng", np.clip(np.rint(mosaic), 0, white).astype(np.uint16), black, white
    )

    image = read_image(tmp_path / "a.dng", RGB)
    assert (image.kind, image.size) == ("camera raw", (160, 120))
    assert image.exposure_s == pytest.approx(1 / 50)
    assert image.focal_px == pytest.approx(26 / np.hypot(36, 24) * np.hypot(160, 120))
    found = image.linear()
    # One step of the sensor; the greens' levels differ by 8, which interpolation leaves to the
    # pixel: half of that.
    tolerance = np.array([1.5, 5, 1.5]) / (white - 530)
    for rows, columns in (((4, 56), (4, 76)), ((4, 56), (84, 156)), ((64, 116), (84, 156))):
        patch = np.s_[rows[0] : rows[1], columns[0] : columns[1]]
        assert np.all(np.abs(found[patch] - np.minimum(light[patch], 1)) <= tolerance)
    dark = found[64:116, 4:76]
    # Noise is not cut off at 0: the mean stays there, and a half is below.
    assert np.all(
        np.abs(dark.mean(axis=(0, 1))) < 4 * 20 / (white - 530) / np.sqrt(dark[..., 0].size / 4)
    )
    assert 0.4 < np.mean(dark < 0) < 0.6
    with refused(tmp_path / "a.dng", "camera.white", 16383.0, "its own black and white"):
        read_image(tmp_path / "a.dng", Camera(white=16383))
    with refused(tmp_path / "a.dng", "camera.response", "srgb", "linear: camera raw"):
        read_image(tmp_path / "a.dng", SRGB)


def test_camera_raw_has_the_white_of_the_sensor_not_of_the_picture(tmp_path: Path) -> None:
    mosaic = np.full((40, 60), 64 + 8 * 400, np.uint16)
    write_dng(tmp_path / "a.dng", mosaic, (64, 64, 64, 64), 4064)
    found = read_image(tmp_path / "a.dng", RGB).linear()
    np.testing.assert_allclose(found[4:-4, 4:-4], 0.8, atol=1 / 4000)


@pytest.mark.parametrize("channels", [1, 3])
def test_camera_raw_without_a_pattern(tmp_path: Path, channels: int) -> None:
    numbers = np.rint(64 + 4000 * ramp(channels)).astype(np.uint16)
    tags: list[tuple[Any, ...]] = [
        (50706, "B", 4, (1, 4, 0, 0), True),
        (50708, "s", 0, "Camera of a test", True),
        (50714, "H", channels, (64,) * channels, True),
        (50717, "H", channels, (4064,) * channels, True),
        (50721, "2i", 9, (1, 1, 0, 1, 0, 1, 0, 1, 1, 1, 0, 1, 0, 1, 0, 1, 1, 1), True),
    ]
    file = tmp_path / "a.dng"
    pixels = numbers if channels == 3 else numbers[..., 0]
    kind = "rgb" if channels == 3 else "minisblack"
    tifffile.imwrite(file, pixels, photometric=kind, extratags=tags, metadata=None)
    with tifffile.TiffFile(file, mode="r+") as tiff:
        tiff.pages.first.tags[262].overwrite(34892)  # PhotometricInterpretation: LinearRaw
    image = read_image(file, RGB if channels == 3 else GREY)
    np.testing.assert_allclose(image.linear(), ramp(channels), atol=1 / 4000)


# ---- What files note -----------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["a.jpg", "a.png", "a.tif"])
def test_exposure_and_focal_length_come_from_exif_unless_the_capture_tells_them(
    tmp_path: Path, name: str
) -> None:
    noted: dict[int, Any] = {EXPOSURE_TIME: IFDRational(1, 250), FOCAL_LENGTH_35MM: 26}
    exif, directory = Image.Exif(), ImageFileDirectory_v2()
    exif[271] = "Maker"
    exif.get_ifd(EXIF_IFD).update(noted)
    directory[EXIF_IFD] = noted
    options: dict[str, Any] = {"tiffinfo": directory} if name == "a.tif" else {"exif": exif}
    Image.fromarray(np.full((300, 400, 3), 128, np.uint8)).save(tmp_path / name, **options)
    photo = read(tmp_path, name, SRGB)
    assert photo.exposure_s == pytest.approx(1 / 250)
    # 26 mm on a diagonal of 43.27 mm, 500 pixels.
    assert photo.focal_px == pytest.approx(26 / 43.26661530556787 * 500)
    assert (photo.sources[0].exposure_from, photo.focal_from) == ("file", "file")
    assert photo.values[150, 200, 1] == pytest.approx(
        250 * srgb_light(np.array(128 / 255)), rel=1e-6
    )

    told = read(tmp_path, name, Camera(response="srgb", focal_px=333), exposure_s=0.5)
    assert (told.exposure_s, told.focal_px) == (0.5, 333)
    assert (told.sources[0].exposure_from, told.focal_from) == ("capture", "capture")
    assert told.sources[0].noted_exposure_s == pytest.approx(1 / 250)


def test_what_nobody_tells_is_said_so(tmp_path: Path) -> None:
    write_photograph(tmp_path / "a.png", ramp(), 16, RGB)
    photo = read(tmp_path, "a.png")
    assert (photo.exposure_s, photo.sources[0].exposure_from) == (1.0, "nobody")
    assert (photo.focal_px, photo.focal_from) == (None, "nobody")


# ---- Merging -------------------------------------------------------------------------------------

# A sensor's variance is SHOT · light + READ², in full scales: 40 dB at full scale.
SHOT, READ = 1e-4, 1e-3
CAMERA = Camera(black=1024)


def shoot(file: Path, radiance: np.ndarray, exposure_s: float, seed: int | None) -> None:
    """A 16-bit TIFF of what a sensor sees, with noise unless `seed` is None."""
    light = radiance * exposure_s
    if seed is not None:
        noise = np.random.default_rng(seed).normal(size=light.shape)
        light = light + np.sqrt(SHOT * light + READ**2) * noise
    write_photograph(file, light, 16, CAMERA, exposure_s)


EXPOSURES = {"a.tif": 0.16, "c.tif": 0.01, "b.tif": 0.04}


def test_without_noise_the_merge_is_the_radiance(tmp_path: Path) -> None:
    radiance = 120 * ramp(3, 120, 150) ** 2
    for name, exposure_s in EXPOSURES.items():
        shoot(tmp_path / name, radiance, exposure_s, None)
    photo = merged(tmp_path, EXPOSURES, CAMERA)
    assert [source.file for source in photo.sources] == ["c.tif", "b.tif", "a.tif"]
    assert photo.exposure_s == 0.01
    # Exactly where any channel reaches 0.98 in 0.01 s, but for rounding at the edge.
    expected = (radiance * 0.01 >= 0.98).any(axis=-1)
    assert 0.02 < expected.mean() < 0.5
    assert np.array_equal(photo.saturated, expected)
    clear = ~photo.saturated
    # Rounding: half a step of 1 / 64511 in the shortest exposure.
    assert np.abs(photo.values - radiance)[clear].max() <= 100 * 0.5 / 64511 + 1e-4
    assert photo.values.max() == pytest.approx(100)
    for source in photo.sources[1:]:
        assert source.agreement == pytest.approx(1, abs=1e-3)


def test_noise_falls_as_theory_has_it_and_the_mean_stays(tmp_path: Path) -> None:
    # In 0.01, 0.04 and 0.16 s: dark, bright in the last, clipped in it, and clipped in two.
    radiances = np.array([0.0, 4.0, 20.0, 80.0])
    radiance = np.repeat(np.repeat(radiances, 100)[None, :, None], 240, axis=0)
    radiance = np.broadcast_to(radiance, (240, 400, 3))
    for seed, (name, exposure_s) in enumerate(EXPOSURES.items()):
        shoot(tmp_path / name, radiance, exposure_s, seed)
    photo = merged(tmp_path, EXPOSURES, CAMERA)
    times = np.array(sorted(EXPOSURES.values()))
    for index, truth in enumerate(radiances):
        values = photo.values[:, 100 * index : 100 * index + 100].astype(float)
        used = times[truth * times < 0.98]
        # Of x / t in each exposure; of its mean with weights t^1.5; of the best mean there is.
        variances = (SHOT * truth * used + READ**2) / used**2
        expected = np.sqrt(np.sum(used**3 * variances)) / np.sum(used**1.5)
        least = 1 / np.sqrt(np.sum(1 / variances))
        assert expected < 1.04 * least
        spread = np.std(values - truth)
        # 72 000 samples give a standard deviation to 0.26 %.
        assert spread == pytest.approx(expected, rel=0.01), truth
        assert np.mean(values) == pytest.approx(truth, abs=4 * expected / np.sqrt(values.size))
        # In the dark the longest exposure alone is as good; in light the merge is better than any.
        assert spread < (1.01 if truth == 0 else 0.97) * np.sqrt(variances.min()) or len(used) == 1
    dark = READ * np.sqrt(times.sum()) / np.sum(times**1.5)
    assert photo.noise == pytest.approx(dark, rel=0.05)


def test_next_to_clipping_noise_hardly_bends_the_mean(tmp_path: Path) -> None:
    # Light in the second exposure from 0.7 to 1.1 of full scale.
    truth = np.linspace(17.5, 27.5, 40)
    radiance = np.broadcast_to(np.repeat(truth, 20)[None, :, None], (500, 800, 3))
    exposures = {"a.tif": 0.01, "b.tif": 0.04}
    for seed, (name, exposure_s) in enumerate(exposures.items()):
        shoot(tmp_path / name, radiance, exposure_s, seed)
    photo = merged(tmp_path, exposures, CAMERA)
    means = photo.values.reshape(500, 40, 20, 3).mean(axis=(0, 2, 3), dtype=float)
    # A mean of 30 000 samples is good to 0.02 %; an edge at 0.98 would bend it by 0.3 %.
    assert np.abs(means / truth - 1).max() < 2e-3


def test_memory_does_not_grow_with_the_exposures(tmp_path: Path) -> None:
    radiance = 20 * ramp(3, 500, 1000)
    names = {f"{i}.tif": 0.01 * 2**i for i in range(5)}
    for name, exposure_s in names.items():
        shoot(tmp_path / name, radiance, exposure_s, None)

    def peak(exposures: dict[str, float]) -> int:
        tracemalloc.start()
        try:
            merged(tmp_path, exposures, CAMERA)
            return tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()

    two = peak({name: names[name] for name in ("0.tif", "1.tif")})
    assert peak(names) < 1.1 * two
    # Sums and times 12 bytes a pixel each, one file of 6 twice, masks; blocks take a few MB.
    assert two < 45 * radiance[..., 0].size + 8e6


@pytest.mark.parametrize("bits", [8, 16])
def test_noise_is_never_less_than_rounding(tmp_path: Path, bits: int) -> None:
    write_photograph(tmp_path / "a.tif", np.full((64, 64, 3), 0.25), bits, RGB)
    rounding = 1 / (2**bits - 1) / np.sqrt(12)
    photo = read(tmp_path, "a.tif", exposure_s=0.5)
    assert photo.noise == pytest.approx(rounding / 0.5)
    write_photograph(tmp_path / "b.tif", np.full((64, 64, 3), 0.5), bits, RGB)
    photo = merged(tmp_path, {"a.tif": 0.5, "b.tif": 1})
    assert photo.noise == pytest.approx(np.sqrt(1.5) * rounding / (0.5**1.5 + 1))


def test_dark_noise_is_that_of_the_dark_under_a_slope() -> None:
    random = np.random.default_rng(5)
    picture = np.linspace(0, 3, 640)[None, :, None] + 0.02 * random.normal(size=(320, 640, 3))
    picture[:, 200:] += 0.3 * random.normal(size=(320, 440, 3))
    picture[100:110, 5:9] = 7
    assert dark_noise(picture.astype(np.float32)) == pytest.approx(0.02, rel=0.05)


# ---- Refusals ------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["a.tif", "a.png", "a.jpg", "a.exr", "a.dng", "a.txt"])
@pytest.mark.parametrize("damage", ["missing", "empty", "text", "half"])
def test_unreadable_files_are_refused(tmp_path: Path, name: str, damage: str) -> None:
    file = tmp_path / name
    numbers = np.random.default_rng(1).integers(0, 4096, (64, 64), dtype=np.uint16)
    if damage == "half" and name == "a.dng":
        write_dng(file, numbers, (0, 0, 0, 0), 4095)
    elif damage == "half" and name == "a.jpg":
        Image.fromarray((numbers >> 4).astype(np.uint8)).save(file)
    elif damage == "half" and name != "a.txt":
        write_photograph(file, np.repeat(numbers[..., None], 3, axis=-1) / 4096, 16, RGB)
    elif damage != "missing":
        file.write_text("" if damage == "empty" else "no picture at all")
    if damage == "half" and file.exists():
        file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    with pytest.raises(InputError) as caught:
        read_image(file, SRGB if name == "a.jpg" else RGB)
    assert (caught.value.file, caught.value.field) == (str(file), "contents")
    assert caught.value.value


def test_channels_that_the_camera_has_not_are_refused(tmp_path: Path) -> None:
    write_photograph(tmp_path / "a.tif", ramp(3), 16, RGB)
    with refused(tmp_path / "a.tif", "channels", 3, "camera.channels is grey"):
        read_image(tmp_path / "a.tif", GREY)
    write_photograph(tmp_path / "b.png", ramp(1), 16, RGB)
    with refused(tmp_path / "b.png", "channels", 1, "camera.channels is rgb"):
        read_image(tmp_path / "b.png", RGB)
    write_exr(tmp_path / "c.exr", np.ones((20, 20, 4), np.float32))
    with refused(tmp_path / "c.exr", "channels", 4, "camera.channels is rgb"):
        read_image(tmp_path / "c.exr", RGB)


@pytest.mark.parametrize("mode", ["RGBA", "LA", "P"])
def test_png_with_alpha_or_palette_is_refused(tmp_path: Path, mode: str) -> None:
    Image.new(mode, (20, 20)).save(tmp_path / "a.png")
    with refused(tmp_path / "a.png", "colours", mode, "no palette, no alpha"):
        read_image(tmp_path / "a.png", RGB)


def test_jpeg_for_print_is_refused(tmp_path: Path) -> None:
    Image.new("CMYK", (20, 20)).save(tmp_path / "a.jpg")
    with refused(tmp_path / "a.jpg", "colours", "CMYK", "RGB or grey"):
        read_image(tmp_path / "a.jpg", SRGB)


@pytest.mark.parametrize(
    ("options", "dtype", "field", "value", "expected"),
    [
        ({"photometric": "miniswhite"}, np.uint8, "PhotometricInterpretation", 0, "1 (grey"),
        ({"photometric": "minisblack"}, np.int16, "type", "16 bits, int16", "unsigned"),
        ({"photometric": "minisblack"}, np.float64, "type", "64 bits, float64", "32 bits, float"),
    ],
)
def test_tiff_of_other_kinds_is_refused(
    tmp_path: Path, options: dict[str, Any], dtype: type, field: str, value: object, expected: str
) -> None:
    tifffile.imwrite(tmp_path / "a.tif", np.ones((20, 20), dtype), **options)
    with refused(tmp_path / "a.tif", field, value, expected):
        read_image(tmp_path / "a.tif", GREY)


def test_tiff_of_planes_or_pages_is_refused(tmp_path: Path) -> None:
    planes = np.ones((3, 20, 20), np.uint16)
    tifffile.imwrite(tmp_path / "a.tif", planes, photometric="rgb", planarconfig="separate")
    with refused(tmp_path / "a.tif", "PlanarConfiguration", 2, "1 (channels beside each other)"):
        read_image(tmp_path / "a.tif", RGB)
    tifffile.imwrite(tmp_path / "b.tif", planes, photometric="minisblack")
    with refused(tmp_path / "b.tif", "pages", 3, "one picture"):
        read_image(tmp_path / "b.tif", GREY)


@pytest.mark.parametrize("odd", [np.nan, np.inf, -np.inf])
def test_numbers_that_are_not_finite_are_counted(tmp_path: Path, odd: float) -> None:
    values = ramp()
    values[3, 4:6, 1] = odd
    write_photograph(tmp_path / "a.exr", values, 32, RGB)
    with refused(tmp_path / "a.exr", "numbers", "2 not finite", "all finite"):
        read_image(tmp_path / "a.exr", RGB)


def test_light_far_below_none_is_refused(tmp_path: Path) -> None:
    write_photograph(tmp_path / "a.exr", 4 * ramp() - 0.5, 32, RGB)
    assert read_image(tmp_path / "a.exr", RGB).linear().min() == -0.5
    write_photograph(tmp_path / "b.exr", 4 * ramp() - 1.5, 32, RGB)
    with refused(tmp_path / "b.exr", "numbers", "-1.5 to 2.5 over black", "0 and more"):
        read_image(tmp_path / "b.exr", RGB)


def test_levels_and_responses_that_the_file_cannot_have_are_refused(tmp_path: Path) -> None:
    write_photograph(tmp_path / "a.png", ramp(), 8, RGB)
    file = tmp_path / "a.png"
    with refused(file, "camera.white", 4095.0, "0 to 255"):
        read_image(file, Camera(white=4095))
    with refused(file, "camera.black", 300.0, "0 to 255"):
        read_image(file, Camera(black=300))
    with refused(file, "camera.black", 255.0, "below 255"):
        read_image(file, Camera(black=255))
    write_photograph(tmp_path / "b.png", 0.1 * ramp(), 8, RGB)
    with refused(tmp_path / "b.png", "camera.black", "100, above 100 % of the numbers", "no light"):
        read_image(tmp_path / "b.png", Camera(black=100))
    write_photograph(tmp_path / "a.exr", ramp(), 16, RGB)
    with refused(tmp_path / "a.exr", "camera.response", "srgb", "linear: EXR"):
        read_image(tmp_path / "a.exr", SRGB)


def test_small_black_and_clipped_pictures_are_refused(tmp_path: Path) -> None:
    write_photograph(tmp_path / "small.tif", ramp(3, 15, 90), 16, RGB)
    with refused(tmp_path / "small.tif", "size", "90 × 15", "16 × 16 pixels or more"):
        read(tmp_path, "small.tif")
    write_photograph(tmp_path / "black.tif", np.zeros((20, 20, 3)), 16, RGB)
    with refused(tmp_path / "black.tif", "numbers", "all black", "some light"):
        read(tmp_path, "black.tif")
    write_photograph(tmp_path / "white.tif", np.ones((20, 20, 3)), 16, RGB)
    with refused(tmp_path / "white.tif", "numbers", "all clipped", "short enough"):
        read(tmp_path, "white.tif")


def test_a_bracket_of_another_exposure_than_told_is_refused(tmp_path: Path) -> None:
    for name, exposure_s in EXPOSURES.items():
        shoot(tmp_path / name, 20 * ramp(), exposure_s, 1)
    # b.tif was 0.04 s, which is 0.4 of what is told of it.
    with refused(tmp_path / "b.tif", "exposure_s", 0.1, "about 0.04, going by the light of c.tif"):
        merged(tmp_path, EXPOSURES | {"b.tif": 0.1}, CAMERA)
    # The shortest and the longest, taken for each other.
    with pytest.raises(InputError, match="exposure_s"):
        merged(tmp_path, {"a.tif": 0.01, "b.tif": 0.04, "c.tif": 0.16}, CAMERA)
    # A small error is told, not refused.
    photo = merged(tmp_path, EXPOSURES | {"b.tif": 0.05}, CAMERA)
    assert photo.sources[1].agreement == pytest.approx(0.8, rel=0.01)


def test_sizes_that_differ_are_refused(tmp_path: Path) -> None:
    write_photograph(tmp_path / "a.tif", ramp(3, 40, 50), 16, RGB, 0.1)
    write_photograph(tmp_path / "b.tif", ramp(3, 50, 40), 16, RGB, 0.2)
    with refused(tmp_path / "b.tif", "size", "40 × 50", "50 × 40 pixels, as a.tif has"):
        merged(tmp_path, {"a.tif": 0.1, "b.tif": 0.2})
    with refused(tmp_path / "b.tif", "size", "40 × 50", "50 × 40 pixels, as a.tif has"):
        list(read_photographs(capture("a.tif", "b.tif"), tmp_path))


def test_exposures_known_of_some_only_are_refused(tmp_path: Path) -> None:
    write_photograph(tmp_path / "a.tif", ramp(), 16, RGB, 0.1)
    write_photograph(tmp_path / "b.tif", ramp(), 16, RGB)
    for names in (("a.tif", "b.tif"), ("b.tif", "a.tif")):
        with refused(tmp_path / "b.tif", "exposure_s", None, "as a.tif has one"):
            list(read_photographs(capture(*names), tmp_path))
    assert [p.name for p in read_photographs(capture("a.tif", "a.tif"), tmp_path)] == ["a.tif"] * 2


def capture(*names: str) -> Capture:
    photographs = tuple(Photograph(file=name, light=LIGHT) for name in names)
    return Capture(method="flash", sample=Sample(size_mm=(40, 30)), photographs=photographs)


@pytest.mark.parametrize(
    ("name", "bits", "camera", "field", "value", "expected"),
    [
        ("a.jpg", 8, RGB, "extension", ".jpg", ".tif"),
        ("a.tif", 10, RGB, "bits", 10, "12"),
        ("a.tif", 12, RGB, "camera.white", None, "4095"),
        ("a.png", 12, Camera(white=65535), "camera.white", 65535.0, "4095 at most"),
    ],
)
def test_what_cannot_be_written_is_refused(
    tmp_path: Path,
    name: str,
    bits: int,
    camera: Camera,
    field: str,
    value: object,
    expected: str,
) -> None:
    with refused(tmp_path / name, field, value, expected):
        write_photograph(tmp_path / name, ramp(), bits, camera)
    assert not list(tmp_path.iterdir())
