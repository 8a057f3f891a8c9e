"""Maps on disk: what is written is read, and what is wrong is refused by name."""

import hashlib
import json
import os
import struct
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
from refusals import refused

from precompute.axes import Axis
from precompute.bake import bake
from precompute.errors import InputError
from precompute.images import encode_png
from precompute.maps import MAX_SIDECAR_BYTES, Map, Table

RECIPES = {
    "profile": {"kind": "profile", "profile": "blazed", "samples": 32, "max_order": 4},
    "lobes": {"kind": "lobes", "wavenumbers": 12, "widths": 4},
    "metals": {"kind": "metals", "wavenumbers": 16},
    "foil": {"kind": "foil", "design": "polygons", "size": 32},
}


def axis(name: str, size: int) -> Axis:
    return Axis(name=name, symbol=name, unit="1", size=size, first=0, last=1)


def example(**tables: Table) -> Map:
    return Map(
        kind="profile",
        quantity="numbers",
        symbol="x",
        tables=tables,
        error={"relative_rms": 0.5, "against": "nothing"},
        recipe={"kind": "profile", "profile": {"kind": "blazed"}},
        constants={"one": 1.0, "three": (1.0, 2.0, 3.0)},
    )


def table(dtype: Literal["float16", "float32"] = "float32", size: int = 3) -> Table:
    values = np.random.default_rng(7).normal(size=(2, size, 4))
    return Table(values, (axis("y", 2), axis("x", size)), ("a", "b", "c", "d"), dtype)


def picture(values: np.ndarray) -> Table:
    decode = ((-1.0, 2.0), (0.0, 1.0), (0.0, 0.5), (10.0, 255.0))
    axes = (axis("row", values.shape[0]), axis("column", values.shape[1]))
    return Table(values, axes, ("a", "b", "c", "d"), "uint8", decode)


@pytest.mark.parametrize(("dtype", "precision"), [("float16", 2**-11), ("float32", 2**-24)])
def test_numbers_come_back(
    tmp_path: Path, dtype: Literal["float16", "float32"], precision: float
) -> None:
    written = example(numbers=table(dtype))
    files = written.write(tmp_path, "name")
    assert [f.name for f in files] == ["name.numbers.bin", "name.json"]
    assert files[0].stat().st_size == 24 * np.dtype(dtype).itemsize
    # Slowest axis first, channels last, little-endian: what the web loader takes for granted.
    raw = np.frombuffer(files[0].read_bytes(), np.dtype(dtype).newbyteorder("<"))
    assert raw[4:8] == pytest.approx(written.tables["numbers"].values[0, 1], rel=precision)
    for name in ("name", "name.json"):
        found = Map.read(tmp_path / name)
        assert found.tables["numbers"].values == pytest.approx(
            written.tables["numbers"].values, rel=precision
        )
        found.tables["numbers"].values = written.tables["numbers"].values
        assert repr(found) == repr(written)


def test_pictures_come_back(tmp_path: Path) -> None:
    texels = np.random.default_rng(7).integers(0, 256, (3, 5, 4))
    values = np.array([-1, 0, 0, 10]) + np.array([2, 1, 0.5, 255]) * texels / 255
    files = example(texels=picture(values)).write(tmp_path, "name")
    assert files[0].name == "name.texels.png"
    assert Map.read(tmp_path / "name").tables["texels"].values == pytest.approx(values)


@pytest.mark.parametrize("kind", RECIPES)
def test_baking_twice_gives_the_same_bytes(tmp_path: Path, kind: str) -> None:
    recipe = tmp_path / f"{kind}.json"
    recipe.write_text(json.dumps(RECIPES[kind]))
    once, again = (bake(recipe, tmp_path / folder) for folder in ("once", "again"))
    assert [f.name for f in once] == [f.name for f in again]
    assert [f.read_bytes() for f in once] == [f.read_bytes() for f in again]
    sidecar = json.loads(once[-1].read_text())
    assert {k: v for k, v in sidecar["recipe"].items() if k != "profile"}.items() >= {
        k: v for k, v in RECIPES[kind].items() if k != "profile"
    }.items()


def test_nothing_half_written_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The disk fills while the second binary is written."""
    whole = Path.write_bytes

    def until_full(self: Path, data: bytes) -> int:
        if ".second." in self.name:
            whole(self, data[: len(data) // 2])
            raise OSError("No space left on device")
        return whole(self, data)

    monkeypatch.setattr(Path, "write_bytes", until_full)
    with pytest.raises(OSError, match="No space left"):
        example(first=table(), second=table()).write(tmp_path, "name")
    assert [f.name for f in tmp_path.iterdir()] == ["name.first.bin"]


@pytest.mark.parametrize(
    ("dtype", "bad", "value", "expected"),
    [
        ("float32", np.nan, "2 NaN or infinite texels", "finite float32"),
        ("float32", np.inf, "2 NaN or infinite texels", "finite float32"),
        ("float16", 70000.0, "2 NaN or infinite texels", "finite float16"),  # halves end at 65504
    ],
)
def test_texels_that_cannot_be_stored_are_refused_with_their_count(
    tmp_path: Path,
    dtype: Literal["float16", "float32"],
    bad: float,
    value: str,
    expected: str,
) -> None:
    spoilt = table(dtype)
    spoilt.values[1, :2, 0] = bad
    with refused(tmp_path / "name.spoilt.bin", "spoilt", value, expected):
        example(good=table(), spoilt=spoilt).write(tmp_path, "name")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("bad", [np.nan, 1.5, -1.5])
def test_picture_values_beyond_their_range_are_refused_with_their_count(
    tmp_path: Path, bad: float
) -> None:
    """Cast to 8 bits they would wrap around."""
    values = np.full((2, 2, 4), [0, 0, 0, 10.0])
    values[0, 1, 0] = bad
    problem = "1 texels that are NaN or beyond what decode covers"
    with refused(tmp_path / "name.texels.png", "texels", problem, "0 to 255"):
        example(texels=picture(values)).write(tmp_path, "name")
    assert list(tmp_path.iterdir()) == []


def spoil(folder: Path, change: Callable[[dict[str, Any]], None]) -> Path:
    """A map with a binary and a picture whose sidecar is changed."""
    texels = np.full((3, 5, 4), [0, 0, 0, 10.0])
    *_, sidecar = example(numbers=table(), texels=picture(texels)).write(folder, "name")
    contents = json.loads(sidecar.read_text())
    change(contents)
    sidecar.write_text(json.dumps(contents))
    return sidecar


def removed(contents: dict[str, Any], name: str) -> None:
    del contents[name]


@pytest.mark.parametrize(
    ("change", "field", "value", "expected"),
    [
        (lambda s: s.update(format="png"), "format", "png", "'three-diffraction/map'"),
        (lambda s: s.update(version=2), "version", 2, "1"),
        (lambda s: removed(s, "version") or s.update(version=None), "version", None, "1"),
        (lambda s: s.update(kind="hologram"), "kind", "hologram", "'profile'"),
        (lambda s: removed(s, "quantity"), "quantity", None, "missing"),
        (lambda s: s.update(colour=1), "colour", 1, "no such field"),
        (
            lambda s: s["arrays"]["numbers"].update(dtype="int8"),
            "arrays.numbers.dtype",
            "int8",
            "'float16'",
        ),
        (
            lambda s: s["arrays"]["numbers"]["axes"][1].update(mapping="cubic"),
            "arrays.numbers.axes.1.mapping",
            "cubic",
            "'linear'",
        ),
        (
            lambda s: s["arrays"]["numbers"]["axes"][0].update(size=0),
            "arrays.numbers.axes.0.size",
            0,
            "greater than or equal to 1",
        ),
    ],
)
def test_bad_sidecar_is_refused(
    tmp_path: Path,
    change: Callable[[dict[str, Any]], None],
    field: str,
    value: object,
    expected: str,
) -> None:
    sidecar = spoil(tmp_path, change)
    with refused(sidecar, field, value, expected):
        Map.read(sidecar)


@pytest.mark.parametrize(
    ("array", "change", "expected"),
    [
        ("numbers", {"shape": [2, 4, 4]}, "(2, 3, 4), not (2, 4, 4)"),
        ("numbers", {"channels": ["a"]}, "(2, 3, 1), not (2, 3, 4)"),
        ("texels", {"decode": None}, "decode with an offset and a scale for each channel"),
        ("texels", {"decode": [[0, 1]]}, "decode with an offset and a scale for each channel"),
    ],
)
def test_sidecar_that_contradicts_itself_is_refused(
    tmp_path: Path, array: str, change: dict[str, Any], expected: str
) -> None:
    sidecar = spoil(tmp_path, lambda contents: contents["arrays"][array].update(change))
    value = json.loads(sidecar.read_text())["arrays"][array]
    with refused(sidecar, f"arrays.{array}", value, expected):
        Map.read(sidecar)


@pytest.mark.parametrize("text", [None, "", "{", "[]"])
def test_unreadable_sidecar_is_refused(tmp_path: Path, text: str | None) -> None:
    file = tmp_path / "name.json"
    if text is not None:
        file.write_text(text)
    with pytest.raises(InputError) as caught:
        Map.read(file)
    assert (caught.value.file, caught.value.field) == (str(file), "contents")


def test_missing_binary_is_refused(tmp_path: Path) -> None:
    binary, sidecar = example(numbers=table()).write(tmp_path, "name")
    binary.unlink()
    problem = f"[Errno 2] No such file or directory: '{binary}'"
    with refused(binary, "contents", problem, "a readable file"):
        Map.read(sidecar)


def test_truncated_binary_is_refused(tmp_path: Path) -> None:
    binary, sidecar = example(numbers=table()).write(tmp_path, "name")
    binary.write_bytes(binary.read_bytes()[:-4])
    with refused(binary, "size", 92, "96 bytes"):
        Map.read(sidecar)


def replace(binary: Path, sidecar: Path, key: str, data: bytes) -> None:
    """Put other contents into a binary, with the checksum that is theirs."""
    binary.write_bytes(data)
    contents = json.loads(sidecar.read_text())
    contents["arrays"][key]["sha256"] = hashlib.sha256(data).hexdigest()
    sidecar.write_text(json.dumps(contents))


def test_a_changed_bit_is_refused(tmp_path: Path) -> None:
    binary, sidecar = example(numbers=table()).write(tmp_path, "name")
    data = bytearray(binary.read_bytes())
    stated = hashlib.sha256(data).hexdigest()
    data[50] ^= 1
    binary.write_bytes(data)
    with refused(binary, "sha256", hashlib.sha256(data).hexdigest(), stated):
        Map.read(sidecar)


def test_nan_texels_are_refused_with_their_count(tmp_path: Path) -> None:
    binary, sidecar = example(numbers=table()).write(tmp_path, "name")
    numbers = np.frombuffer(binary.read_bytes(), "<f4").copy()
    numbers[[3, 5, 8]] = np.nan, np.inf, -np.inf
    replace(binary, sidecar, "numbers", numbers.tobytes())
    with refused(binary, "texels", "3 NaN or infinite", "finite numbers"):
        Map.read(sidecar)


@pytest.mark.parametrize(("channels", "mode"), [(1, "L"), (3, "RGB")])
def test_picture_of_other_channels_is_refused(tmp_path: Path, channels: int, mode: str) -> None:
    texels = picture(np.full((3, 5, 4), [0, 0, 0, 10.0]))
    image, sidecar = example(texels=texels).write(tmp_path, "name")
    replace(image, sidecar, "texels", encode_png(np.zeros((3, 5, channels), np.uint8)))
    with refused(image, "channels", mode, "RGBA, 8 bit"):
        Map.read(sidecar)


def test_picture_of_another_size_is_refused(tmp_path: Path) -> None:
    texels = picture(np.full((3, 5, 4), [0, 0, 0, 10.0]))
    image, sidecar = example(texels=texels).write(tmp_path, "name")
    replace(image, sidecar, "texels", encode_png(np.zeros((5, 3, 4), np.uint8)))
    with refused(image, "shape", (5, 3, 4), "(3, 5, 4)"):
        Map.read(sidecar)


@pytest.mark.parametrize(
    "name",
    [
        *("../other.bin", "/etc/passwd", "a/../name.numbers.bin", "./name.numbers.bin", "..", ""),
        *("C:\\x.bin", "..\\other.bin", "https://example.org/x.bin", "a\0.bin", "name.json"),
    ],
)
def test_a_file_elsewhere_is_refused(tmp_path: Path, name: str) -> None:
    sidecar = spoil(tmp_path / "maps", lambda s: s["arrays"]["numbers"].update(file=name))
    whole = (tmp_path / "maps" / "name.numbers.bin").read_bytes()
    (tmp_path / "other.bin").write_bytes(whole)
    with refused(sidecar, "arrays.numbers.file", name, "name without a folder"):
        Map.read(sidecar)


@pytest.mark.parametrize("field", ["arrays", "constants"])
def test_names_that_would_lead_elsewhere_are_refused(tmp_path: Path, field: str) -> None:
    """`write_pictures` names files by them."""

    def change(contents: dict[str, Any]) -> None:
        entries = contents[field]
        entries["../x"] = entries.pop(next(iter(entries)))

    sidecar = spoil(tmp_path, change)
    with pytest.raises(InputError, match=r"\^\[A-Za-z\]"):
        Map.read(sidecar)


@pytest.mark.parametrize(
    ("place", "value"),
    [
        ('"one": 1.0', "NaN"),
        ('"one": 1.0', "1e999"),
        ('"one": 1.0', '"1"'),
        ('"one": 1.0', "[1.0, -Infinity]"),
        ('"relative_rms": 0.5', "NaN"),
        ('"last": 1.0', "Infinity"),
    ],
)
def test_numbers_that_are_none_are_refused(tmp_path: Path, place: str, value: str) -> None:
    *_, sidecar = example(numbers=table()).write(tmp_path, "name")
    name, _ = place.split(":")
    sidecar.write_text(sidecar.read_text().replace(place, f"{name}: {value}"))
    with pytest.raises(InputError, match=name.strip('"')) as caught:
        Map.read(sidecar)
    assert caught.value.file == str(sidecar)


def test_a_recipe_with_nan_is_refused(tmp_path: Path) -> None:
    sidecar = spoil(tmp_path, lambda s: s["recipe"].update(period=float("nan")))
    with pytest.raises(InputError, match="JSON") as caught:
        Map.read(sidecar)
    assert caught.value.field == "recipe"


def test_sizes_whose_product_overflows_are_refused(tmp_path: Path) -> None:
    """2³² · 2³² · 4 is 0 in 64 bits, which is the size of an empty file."""
    *_, sidecar = example(numbers=table()).write(tmp_path, "name")
    contents = json.loads(sidecar.read_text())
    spec = contents["arrays"]["numbers"]
    spec["shape"] = [2**32, 2**32, 4]
    for a in spec["axes"]:
        a["size"] = 2**32
    sidecar.write_text(json.dumps(contents))
    replace(tmp_path / "name.numbers.bin", sidecar, "numbers", b"")
    with pytest.raises(InputError, match="268435456 bytes at most"):
        Map.read(sidecar)


def test_a_sidecar_that_is_too_large_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "name.json"
    file.write_bytes(b"[" * (MAX_SIDECAR_BYTES + 1))
    with refused(file, "size", MAX_SIDECAR_BYTES + 1, f"{MAX_SIDECAR_BYTES} bytes at most"):
        Map.read(file)
    large = example(numbers=table())
    large.recipe = {"text": "x" * MAX_SIDECAR_BYTES}
    with pytest.raises(InputError, match="bytes at most"):
        large.write(tmp_path / "new", "name")
    assert not (tmp_path / "new").exists()


def test_a_sidecar_of_many_failures_is_refused_at_once(tmp_path: Path) -> None:
    """Written out they took gigabytes."""
    sidecar = spoil(tmp_path, lambda s: s.update({f"x{i}": 0 for i in range(20_000)}))
    with refused(sidecar, "contents", "20000 wrong fields", "1000 at most"):
        Map.read(sidecar)
    sidecar = spoil(tmp_path, lambda s: s["arrays"]["numbers"].update(axes=[{}] * 50_000))
    with pytest.raises(InputError) as caught:
        Map.read(sidecar)
    assert caught.value.field == "arrays.numbers.axes.0.name"


def test_a_name_that_could_not_be_read_is_not_written(tmp_path: Path) -> None:
    name = "a:b.numbers.bin"
    with refused(tmp_path / "a:b.json", "file", name, "name without a folder"):
        example(numbers=table()).write(tmp_path, "a:b")
    assert list(tmp_path.iterdir()) == []


def test_pipes_are_refused_and_links_are_followed(tmp_path: Path) -> None:
    binary, sidecar = example(numbers=table()).write(tmp_path / "maps", "name")
    binary.rename(tmp_path / "elsewhere")
    binary.symlink_to(tmp_path / "elsewhere")
    assert Map.read(sidecar).tables["numbers"].values.shape == (2, 3, 4)
    binary.unlink()
    os.mkfifo(binary)
    with refused(binary, "contents", "no regular file", "a readable file"):
        Map.read(sidecar)


def header(width: int, height: int, bits: int, rows: bytes) -> bytes:
    """An RGBA PNG with a header that need not fit its rows."""
    ihdr = struct.pack(">IIBBBBB", width, height, bits, 6, 0, 0, 0)
    chunks = ((b"IHDR", ihdr), (b"IDAT", zlib.compress(rows)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        for kind, data in chunks
    )


@pytest.mark.parametrize(
    ("size", "bits", "field"),
    [((8192, 8192), 8, "shape"), ((60_000, 60_000), 8, "contents"), ((5, 3), 16, "bits")],
)
def test_a_picture_is_refused_by_its_header(
    tmp_path: Path, size: tuple[int, int], bits: int, field: str
) -> None:
    """The rows are those of the right size: an error about them would be found too late."""
    image, sidecar = example(texels=picture(np.full((3, 5, 4), [0, 0, 0, 10.0]))).write(
        tmp_path, "name"
    )
    replace(image, sidecar, "texels", header(*size, bits, bytes(3 * (1 + 5 * 4 * bits // 8))))
    with pytest.raises(InputError) as caught:
        Map.read(sidecar)
    assert (caught.value.file, caught.value.field) == (str(image), field)


def test_a_picture_of_too_few_bytes_for_its_size_is_refused(tmp_path: Path) -> None:
    image, sidecar = example(texels=picture(np.full((3, 5, 4), [0, 0, 0, 10.0]))).write(
        tmp_path, "name"
    )
    data = header(8192, 8192, 8, bytes(100))
    replace(image, sidecar, "texels", data)
    contents = json.loads(sidecar.read_text())
    spec = contents["arrays"]["texels"]
    spec["shape"] = [8192, 8192, 4]
    for a in spec["axes"]:
        a["size"] = 8192
    sidecar.write_text(json.dumps(contents))
    with refused(image, "size", len(data), "bytes enough for its texels"):
        Map.read(sidecar)
