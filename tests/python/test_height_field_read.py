"""Height fields from files: every format gives the same patch, no bit is lost, nothing crashes."""

import struct
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from instrument_files import write_gwy, write_nid
from PIL import Image
from refusals import refused
from shared_data import SHARED, needs_shared_data

from precompute.errors import InputError
from precompute.height_fields.read import read_height_field
from precompute.images import write_exr

PITCH = (0.05, 0.04)
BYTES = np.array([[0, 51, 102], [255, 204, 153]], dtype=np.uint8)
WORDS = np.array([[0, 1, 258], [65535, 32768, 257]], dtype=np.uint16)
NUMBERS = np.array([[0.0, 0.25, -0.5], [1.0, 0.75, 3.0]])


def write_picture(file: Path, texels: np.ndarray) -> None:
    Image.fromarray(texels).save(file)


def write_palette(file: Path, texels: np.ndarray) -> None:
    """Indices whose palette runs backwards."""
    image = Image.fromarray(255 - texels, "P")
    image.putpalette([255 - i // 3 for i in range(768)])
    image.save(file)


def write_png_16(file: Path, colour_type: int, texels: np.ndarray) -> None:
    """A PNG of 16 bits a channel, texels of shape (rows, columns, channels)."""

    def chunk(name: bytes, data: bytes) -> bytes:
        return (
            struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
        )

    rows, columns = texels.shape[:2]
    header = struct.pack(">IIBBBBB", columns, rows, 16, colour_type, 0, 0, 0)
    lines = b"".join(b"\0" + row.astype(">u2").tobytes() for row in texels)
    parts = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b"")
    file.write_bytes(b"\x89PNG\r\n\x1a\n" + parts)


def write_csv(file: Path, numbers: np.ndarray) -> None:
    np.savetxt(file, numbers, delimiter=",")


def write_grey_exr(file: Path, numbers: np.ndarray) -> None:
    write_exr(file, np.repeat(numbers[..., None], 3, axis=-1))


FORMATS: list[tuple[str, Callable[[Path, np.ndarray], None], np.ndarray, float]] = [
    ("8.png", write_picture, BYTES, 255),
    ("8.bmp", write_picture, BYTES, 255),
    ("8.tif", write_picture, BYTES, 255),
    ("p.png", write_palette, BYTES, 255),
    ("p.bmp", write_palette, BYTES, 255),
    ("16.png", write_picture, WORDS, 65535),
    ("16.tiff", write_picture, WORDS, 65535),
    ("f.tif", write_picture, NUMBERS.astype(np.float32), 1),
    ("f.exr", write_grey_exr, NUMBERS, 1),
    ("f.npy", np.save, NUMBERS, 1),
    ("i.npy", np.save, WORDS, 1),
    ("f.csv", write_csv, NUMBERS, 1),
]


@pytest.mark.parametrize(("name", "write", "stored", "white"), FORMATS)
def test_each_format_gives_heights_with_the_top_row_last(
    tmp_path: Path,
    name: str,
    write: Callable[[Path, np.ndarray], None],
    stored: np.ndarray,
    white: float,
) -> None:
    write(tmp_path / name, stored)
    field = read_height_field(tmp_path / name, PITCH, 0.3)
    assert field.pitch == PITCH
    assert field.heights == pytest.approx(0.3 * stored[::-1].astype(float) / white, abs=1e-12)


def test_neighbouring_16_bit_levels_stay_apart(tmp_path: Path) -> None:
    """The last bits of 16, which reading as 8 would lose, are the relief."""
    levels = 32768 + np.arange(64, dtype=np.uint16).reshape(8, 8)
    for name in ("x.png", "x.tif"):
        write_picture(tmp_path / name, levels)
        found = read_height_field(tmp_path / name, PITCH, 65535.0).heights
        assert found == pytest.approx(levels[::-1].astype(float), abs=1e-9)


@pytest.mark.parametrize(("colour_type", "channels"), [(2, 3), (4, 2), (6, 4)])
def test_16_bit_colours_which_the_library_reads_as_8_are_refused(
    tmp_path: Path, colour_type: int, channels: int
) -> None:
    file = tmp_path / "x.png"
    write_png_16(file, colour_type, np.repeat(WORDS[..., None], channels, axis=-1))
    with refused(file, "bits", 16, "16 bits of grey alone"):
        read_height_field(file, PITCH, 1.0)


def test_white_is_zero_in_some_16_bit_tiffs(tmp_path: Path) -> None:
    file = tmp_path / "x.tif"
    Image.fromarray(WORDS).save(file, tiffinfo={262: 0})
    heights = read_height_field(file, PITCH, 65535.0).heights
    assert heights == pytest.approx(65535.0 - WORDS[::-1], abs=1e-9)


def test_grey_may_come_as_opaque_colours_and_nothing_else(tmp_path: Path) -> None:
    file = tmp_path / "x.png"
    rgba = np.repeat(BYTES[..., None], 4, axis=-1)
    rgba[..., 3] = 255
    write_picture(file, rgba)
    assert read_height_field(file, PITCH, 255.0).heights.tolist() == BYTES[::-1].tolist()
    rgba[0, 0, 3] = 7
    write_picture(file, rgba)
    with refused(file, "alpha", "1 see-through pixels", "opaque"):
        read_height_field(file, PITCH, 1.0)
    rgba[..., 3] = 255
    rgba[0, :2, 1] = 9
    write_picture(file, rgba)
    with refused(file, "colour", "2 coloured pixels", "grey"):
        read_height_field(file, PITCH, 1.0)
    Image.fromarray(rgba[..., :3]).convert("CMYK").save(tmp_path / "x.tif")
    with refused(tmp_path / "x.tif", "mode", "CMYK", "grey"):
        read_height_field(tmp_path / "x.tif", PITCH, 1.0)


def test_a_file_of_several_pictures_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "x.tif"
    Image.fromarray(BYTES).save(file, save_all=True, append_images=[Image.fromarray(BYTES)])
    with refused(file, "frames", 2, "one picture"):
        read_height_field(file, PITCH, 1.0)


@pytest.mark.parametrize(
    ("pitch", "height", "missing"),
    [(None, None, "pitch_um, height_um"), (PITCH, None, "height_um"), (None, 1.0, "pitch_um")],
)
@pytest.mark.parametrize("name", ["x.png", "x.npy"])
def test_a_missing_scale_is_named(
    tmp_path: Path, name: str, pitch: tuple[float, float] | None, height: float | None, missing: str
) -> None:
    file = tmp_path / name
    write_picture(file, BYTES) if name == "x.png" else np.save(file, NUMBERS)
    with refused(file, missing, None, "height_um, the height of white over black"):
        read_height_field(file, pitch, height)


@pytest.mark.parametrize("unit", ["m", "µm", "nm"])
def test_an_instruments_file_has_its_own_scale(tmp_path: Path, unit: str) -> None:
    """Its first line is the lowest; x and y differ; the unit is converted."""
    in_µm = {"m": 1e6, "µm": 1.0, "nm": 1e-3}[unit]
    shares = np.arange(-10, 10).reshape(4, 5) / 64
    file = tmp_path / "x.nid"
    write_nid(file, shares, (2.0 / in_µm, 0.8 / in_µm), 0.5 / in_µm, unit)
    field = read_height_field(file)
    assert field.heights == pytest.approx(shares * 0.5, abs=1e-12)
    assert field.pitch == pytest.approx((0.4, 0.2))
    assert read_height_field(file, channel="Scan (Down)").heights == pytest.approx(-field.heights)
    with refused(file, "channel", "Phase", "Scan (Up), Scan (Down)"):
        read_height_field(file, channel="Phase")
    with refused(file, "pitch_um", [PITCH], "a scale of its own"):
        read_height_field(file, PITCH)
    with refused(file, "pitch_um, height_um", [PITCH, 1.0], "a scale of its own"):
        read_height_field(file, PITCH, 1.0)


def test_a_gwyddion_file_has_its_top_row_first(tmp_path: Path) -> None:
    file = tmp_path / "x.gwy"
    write_gwy(file, NUMBERS * 1e-7, (3e-7, 1e-7))
    field = read_height_field(file)
    assert field.heights == pytest.approx(NUMBERS[::-1] * 0.1, abs=1e-12)
    assert field.pitch == pytest.approx((0.1, 0.05))


def test_a_channel_of_a_picture_is_refused(tmp_path: Path) -> None:
    write_picture(tmp_path / "x.png", BYTES)
    with refused(tmp_path / "x.png", "channel", "R", "only instruments' files"):
        read_height_field(tmp_path / "x.png", PITCH, 1.0, "R")


@pytest.mark.parametrize(("bad", "count"), [(np.nan, 2), (np.inf, 1), (-np.inf, 3)])
@pytest.mark.parametrize("name", ["x.npy", "x.csv", "x.exr", "x.tif"])
def test_heights_that_are_no_numbers_are_counted(
    tmp_path: Path, name: str, bad: float, count: int
) -> None:
    file = tmp_path / name
    numbers = NUMBERS.copy()
    numbers.flat[:count] = bad
    write = {"x.npy": np.save, "x.csv": write_csv, "x.exr": write_grey_exr}.get(name)
    write(file, numbers) if write else write_picture(file, numbers.astype(np.float32))
    with refused(file, "heights", f"{count} NaN or infinite", "finite"):
        read_height_field(file, PITCH, 1.0)


def test_constant_heights_and_lines_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "x.npy"
    np.save(file, np.full((3, 3), 0.25))
    with refused(file, "heights", "all 0.5 um", "heights that differ"):
        read_height_field(file, PITCH, 2.0)
    for shape in ((6,), (1, 6), (6, 1), (2, 3, 1), (0, 0)):
        np.save(file, np.arange(np.prod(shape), dtype=float).reshape(shape))
        with refused(file, "shape", shape, "two or more rows and columns"):
            read_height_field(file, PITCH, 1.0)
    np.save(file, NUMBERS + 1j)
    with refused(file, "dtype", "complex128", "real numbers"):
        read_height_field(file, PITCH, 1.0)


def test_other_suffixes_and_missing_files_are_refused(tmp_path: Path) -> None:
    with refused(tmp_path / "x.jpg", "suffix", ".jpg", ".png, .bmp"):
        read_height_field(tmp_path / "x.jpg", PITCH, 1.0)
    for name in ("x.png", "x.csv", "x.nid"):
        with refused(tmp_path / name, "contents", "no such file", "readable"):
            read_height_field(tmp_path / name, PITCH, 1.0)


@pytest.mark.parametrize("text", ["", "x,y\n1,2\n", "1,2\n3\n", "1;2\n3;4\n", "1,2\n3,\n"])
def test_csv_that_is_no_rectangle_of_numbers_is_refused(tmp_path: Path, text: str) -> None:
    file = tmp_path / "x.csv"
    file.write_text(text)
    with pytest.raises(InputError) as caught:
        read_height_field(file, PITCH, 1.0)
    assert caught.value.file == str(file)


def read_any(file: Path) -> None:
    """As the suffix needs it; what is read must be usable."""
    scaled = file.suffix in (".nid", ".gwy")
    field = read_height_field(file) if scaled else read_height_field(file, PITCH, 1.0)
    assert np.isfinite(field.heights).all()


def intact(folder: Path, suffix: str) -> bytes:
    file = folder / f"intact{suffix}"
    waves = 0.2 * np.sin(np.add.outer(np.arange(24), np.arange(32)))
    match suffix:
        case ".nid":
            write_nid(file, waves, (3e-6, 2e-6), 1e-6)
        case ".gwy":
            write_gwy(file, waves * 1e-6, (3e-6, 2e-6))
        case ".exr":
            write_grey_exr(file, waves)
        case ".npy":
            np.save(file, waves)
        case ".csv":
            write_csv(file, waves)
        case _:
            write_picture(file, np.round(waves * 5000 + 30000).astype(np.uint16))
    return file.read_bytes()


@pytest.mark.parametrize("suffix", [".png", ".tif", ".exr", ".npy", ".csv", ".nid", ".gwy"])
@settings(
    max_examples=25,
    deadline=None,
    # One folder serves all examples: each overwrites the file.
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(
    cut=st.floats(0, 1),
    flips=st.lists(st.tuples(st.floats(0, 1), st.integers(0, 255)), max_size=4),
)
def test_damage_is_an_error_with_the_files_name_or_harmless(
    tmp_path: Path, suffix: str, cut: float, flips: list[tuple[float, int]]
) -> None:
    contents = bytearray(intact(tmp_path, suffix))
    for place, value in flips:
        # Three of four flips hit the header.
        contents[int(place * (len(contents) - 1) * (0.02 if value % 4 else 1))] = value
    file = tmp_path / f"damaged{suffix}"
    file.write_bytes(contents[: int(cut * len(contents))] if not flips else contents)
    try:
        read_any(file)
    except InputError as error:
        assert error.file == str(file)
        assert "\n" not in str(error)


@pytest.mark.parametrize("suffix", [".png", ".tif", ".exr", ".npy", ".nid", ".gwy"])
@pytest.mark.parametrize("share", [0, 0.01, 0.3])
def test_a_truncated_file_is_unreadable(tmp_path: Path, suffix: str, share: float) -> None:
    contents = intact(tmp_path, suffix)
    file = tmp_path / f"truncated{suffix}"
    file.write_bytes(contents[: int(share * len(contents))])
    with pytest.raises(InputError) as caught:
        read_any(file)
    assert (caught.value.file, caught.value.field) == (str(file), "contents")


@needs_shared_data
def test_real_scans_have_the_size_their_instrument_says() -> None:
    for name, size in (("grid", 3.0), ("circles", 50.0), ("squares_holes", 50.0)):
        field = read_height_field(SHARED / "afm" / f"{name}.nid")
        assert field.heights.shape == (256, 256)
        assert field.period == pytest.approx((size, size))
        assert 0.01 < 2 * field.amplitude < 2  # nanometres to micrometres


@needs_shared_data
def test_a_truncated_real_scan_is_unreadable(tmp_path: Path) -> None:
    contents = (SHARED / "afm" / "grid.nid").read_bytes()
    for length in (100, 5000, 100_000):
        file = tmp_path / f"{length}.nid"
        file.write_bytes(contents[:length])
        with pytest.raises(InputError) as caught:
            read_height_field(file)
        assert caught.value.file == str(file)


@needs_shared_data
def test_pictures_of_real_skins_and_one_with_a_palette_are_read() -> None:
    folder = SHARED / "height_fields"
    for name in ("Elaph100x100.png", "Xeno100x100.png", "100x100stamBump.bmp"):
        field = read_height_field(folder / name, PITCH, 0.15)
        assert field.heights.shape == (100, 100)
        assert 0 <= field.heights.min() < 0.05 < 0.14 < field.heights.max() <= 0.15
    # A bump of one height on a flat ground, whose indices are not its grey levels.
    bump = read_height_field(folder / "100x100stamBump.bmp", PITCH, 0.15).heights
    assert np.unique(bump) == pytest.approx([0, 0.15])
