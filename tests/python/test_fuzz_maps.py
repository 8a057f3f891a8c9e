"""Damaged and hostile maps: each is refused by a typed error, or is the map that it states.

FUZZ_MAPS=100000 .venv/bin/python -m pytest -s tests/python/test_fuzz_maps.py
"""

from __future__ import annotations

import copy
import hashlib
import json
import os
import resource
import struct
import time
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from precompute.axes import Axis
from precompute.errors import InputError
from precompute.maps import Map, Table

COUNT = int(os.environ.get("FUZZ_MAPS", "2500"))
MAX_SECONDS = 2.0
MAX_GROWTH_BYTES = 256 * 2**20

Files = dict[str, bytes]
Random = np.random.Generator

DEEP = "deep"  # in text, for json.dumps would not nest so far
HOSTILE: list[Any] = [
    *(None, True, -1, 0, 1, 1.5, 1e308, -1e308, float("nan"), float("inf"), 2**31, 2**63, 2**64),
    *(10**400, "", "1", "NaN", "x" * 10_000, [], {}, [[]], [0, 1], [1e308, 1e308], DEEP),
    *([2**32, 2**32, 4], [2**62, 4, 4], [8192, 8192, 4], [1] * 65, ["x"] * 20_000),
    *(
        "../numbers.bin",
        "/etc/passwd",
        "C:\\x.bin",
        "..\\x.bin",
        "a/../numbers.bin",
        "./numbers.bin",
    ),
    *("https://example.org/x.bin", "//example.org/x.bin", "file:///x.bin", "%2e%2e%2fnumbers.bin"),
    *("numbers.bin?x", "numbers.bin#x", "a\0.bin", "a\n.bin", ".", "..", ".bin", "\ud800.bin", " "),
    *("picture.png", "numbers.bin", "float16", "float32", "uint8", "linear", "square", "log"),
    *({"__proto__": {}}, {"constructor": 1}, {"../x": 1}),
]


def axis(name: str, size: int) -> Axis:
    return Axis(name=name, symbol=name, unit="1", size=size, first=0, last=1)


def good(folder: Path) -> Files:
    """A map of halves, floats and an image; the floats also stand in the folder above."""
    rng = np.random.default_rng(1)
    axes = axis("y", 2), axis("x", 3)
    texels = rng.integers(0, 256, (5, 7, 4)) / 255
    decode = ((0.0, 1.0),) * 4
    channels = ("a", "b", "c", "d")
    tables = {
        "halves": Table(rng.normal(size=(2, 3, 4)), axes, channels),
        "numbers": Table(rng.normal(size=(2, 3, 1)), axes, ("a",), "float32"),
        "picture": Table(texels, (axis("v", 5), axis("u", 7)), channels, "uint8", decode),
    }
    constants: dict[str, float | tuple[float, ...]] = {"one": 1.0, "three": (1.0, 2.0, 3.0)}
    whole = Map(
        "foil", "q", "x", tables, {"rms": 0.5}, {"kind": "foil", "steps": [1, 2]}, constants
    )
    files = {f.name: f.read_bytes() for f in whole.write(folder / "maps", "m")}
    (folder / "numbers.bin").write_bytes(files["m.numbers.bin"])
    return files


def dumped(sidecar: Any) -> bytes:
    text = json.dumps(sidecar).replace(f'"{DEEP}"', "[" * 20_000 + "]" * 20_000)
    return text.encode()


def signed(files: Files) -> None:
    """The checksums of what is there, so that the damage is looked at behind them."""
    sidecar = json.loads(files["m.json"])
    for spec in sidecar["arrays"].values():
        spec["sha256"] = hashlib.sha256(files[spec["file"]]).hexdigest()
    files["m.json"] = dumped(sidecar)


def damage_bytes(files: Files, rng: Random) -> None:
    name = str(rng.choice(list(files)))
    data = bytearray(files[name])
    at, length = int(rng.integers(len(data))), int(rng.integers(1, 40))
    match rng.integers(5):
        case 0:
            for _ in range(rng.integers(1, 4)):
                data[rng.integers(len(data))] ^= 1 << int(rng.integers(8))
        case 1:
            del data[at:]
        case 2:
            del data[at : at + length]
        case 3:
            data[at:at] = rng.bytes(length)
        case _:
            other = files[str(rng.choice(list(files)))]
            data[at : at + length] = other[at : at + length]
    files[name] = bytes(data)
    if name != "m.json" and rng.random() < 0.8:
        signed(files)


def damage_field(files: Files, rng: Random) -> None:
    sidecar = json.loads(files["m.json"])
    for _ in range(rng.integers(1, 3)):
        place: Any = sidecar
        while True:
            keys = list(place) if isinstance(place, dict) else range(len(place))
            key = keys[int(rng.integers(len(keys)))]
            if not place[key] or not isinstance(place[key], dict | list) or rng.random() < 0.2:
                break
            place = place[key]
        value = copy.deepcopy(HOSTILE[int(rng.integers(len(HOSTILE)))])
        match rng.integers(6):
            case 0:
                del place[key]
            case 1 if isinstance(place, dict):
                place[value if isinstance(value, str) else "__proto__"] = place[key]
            case _:
                place[key] = value
        if not place or not sidecar:
            break
    files["m.json"] = dumped(sidecar)


def damage_file_name(files: Files, rng: Random) -> None:
    sidecar = json.loads(files["m.json"])
    names = [value for value in HOSTILE if isinstance(value, str)]
    sidecar["arrays"]["numbers"]["file"] = names[int(rng.integers(len(names)))]
    files["m.json"] = dumped(sidecar)


def chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


BOMB = zlib.compress(bytes(64 * 2**20))


def damage_image(files: Files, rng: Random) -> None:
    """Chunks that are wrong, with checksums that are right."""
    data, chunks, at = files["m.picture.png"], [], 8
    while at < len(data):
        (length,) = struct.unpack_from(">I", data, at)
        chunks.append([data[at + 4 : at + 8], data[at + 8 : at + 8 + length]])
        at += 12 + length
    sidecar = json.loads(files["m.json"])
    sizes = (0, 1, 7, 5, 64, 4096, 8192, 16384, 65536, 2**31 - 1, 2**32 - 1)
    for _ in range(rng.integers(1, 3)):
        target = chunks[int(rng.integers(len(chunks)))]
        match rng.integers(7):
            case 0:
                width, height = (sizes[int(i)] for i in rng.integers(len(sizes), size=2))
                chunks[0][1] = struct.pack(">II", width, height) + chunks[0][1][8:]
                if rng.random() < 0.5:
                    spec = sidecar["arrays"]["picture"]
                    spec["shape"] = [height, width, 4]
                    for a, size in zip(spec["axes"], (height, width), strict=True):
                        a["size"] = size
            case 1:
                head = bytearray(chunks[0][1].ljust(13, b"\0"))
                head[rng.integers(8, 13)] = rng.integers(256)
                chunks[0][1] = bytes(head)
            case 2:
                rows = bytes(rng.integers(0, 6, rng.choice([140, 145, 150, 100_000]), np.uint8))
                target[:] = b"IDAT", BOMB if rng.random() < 0.2 else zlib.compress(rows)
            case 3:
                target[1] = target[1][: rng.integers(len(target[1]) + 1)]
            case 4:
                chunks.insert(int(rng.integers(len(chunks))), list(target))
            case 5:
                kinds = (
                    b"zTXt",
                    b"iTXt",
                    b"iCCP",
                    b"tRNS",
                    b"PLTE",
                    b"acTL",
                    b"fcTL",
                    b"eXIf",
                    b"cHRM",
                )
                text = b"k\0\0" + (BOMB if rng.random() < 0.3 else rng.bytes(30))
                chunks.insert(1, [kinds[int(rng.integers(len(kinds)))], text])
            case _:
                target[0] = rng.bytes(4)
    files["m.picture.png"] = data[:8] + b"".join(chunk(*c) for c in chunks)
    files["m.json"] = dumped(sidecar)
    signed(files)


DAMAGES: list[Callable[[Files, Random], None]] = [
    damage_bytes,
    damage_field,
    damage_file_name,
    damage_image,
]


def is_as_stated(found: Map, files: Files) -> None:
    """Every number is finite, and those of binaries are the ones that stand in the files."""
    sidecar = json.loads(files["m.json"])
    assert found.kind == sidecar["kind"]
    assert set(found.tables) == set(sidecar["arrays"])
    assert {k: np.ravel(v).tolist() for k, v in found.constants.items()} == {
        k: np.ravel(v).tolist() for k, v in sidecar["constants"].items()
    }
    json.dumps(found.recipe, allow_nan=False)
    for name, spec in sidecar["arrays"].items():
        values = found.tables[name].values
        assert list(values.shape) == spec["shape"]
        assert np.isfinite(values).all()
        if spec["dtype"] != "uint8":
            kind = np.dtype(spec["dtype"]).newbyteorder("<")
            assert values.ravel().tolist() == np.frombuffer(files[spec["file"]], kind).tolist()


@pytest.mark.filterwarnings("ignore:Image size", "ignore:Invalid APNG")
def test_every_damaged_map_is_refused_or_is_what_it_states(tmp_path: Path) -> None:
    whole = good(tmp_path)
    is_as_stated(Map.read(tmp_path / "maps" / "m"), whole)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    start, slowest, refused = time.perf_counter(), 0.0, 0
    for seed in range(COUNT):
        rng = np.random.default_rng(seed)
        files = dict(whole)
        DAMAGES[seed % len(DAMAGES)](files, rng)
        for name, data in files.items():
            if data != whole[name]:
                (tmp_path / "maps" / name).write_bytes(data)
        begin = time.perf_counter()
        try:
            found = Map.read(tmp_path / "maps" / "m")
        except InputError:
            refused += 1
        except BaseException as failure:
            raise AssertionError(f"seed {seed}") from failure
        else:
            is_as_stated(found, files)
        slowest = max(slowest, time.perf_counter() - begin)
        assert slowest < MAX_SECONDS, f"seed {seed}"
        for name, data in files.items():
            if data != whole[name]:
                (tmp_path / "maps" / name).write_bytes(whole[name])
    growth = 1024 * (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
    print(
        f"\n{COUNT} maps in {time.perf_counter() - start:.0f} s: {refused} refused, "
        f"{COUNT - refused} valid; slowest {slowest:.3f} s, memory grew by {growth / 2**20:.0f} MB"
    )
    assert growth < MAX_GROWTH_BYTES
    assert 0 < refused < COUNT
