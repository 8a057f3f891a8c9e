"""From photographs of a stochastic foil to NAME.json, its distribution, and NAME.report.json."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from pydantic import BaseModel, ConfigDict

from precompute.acquisition.capture import Capture
from precompute.acquisition.flash_report import Share
from precompute.acquisition.shots import about_all, read_shots
from precompute.acquisition.stochastic import SEEN, Estimated, Method, estimate_distribution
from precompute.errors import InputError
from precompute.files import written_aside

UNSEEN = (
    "gratings of which less than {0:.0%} of the light would be in the photographs: 0 in the file"
)


class StochasticReport(BaseModel):
    """What was seen of a foil's distribution.

    Attributes:
        photographs: Those that were used.
        left_out: Why others were not, by name.
        is_relative: Whether periods are known but for a common factor.
        covered: Share of the cells whose gratings would have been seen.
        left_empty: Which would not, and what stands in the file for them.
        periods_um: The 1st percentile, the median and the 99th.
        height_um: Of the gratings, as was assumed.
        remarks: What was assumed.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    photographs: list[str]
    left_out: dict[str, str]
    is_relative: bool
    covered: Share
    left_empty: str
    periods_um: tuple[float, float, float]
    height_um: float
    remarks: list[str]


def acquire_stochastic(
    capture: Capture,
    folder: Path,
    output: Path,
    say: Callable[[str], None],
    height: float = 0.15,
    method: Method = "deconvolution",
    draw: Callable[[InputError], InputError] = lambda error: error,
) -> list[Path]:
    """Estimate a foil's distribution and write it.

    Args:
        capture: Of a sample that is stochastic.
        folder: That of the capture file.
        output: NAME, with its folder.
        say: Takes remarks as they arise.
        height: Of the gratings, µm.
        method: See `estimate_distribution`.
        draw: See `read_shots`.

    Returns:
        The distribution's file, which ``diffraction design stochastic`` takes, and the report's.

    Raises:
        InputError: As `read_shots` and `estimate_distribution`.
    """
    remarks: list[str] = []

    def remark(text: str) -> None:
        remarks.append(text)
        say(text)

    taken = read_shots(capture, folder, remark, draw)
    size = capture.sample.size_mm
    try:
        estimated = estimate_distribution(taken.shots, size, height, method)
    except InputError as error:
        raise about_all(error, taken, size) from error
    report = StochasticReport(
        photographs=[shot.name for shot in taken.shots],
        left_out={name: str(error) for name, error in taken.left_out.items()},
        is_relative=not taken.shots[0].rectification.is_scaled,
        covered=estimated.covered,
        left_empty=UNSEEN.format(SEEN),
        periods_um=_periods(estimated),
        height_um=height,
        remarks=remarks,
    )
    files = [output.parent / f"{output.name}{end}" for end in (".json", ".report.json")]
    estimated.distribution.write(files[0])
    with written_aside(files[1]) as aside:
        aside.write_text(report.model_dump_json(indent=1) + "\n", "utf-8")
    return files


def _periods(estimated: Estimated) -> tuple[float, float, float]:
    distribution = estimated.distribution
    shares = distribution.weights.sum(axis=0)
    known = np.cumsum(shares[::-1])
    edges = 1 / distribution.frequency_edges[::-1]
    at = np.interp([0.01, 0.5, 0.99], np.concatenate([[0], known]), edges)
    return float(at[0]), float(at[1]), float(at[2])
