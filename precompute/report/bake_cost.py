"""What `diffraction bake` costs against the size of a height field.

Each bake is a process of its own, started by a small one that waits for it: a process counts the
memory of the one that started it as its own until it has loaded its program.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from precompute.report.rows import BakeCost

SIZES = (128, 256, 512, 1024, 2048)
"""Samples along each side."""

COMPARED_SIZE = 512
"""The one whose time the others are compared with."""

TERMS = 30
PITCH = 0.05
"""µm: a patch of 128 samples is 6.4 µm large."""

RUNS = 2
"""Of each bake; the shortest counts, and the largest memory."""

LAUNCHER = """
import json, os, sys, time
begin = time.monotonic()
child = os.posix_spawn(sys.argv[1], sys.argv[1:], os.environ)
_, status, usage = os.wait4(child, 0)
print(json.dumps({"seconds": time.monotonic() - begin, "peak": usage.ru_maxrss}))
sys.exit(os.waitstatus_to_exitcode(status))
"""
"""Runs the program it is given, and prints how long it took and its peak memory, in KiB."""

COMMAND = """
import sys, time
import precompute.bake
from precompute.cli import app
begin = time.monotonic()
code = app(sys.argv[1:], standalone_mode=False)
print(time.monotonic() - begin)
sys.exit(code)
"""
"""The command `diffraction`, which prints how long it took once its modules were loaded."""


class BakeError(RuntimeError):
    """A bake failed; the message is what it printed."""


def bake_recipe(size: int) -> dict[str, Any]:
    """A snake-like field of size × size samples: more of the same ridges where it is larger."""
    period = size * PITCH
    source = {"kind": "fingers", "length": 1.6, "spacing": 0.8}
    source |= {"columns": round(period / 1.6), "rows": round(period / 0.8)}
    return {
        "kind": "height-field",
        "source": source,
        "pitch": PITCH,
        "methods": ["jacobi-anger"],
        "terms": TERMS,
    }


def bake_cost(size: int) -> BakeCost:
    """Bake a field of size × size samples, `RUNS` times.

    Raises:
        BakeError: The bake failed.
    """
    with tempfile.TemporaryDirectory() as folder:
        recipe, maps = Path(folder, "height-field-fingers.json"), Path(folder, "maps")
        recipe.write_text(json.dumps(bake_recipe(size)), "utf-8")
        command = [sys.executable, "-c", COMMAND, "bake", str(recipe), "-o", str(maps)]
        runs = [measured(command) for _ in range(RUNS)]
        written = sum(file.stat().st_size for file in maps.iterdir())
    whole, peaks, printed = zip(*runs, strict=True)
    return BakeCost(
        size=size,
        terms=TERMS,
        seconds=min(whole),
        baking_seconds=min(float(text) for text in printed),
        peak_bytes=max(peaks),
        map_bytes=written,
    )


def measured(command: list[str]) -> tuple[float, int, str]:
    """Run a program.

    Returns:
        Seconds it took, its peak memory, bytes, and what it printed.

    Raises:
        BakeError: It ended with another code than 0.
    """
    done = subprocess.run(
        [sys.executable, "-I", "-S", "-c", LAUNCHER, *command], capture_output=True, text=True
    )
    if done.returncode != 0:
        raise BakeError(f"{command[-4:]}: {done.stderr.strip()}")
    *printed, figures = done.stdout.splitlines()
    usage = json.loads(figures)
    return usage["seconds"], 1024 * usage["peak"], "\n".join(printed)
