"""PNG and EXR files."""

from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from refusals import refused

from precompute.errors import InputError
from precompute.images import decode_png, encode_png, read_exr, write_exr


def test_png_keeps_every_texel_also_where_alpha_is_zero() -> None:
    texels = np.random.default_rng(1).integers(0, 256, (7, 5, 4), dtype=np.uint8)
    texels[2:4, :, 3] = 0
    assert np.array_equal(decode_png(Path("x.png"), encode_png(texels), texels.shape), texels)


@pytest.mark.parametrize(("channels", "mode"), [(1, "L"), (2, "LA"), (3, "RGB")])
def test_png_of_other_channels_is_refused(channels: int, mode: str) -> None:
    data = encode_png(np.zeros((2, 2, channels), np.uint8))
    with refused("x.png", "channels", mode, "RGBA, 8 bit"):
        decode_png(Path("x.png"), data, (2, 2, 4))


@pytest.mark.parametrize("damage", ["truncated", "no PNG"])
def test_damaged_png_is_refused(damage: str) -> None:
    data = encode_png(np.random.default_rng(1).integers(0, 256, (64, 64, 4), dtype=np.uint8))
    with pytest.raises(InputError) as caught:
        decode_png(
            Path("x.png"),
            data[: len(data) // 2] if damage == "truncated" else b"GIF89a",
            (64, 64, 4),
        )
    assert (caught.value.file, caught.value.field) == ("x.png", "contents")


@pytest.mark.parametrize("dtype", [np.float16, np.float32])
@pytest.mark.parametrize("channels", [1, 3, 4])
def test_exr_round_trip(tmp_path: Path, dtype: type, channels: int) -> None:
    pixels = np.random.default_rng(2).normal(size=(4, 6, channels)).astype(dtype)
    file = tmp_path / "picture.exr"
    write_exr(file, pixels)
    found = read_exr(file)
    assert found.dtype == np.float32
    # Exact, channel by channel: EXR files store channels by name, B before R.
    assert np.array_equal(found, pixels.astype(np.float32))
    assert [f.name for f in tmp_path.iterdir()] == ["picture.exr"]


def test_exr_stores_halves_as_halves(tmp_path: Path) -> None:
    write_exr(tmp_path / "half.exr", np.ones((2, 2, 3), np.float16))
    write_exr(tmp_path / "float.exr", np.ones((2, 2, 3), np.float64))
    for name, dtype in (("half", np.float16), ("float", np.float32)):
        with OpenEXR.File(str(tmp_path / f"{name}.exr"), separate_channels=True) as exr:
            assert {c.pixels.dtype.type for c in exr.channels().values()} == {dtype}


@pytest.mark.parametrize("contents", [None, b"", b"no picture at all"])
def test_bad_exr_is_refused(tmp_path: Path, contents: bytes | None) -> None:
    file = tmp_path / "bad.exr"
    if contents is not None:
        file.write_bytes(contents)
    with pytest.raises(InputError) as caught:
        read_exr(file)
    assert (caught.value.file, caught.value.field) == (str(file), "contents")
