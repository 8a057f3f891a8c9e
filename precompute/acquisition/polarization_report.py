"""What a polarisation acquisition says of itself: NAME.report.json beside the map."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from precompute.files import written_aside

Share = Annotated[float, Field(ge=0, le=1)]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class PhotographLaid(_Part):
    """One photograph.

    Attributes:
        name: Its file.
        polariser_deg: Its polariser, as noted.
        shift_px: By how much it is off the first.
        turn_deg: By how much it is turned, clockwise as it is seen.
        quality: Correlation, no unit, of its edges with the first's within the sample, once it is
            laid on it.
        misfit: The ratio of how far it is off what the others foretell to how far these are; 0 of
            four and fewer.
        clipped: Share of the sample.
    """

    name: str
    polariser_deg: float
    shift_px: tuple[float, float]
    turn_deg: float
    quality: float
    misfit: float
    clipped: Share


class Circle(_Part):
    """The circle of modulations A e^{iη}/c.

    Attributes:
        centre: Real and imaginary part: what all pixels have in common.
        radius: A/c of the gratings, no unit.
        is_known: Whether orientations are spread enough to tell the centre; else it is 0.
    """

    centre: tuple[float, float]
    radius: float
    is_known: bool


class PolarizationReport(_Part):
    """What was seen and what was found.

    Attributes:
        photographs: Those that were used: all.
        angles: How many polariser angles differ modulo 180°.
        size: Columns and rows of the map.
        diffracting: Share of texels that diffract.
        unknown: Share that is clipped or out of the picture somewhere.
        doubtful: Share of those that diffract whose confidence is 0.
        correlation: Mean, over those that diffract, of photographs with the fit, no unit.
        residual: Median, likewise, of the ratio of the standard deviation from the fit to the mean;
            None of three photographs.
        noise_deg: Median standard deviation of orientations by it.
        circle: Of modulations.
        offset_deg: Between half of a phase and the orientation; 0 if it was not said, and
            orientations are relative then.
        is_relative: Whether it was not.
        periods_um: Shortest and longest, as they were said or assumed; equal where all have one.
        remarks: What was assumed or not given.
    """

    photographs: list[PhotographLaid]
    angles: int
    size: tuple[int, int]
    diffracting: Share
    unknown: Share
    doubtful: Share
    correlation: Share
    residual: float | None
    noise_deg: float
    circle: Circle
    offset_deg: float
    is_relative: bool
    periods_um: tuple[float, float]
    remarks: list[str]

    def lines(self) -> list[str]:
        """The report for people to read, a line each."""
        farthest = max(max(map(abs, photograph.shift_px)) for photograph in self.photographs)
        worst = min(photograph.quality for photograph in self.photographs)
        shortest, longest = self.periods_um
        periods = f"{shortest:g} µm, all of them"
        if shortest != longest:
            periods = f"{shortest:g} to {longest:g} µm by brightness, a heuristic"
        residual = "" if self.residual is None else f", residual {self.residual:.4f} of the mean"
        relative = ", up to one offset for all" if self.is_relative else ""
        return [
            f"photographs  {len(self.photographs)} at {self.angles} angles, up to "
            f"{farthest:.2f} px off the first, quality {worst:.3f} or more",
            f"texels       {self.diffracting:.1%} of {self.size[0]} × {self.size[1]} diffract, "
            f"{self.unknown:.1%} unknown",
            f"fit          correlation {self.correlation:.3f}{residual}, "
            f"modulation {self.circle.radius:.4f}",
            f"orientation  ± {self.noise_deg:.2f} degrees by noise{relative}, "
            f"{self.doubtful:.1%} without confidence",
            f"periods      {periods}",
        ]

    def write(self, file: Path) -> None:
        """Write it as JSON."""
        with written_aside(file) as aside:
            aside.write_text(self.model_dump_json(indent=1) + "\n", "utf-8")
