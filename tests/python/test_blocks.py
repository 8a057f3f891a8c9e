"""A function run over blocks: in order, not too many at once, and none after the last is wanted."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import closing

import pytest
from refusals import refused

from precompute.acquisition import blocks
from precompute.acquisition.blocks import AHEAD, in_threads, on_cluster, running


def test_results_are_in_the_order_of_blocks() -> None:
    """Each of four is done before the one that precedes it."""

    def late(block: int) -> int:
        time.sleep(0.02 * (3 - block % 4))
        return block**2

    assert list(in_threads(late, range(10))) == [block**2 for block in range(10)]


def test_blocks_are_taken_as_they_are_needed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(blocks, "cpu_count", lambda: 2)
    taken = []

    def numbers() -> Iterator[int]:
        for number in range(50):
            taken.append(number)
            yield number

    with closing(in_threads(abs, numbers())) as results:
        assert next(results) == 0 and len(taken) == 2 * AHEAD
        assert next(results) == 1 and len(taken) == 2 * AHEAD + 1


def test_nothing_begins_after_an_error_or_an_interruption(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(blocks, "cpu_count", lambda: 1)
    begun = []

    def work(block: int) -> int:
        begun.append(block)
        time.sleep(0.05)
        return 1 // (block - 1)

    with pytest.raises(ZeroDivisionError):
        list(in_threads(work, range(20)))
    assert max(begun) <= 2
    begun.clear()
    with closing(in_threads(work, [3, 4, 5, 6])) as results:
        next(results)
    assert len(begun) <= 2


def test_without_a_scheduler_nothing_of_dask_is_imported() -> None:
    with running(None) as run:
        assert run is in_threads
    program = "import sys, precompute.acquisition.polarization as _; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert "precompute.acquisition.blocks" in done.stdout.split()
    assert not {"dask", "distributed"} & set(done.stdout.split())


@pytest.mark.parametrize("place", ["the scheduler", "tcp://10.0.0.2:40001"])
def test_other_versions_are_refused(place: str, monkeypatch: pytest.MonkeyPatch) -> None:
    here = dict.fromkeys(blocks.ALIKE, "2.0")
    places = {"the scheduler": here, "tcp://10.0.0.1:40001": here, "tcp://10.0.0.2:40001": here}
    versions = {"here": here, **places, place: here | {"numpy": "1.9", "precompute": None}}

    async def asked(address: str) -> tuple[int, dict[str, dict[str, str | None]]]:
        return 2, dict(versions)

    monkeypatch.setattr(blocks, "_asked", asked)
    expected = f"precompute 2.0, numpy 2.0 at {place} as here, not precompute none, numpy 1.9"
    with refused("options", "scheduler", "tcp://10.0.0.1:8786", expected):
        with on_cluster("tcp://10.0.0.1:8786"):
            pass
