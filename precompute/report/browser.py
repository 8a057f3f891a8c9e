"""The browser harness of tests/browser, run as a program of its own."""

from __future__ import annotations

import json
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from precompute.errors import InputError

ROOT = Path(__file__).resolve().parents[2]
"""The repository: the harness is not part of the Python package."""


class BrowserError(RuntimeError):
    """The browser did not do what it was asked; the message is what it printed."""


def render(descriptions: dict[str, dict[str, Any]], folder: Path) -> Iterator[str]:
    """Render scenes in one launch of Chromium (`tests/browser/render.mjs`).

    Args:
        descriptions: What to draw (tests/scenes/README.md), by name.
        folder: Where the arrays go, for `precompute.renderings.Rendering.read`.

    Yields:
        The name of each scene once its files are written.

    Raises:
        BrowserError: A scene did not render.
    """
    files = _written(descriptions, folder / "scenes")
    yield from _lines("tests/browser/render.mjs", ["--output", str(folder), *files])


def time(
    requests: dict[str, dict[str, Any]], folder: Path
) -> Iterator[tuple[str, dict[str, float]]]:
    """Time materials in one launch of Chromium on one thread (`tests/browser/time.mjs`).

    Args:
        requests: What to time (tests/browser/harness/timing.ts), by name.
        folder: Where the requests are written.

    Yields:
        The request's name and the shortest frame of each material, ms.

    Raises:
        BrowserError: A request failed.
    """
    for line in _lines("tests/browser/time.mjs", _written(requests, folder / "timings")):
        answer: dict[str, Any] = json.loads(line)
        yield answer["request"], answer["milliseconds"]


def _written(contents: dict[str, dict[str, Any]], folder: Path) -> list[str]:
    folder.mkdir(parents=True, exist_ok=True)
    files = [folder / f"{name}.json" for name in contents]
    for file, content in zip(files, contents.values(), strict=True):
        file.write_text(json.dumps(content), "utf-8")
    return [str(file) for file in files]


def _lines(script: str, arguments: list[str]) -> Iterator[str]:
    node = shutil.which("node")
    if node is None:
        raise InputError("PATH", "node", None, "Node.js, which drives the browser")
    if not (ROOT / script).is_file():
        raise InputError(ROOT, script, None, "the repository's own browser harness")
    process = subprocess.Popen(
        [node, script, *arguments],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        encoding="utf-8",
    )
    assert process.stdout is not None and process.stderr is not None
    try:
        for line in process.stdout:
            yield line.rstrip("\n")
        complaint = process.stderr.read()
        if process.wait() != 0:
            raise BrowserError(f"{script}: {complaint.strip()}")
    finally:
        if process.poll() is None:
            process.terminate()
            process.wait()
