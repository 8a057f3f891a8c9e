"""What was measured of one scene, before it becomes rows, pictures and text."""

from __future__ import annotations

from dataclasses import dataclass

from precompute.report.comparison import Comparison
from precompute.report.rows import Row, mark_pareto
from precompute.report.scenes import Scene
from precompute.report.shader_cost import StaticCost
from precompute.report.timing import Times

SHARED_TABLES = frozenset(["uLightNodes", "uEnvironmentNodes", "uLobeTable"])
"""Uniforms of tables that belong to the light, whatever the surface."""


@dataclass(frozen=True)
class MethodResult:
    """One method's picture.

    Attributes:
        comparison: Its error.
        tables: Bytes of each table that its shader reads, by the uniform's name.
        static: Instructions of its shader, None where they could not be counted.
    """

    comparison: Comparison
    tables: dict[str, int]
    static: StaticCost | None

    @property
    def texture_bytes(self) -> int:
        """Size of all the tables."""
        return sum(self.tables.values())

    @property
    def own_bytes(self) -> int:
        """Size of those that are the surface's: spectra and lobes serve all surfaces."""
        return sum(size for name, size in self.tables.items() if name not in SHARED_TABLES)


@dataclass(frozen=True)
class SceneResult:
    """One scene's pictures, in the order of its methods, and their times."""

    scene: Scene
    methods: tuple[MethodResult, ...]
    times: Times

    def rows(self) -> list[Row]:
        """The scene's rows of report.json."""
        rows = [self._row(index) for index in range(len(self.methods))]
        mark_pareto(rows)
        return rows

    def first(self, method: str) -> str:
        """Name, among the timed materials, of the scene's first method of that name."""
        return next(str(i) for i, m in enumerate(self.scene.methods) if m.method == method)

    def _row(self, index: int) -> Row:
        method, result = self.scene.methods[index], self.methods[index]
        ratios = self.times.ratios(str(index))
        return Row(
            scene=self.scene.name,
            surface=self.scene.surface,
            lighting=self.scene.lighting,
            method=method.method,
            seed=method.seed,
            knobs=method.knobs.stated(),
            rel_rmse=result.comparison.rel_rmse,
            delta_e2000_median=result.comparison.delta_e2000_median,
            delta_e2000_p95=result.comparison.delta_e2000_p95,
            flip_mean=result.comparison.flip_mean,
            time_ratio=self.times.ratio(str(index)),
            time_ratio_min=min(ratios),
            time_ratio_max=max(ratios),
            static=result.static,
            texture_bytes=result.texture_bytes,
        )
