"""Small instrument files, written as their formats have them."""

import struct
from pathlib import Path

import numpy as np


def write_nid(
    file: Path, heights: np.ndarray, size: tuple[float, float], range_m: float, unit: str = "m"
) -> None:
    """A .nid of 16-bit numbers, the two channels Up and, with the opposite sign, Down.

    Args:
        file: The file.
        heights: As shares of the range, −½ to ½, shape (lines, points), the lowest line first.
        size: Of the patch along x and y, in `unit`.
        range_m: Range of the heights, in `unit`.
        unit: Of all.
    """
    lines, points = heights.shape
    header = ["[DataSet]", "Version=2", "GroupCount=1", "Gr0-Count=2"]
    header += ["Gr0-Ch0=DataSet-0:0", "Gr0-Ch1=DataSet-0:1"]
    header += ["[DataSet-Info]", "Date=01-02-2003", "Time=04:05:06"]
    for channel, name in enumerate(("Up", "Down")):
        header += [f"[DataSet-0:{channel}]", f"Points={points}", f"Lines={lines}", "Frame=Scan"]
        header += [f"Dim0Unit={unit}", f"Dim0Range={size[0]}", "Dim0Min=0"]
        header += [f"Dim1Unit={unit}", f"Dim1Range={size[1]}", "Dim1Min=0"]
        header += [f"Dim2Name={name}", f"Dim2Unit={unit}", f"Dim2Range={range_m}"]
        header += [f"Dim2Min={-range_m / 2}", "SaveMode=Binary", "SaveBits=16", "SaveSign=Signed"]
        header += ["SaveOrder=Intel"]
    stored = np.round(heights * 2**16).astype("<i2")
    text = "".join(line + "\r\n" for line in header)
    file.write_bytes(text.encode("latin-1") + b"#!" + stored.tobytes() + (-stored).tobytes())


def write_gwy(file: Path, heights: np.ndarray, size: tuple[float, float]) -> None:
    """A .gwy of one channel.

    Args:
        file: The file.
        heights: m, shape (rows, columns), the top row first.
        size: Of the patch along x and y, m.
    """

    def item(name: str, kind: str, value: bytes) -> bytes:
        return name.encode() + b"\0" + kind.encode() + value

    def container(name: str, *items: bytes) -> bytes:
        contents = b"".join(items)
        return name.encode() + b"\0" + struct.pack("<I", len(contents)) + contents

    rows, columns = heights.shape
    metre = container("GwySIUnit", item("unitstr", "s", b"m\0"))
    numbers = struct.pack("<I", heights.size) + heights.astype("<f8").tobytes()
    field = container(
        "GwyDataField",
        item("xres", "i", struct.pack("<i", columns)),
        item("yres", "i", struct.pack("<i", rows)),
        item("xreal", "d", struct.pack("<d", size[0])),
        item("yreal", "d", struct.pack("<d", size[1])),
        item("si_unit_xy", "o", metre),
        item("si_unit_z", "o", metre),
        item("data", "D", numbers),
    )
    title = item("/0/data/title", "s", b"Height\0")
    file.write_bytes(b"GWYP" + container("GwyContainer", title, item("/0/data", "o", field)))
