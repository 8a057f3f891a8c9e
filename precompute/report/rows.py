"""The report's numbers: what report.json holds."""

from __future__ import annotations

from math import log2
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

import precompute
from precompute.report.scenes import Lighting, SurfaceName
from precompute.report.shader_cost import StaticCost

Finite = Annotated[float, Field(allow_inf_nan=False)]
Share = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Ratio = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Count = Annotated[int, Field(ge=0)]
Missing = Field(default=None, exclude_if=lambda value: value is None)
"""A field that report.json leaves out where there is nothing to say; others are null."""


class _Entry(BaseModel):
    model_config = ConfigDict(extra="forbid")


class Row(_Entry):
    """One scene drawn by one method.

    Attributes:
        scene: File of tests/scenes without extension.
        surface: Kind of the surface.
        lighting: Kind of its lights.
        method: Name of the method.
        seed: Whether it is a method of the papers.
        knobs: The method's settings.
        rel_rmse: Of linear XYZ radiance, float32 read back against float64 at 1 nm.
        delta_e2000_median: Median ΔE2000 of lit pixels.
        delta_e2000_p95: 95th percentile.
        flip_mean: Mean FLIP difference.
        time_ratio: Frame time over MeshStandardMaterial's: the median of the launches.
        time_ratio_min: The smallest of the launches.
        time_ratio_max: The largest.
        static: Instructions of the fragment shader; missing where they could not be counted.
        texture_bytes: Size of the tables it reads.
        pareto: No row of this scene has both lower error and lower time.
    """

    scene: str
    surface: SurfaceName
    lighting: Lighting
    method: str
    seed: bool
    knobs: dict[str, int | float]
    rel_rmse: Share
    delta_e2000_median: Share
    delta_e2000_p95: Share
    flip_mean: Share
    time_ratio: Ratio
    time_ratio_min: Ratio
    time_ratio_max: Ratio
    static: StaticCost | None = Missing
    texture_bytes: Count
    pareto: bool = False


class Stability(_Entry):
    """A case at the edge of what a method is for.

    Attributes:
        case: What is drawn or summed.
        method: By which method.
        samples: Number of pixels, of amplitudes of lines, or of pairs of directions; 0 where the
            method is refused.
        non_finite: Of them NaN or infinite.
        negative_energy: Of them with negative luminance.
        max_albedo: Largest share of the light that is returned, over the metal's own; ``null``
            where it was not measured.
        rel_rmse: In a furnace the root mean square of the albedo's distance from 1, else the
            relative one against float64; ``null`` where there is nothing to compare.
        float: Precision of the method's tables; it reckons in fp32.
        refused: What the bake says in place of making a map; missing where it makes one.
    """

    case: str
    method: str
    samples: Count
    non_finite: Count
    negative_energy: Count
    max_albedo: Finite | None
    rel_rmse: Share | None
    float: Literal["fp16", "fp32"]
    refused: str | None = Missing


class LeftOut(_Entry):
    """What a scene does not pay for.

    Attributes:
        scene: The scene.
        feature: What its shader leaves out.
        why: Why it can.
        saved_time: In frames of MeshStandardMaterial.
        saved_instructions: Of the fragment shader.
        saved_bytes: Of tables.
    """

    scene: str
    feature: str
    why: str
    saved_time: Finite
    saved_instructions: int
    saved_bytes: int


class Acquisition(_Entry):
    """A measured map against the truth it was simulated from.

    Attributes:
        case: What was measured.
        figure: The quantity.
        unit: Its unit.
        truth: What it should be.
        value: What it came to.
        spread: Its standard deviation.
        paper: What the paper reports.
        paper_spread: Its standard deviation there.
        photographs: Number of photographs.
        noise_db: Their signal to noise ratio at full scale, dB; ``null`` without noise.
        seed: Whether it was measured by the papers' method.
    """

    case: str
    figure: str
    unit: str
    truth: Finite
    value: Finite
    spread: Share
    paper: Finite | None = Missing
    paper_spread: Share | None = Missing
    photographs: Count
    noise_db: Finite | None
    seed: bool = False


class MinifiedFoil(_Entry):
    """A foil of which a pixel covers many texels, against the mean over many subpixels.

    Attributes:
        foil: Name of its map.
        texels: Of the map to a pixel, along each axis.
        shown: What a pixel shows.
        mean_error: Mean absolute difference of radiance over the mean radiance.
        brightness: Mean radiance over that of the subpixels.
        flicker: Deviation of a pixel while the camera moves by less than one, over that of the
            mean of the subpixels.
    """

    foil: str
    texels: Ratio
    shown: str
    mean_error: Share
    brightness: Ratio
    flicker: Share


class BakeCost(_Entry):
    """`diffraction bake` of one series of a square height field.

    Attributes:
        size: Samples along each side.
        terms: Of the series.
        seconds: From the start of the command to its end.
        baking_seconds: Of these, once Python and its modules were loaded.
        peak_bytes: Most memory it held.
        map_bytes: Size of the files it wrote.
    """

    size: Annotated[int, Field(ge=2)]
    terms: Count
    seconds: Ratio
    baking_seconds: Ratio
    peak_bytes: Count
    map_bytes: Count

    @property
    def seconds_per_step(self) -> float:
        """Time of baking over n log₂ n, n being the number of samples."""
        samples = self.size**2
        return self.baking_seconds / (samples * log2(samples))


class Report(_Entry):
    """report.json."""

    generated_by: Literal["npm run report"] = "npm run report"
    version: str = precompute.__version__
    backend: str
    threads: Count
    rows: list[Row]
    stability: list[Stability] = []
    left_out: list[LeftOut] = []
    acquisition: list[Acquisition] = []
    minified: list[MinifiedFoil] = []
    bake_cost: list[BakeCost] = []

    def furnaces(self) -> list[Stability]:
        """The white furnaces, which are drawn by the closed form."""
        return [entry for entry in self._gratings() if entry.max_albedo is not None]

    def edges(self) -> list[Stability]:
        """The closed form of gratings at the edges."""
        return [entry for entry in self._gratings() if entry.max_albedo is None]

    def _gratings(self) -> list[Stability]:
        return [entry for entry in self.stability if entry.method == "closed-form"]

    def to_json(self) -> str:
        """The file's text."""
        return self.model_dump_json(indent=1) + "\n"


def mark_pareto(rows: list[Row]) -> None:
    """Set `pareto` of each row: no other row of its scene has both lower error and lower time."""
    for row in rows:
        row.pareto = not any(
            other.rel_rmse < row.rel_rmse and other.time_ratio < row.time_ratio
            for other in rows
            if other.scene == row.scene
        )
