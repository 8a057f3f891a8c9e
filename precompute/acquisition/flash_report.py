"""What a flash acquisition says of itself: NAME.report.json beside the map."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from precompute.files import written_aside

Share = Annotated[float, Field(ge=0, le=1)]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class PhotographSeen(_Part):
    """One photograph.

    Attributes:
        name: Its file.
        highlight_px: Where the lamp's mirror image is.
        light_mm: Where the lamp is by that.
        light_off_mm: How far that is from what was said of it.
        period_over_all: The ratio of the period that it alone shows to that which all show.
    """

    name: str
    highlight_px: tuple[float, float]
    light_mm: tuple[float, float, float]
    light_off_mm: float
    period_over_all: float


class Shares(_Part):
    """Of the map's texels.

    Attributes:
        seen: The share that is lit in some photograph, and unambiguous.
        unsure: The share that is lit, but another orientation would do nearly as well.
        dark: The share without a grating: every orientation would have been lit somewhere.
        hidden: The share that is dark, but some orientation would have been too: the one that would
            have shown least is taken.
    """

    seen: Share
    unsure: Share
    dark: Share
    hidden: Share


class FlashReport(_Part):
    """What was seen, what was found, and what was filled in.

    Attributes:
        photographs: Those that were used.
        left_out: Why others were not, by name.
        tile_mm: Width and height of what repeats.
        tiles: Columns and rows of tiles, those at the edges counted whole.
        shift_mm: Median by which tiles are off their places.
        largest_shift_mm: The most.
        roughness_deg: Standard deviation of the normal by the width of lobes.
        is_one_period: Whether all gratings were solved as of one period.
        is_relative: Whether periods are known but for a common factor.
        periods_um: The 1st percentile, the median and the 99th.
        texels: How they came about.
        explained: Share of the light outside the highlights that the map explains.
        remarks: What was assumed, left out or inconsistent.
    """

    photographs: list[PhotographSeen]
    left_out: dict[str, str]
    tile_mm: tuple[float, float]
    tiles: tuple[int, int]
    shift_mm: float
    largest_shift_mm: float
    roughness_deg: float
    is_one_period: bool
    is_relative: bool
    periods_um: tuple[float, float, float]
    texels: Shares
    explained: float
    remarks: list[str]

    def lines(self) -> list[str]:
        """The report for people to read, a line each."""
        shortest, median, longest = self.periods_um
        unit = "of unknown scale" if self.is_relative else "µm"
        periods = f"{median:.3f} {unit}"
        if not self.is_one_period:
            periods = f"{shortest:.3f} to {longest:.3f} {unit}, median {median:.3f}"
        share = self.texels
        return [
            f"photographs  {len(self.photographs)} used, {len(self.left_out)} left out",
            f"tiles        {self.tiles[0]} × {self.tiles[1]} of {self.tile_mm[0]:.2f} × "
            f"{self.tile_mm[1]:.2f} mm, {self.shift_mm:.2f} mm off their places",
            f"periods      {periods}",
            f"roughness    {self.roughness_deg:.2f} degrees",
            f"explained    {self.explained:.1%} of the light outside the highlights",
            f"texels       {share.seen:.1%} seen, {share.unsure:.1%} unsure, "
            f"{share.dark:.1%} without grating, {share.hidden:.1%} hidden",
        ]

    def write(self, file: Path) -> None:
        """Write it as JSON."""
        with written_aside(file) as aside:
            aside.write_text(self.model_dump_json(indent=1) + "\n", "utf-8")
