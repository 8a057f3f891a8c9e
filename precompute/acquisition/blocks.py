"""A function run over blocks of pixels: in threads here, or on a Dask cluster there.

Blocks are the same in both, so that results are too, to the byte, as long as processors are of one
kind and packages of one version: the latter is checked. Nothing of Dask is imported without a
scheduler.
"""

from __future__ import annotations

import asyncio
import logging
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import CancelledError, Executor, ThreadPoolExecutor
from contextlib import contextmanager
from os import cpu_count
from typing import Any, Protocol, TypeVar

from precompute.errors import InputError

Block = TypeVar("Block")
Result = TypeVar("Result")

TIMEOUT_S = 10
"""Within which a scheduler answers and has asked all its workers."""

AHEAD, MOST_AHEAD = 2, 64
"""Blocks a processor that are under way at once, so that none waits for its next one, and how many
at the most: those of a cluster are copies, of some MB each."""

ALIKE = ("precompute", "numpy", "opencv-python-headless", "python", "dask", "distributed")
"""Whose versions must be the same on a cluster as here."""


class Run(Protocol):
    """Gives results of a function in the order of its blocks, which are taken as they are needed.

    Where blocks are left, by an error or an interruption, those that have not begun are cancelled.
    """

    def __call__(
        self, work: Callable[[Block], Result], blocks: Iterable[Block]
    ) -> Iterator[Result]: ...


def in_threads(
    work: Callable[[Block], Result], blocks: Iterable[Block]
) -> Generator[Result, None, None]:
    """A `Run` on this machine, a thread for each of its processors.

    >>> list(in_threads(abs, [-2, 1, -3]))
    [2, 1, 3]
    """
    threads = cpu_count() or 1
    with ThreadPoolExecutor(threads) as pool:
        yield from _in_order(pool, AHEAD * threads, work, blocks)


@contextmanager
def on_cluster(address: str) -> Iterator[Run]:
    """A `Run` on a Dask cluster. Functions and blocks go there by pickle.

    Args:
        address: Of its scheduler, as in ``tcp://10.0.0.1:8786``.

    Raises:
        InputError: Dask is not installed here, no scheduler answers at the address, it has no
            workers, it or one of them has other versions of `ALIKE`, or the cluster is lost.
    """
    try:
        from distributed import Client, KilledWorker
    except ImportError as error:
        raise _unusable(address, "pip install 'precompute[cluster]' to use one") from error
    # What is lost is said by an error here, once.
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    threads = _threads(address)
    with Client(address, timeout=TIMEOUT_S, set_as_default=False) as client:
        executor = client.get_executor(pure=False)

        def run(work: Callable[[Block], Result], blocks: Iterable[Block]) -> Iterator[Result]:
            ahead = min(AHEAD * threads, MOST_AHEAD)
            try:
                yield from _in_order(executor, ahead, work, blocks)
            except (CancelledError, KilledWorker, OSError) as error:
                raise _unusable(address, f"a cluster that stays: {error!r}") from error

        yield run


@contextmanager
def running(scheduler: str | None) -> Iterator[Run]:
    """Threads here, or a cluster where the address of its scheduler is given; see `on_cluster`."""
    if scheduler is None:
        yield in_threads
    else:
        with on_cluster(scheduler) as run:
            yield run


def _in_order(
    executor: Executor, ahead: int, work: Callable[[Block], Result], blocks: Iterable[Block]
) -> Iterator[Result]:
    under_way = deque()
    try:
        for block in blocks:
            under_way.append(executor.submit(work, block))
            if len(under_way) == ahead:
                yield under_way.popleft().result()
        while under_way:
            yield under_way.popleft().result()
    finally:
        for future in under_way:
            future.cancel()


def _threads(address: str) -> int:
    """How many threads a cluster's workers have together, once versions are found alike.

    Asked before there is a client, which would wait for ever for what is no scheduler.
    """
    try:
        threads, versions = asyncio.run(asyncio.wait_for(_asked(address), TIMEOUT_S))
    except TimeoutError as error:
        raise _unusable(address, f"a Dask scheduler that answers within {TIMEOUT_S} s") from error
    except (OSError, TypeError, ValueError) as error:
        raise _unusable(address, f"the address of a Dask scheduler ({error})") from error
    if threads == 0:
        raise _unusable(address, "a Dask scheduler with one worker or more")
    here = versions.pop("here")
    for place, there in versions.items():
        other = [f"{name} {there[name] or 'none'}" for name in ALIKE if there[name] != here[name]]
        if other:
            needed = [f"{name} {here[name]}" for name in ALIKE if there[name] != here[name]]
            expected = f"{', '.join(needed)} at {place} as here, not {', '.join(other)}"
            raise _unusable(address, expected)
    return threads


async def _asked(address: str) -> tuple[int, dict[str, dict[str, str | None]]]:
    """Threads of all workers, and versions of packages here, at the scheduler and at each worker.

    Raises:
        OSError: Nothing is there.
        TypeError: The address asks for encryption, and Dask's configuration has no certificates.
        ValueError: It is no address, or not a scheduler's.
    """
    from distributed.core import rpc
    from distributed.security import Security
    from distributed.versions import get_versions

    packages = list(ALIKE)
    encryption = Security().get_connection_args("client")
    # Where nobody listens it is tried again until then: before all of the time is up.
    scheduler: Any = rpc(address, timeout=TIMEOUT_S / 2, connection_args=encryption)
    async with scheduler:
        identity = await scheduler.identity()
        if identity["type"] != "Scheduler":
            raise ValueError(f"a {identity['type'].lower()} is there")
        message = {"op": "versions", "packages": packages}
        seen = {"here": get_versions(packages)}
        seen["the scheduler"] = await scheduler.versions(packages=packages)
        seen |= await scheduler.broadcast(msg=message, on_error="ignore")
        versions = {place: one["packages"] for place, one in seen.items()}
        return identity["total_threads"], versions


def _unusable(address: str, expected: str) -> InputError:
    return InputError("options", "scheduler", address, expected)
