"""The table of a profile's diffraction efficiencies η_m(φ), which shaders look up."""

from __future__ import annotations

import numpy as np

from precompute.axes import Axis
from precompute.maps import Map, Table
from precompute.profiles import efficiency, efficiency_table
from precompute.recipes import ProfileRecipe


def profile_map(recipe: ProfileRecipe) -> Map:
    """Bake η_m(φ) of one profile.

    φ runs with the square of the texel's position, since η_m starts as φ^(2m) and a shallow
    grating's orders must keep their relative precision.

    Args:
        recipe: The profile and the table's extent.

    Returns:
        A map of kind ``profile`` with the array ``efficiency``, orders × phases.
    """
    order = Axis(
        name="order",
        symbol="m",
        unit="1",
        size=2 * recipe.max_order + 1,
        first=-recipe.max_order,
        last=recipe.max_order,
    )
    phase = Axis(
        name="phase",
        symbol="phi",
        unit="rad",
        size=recipe.samples,
        mapping="square",
        first=0,
        last=recipe.max_phase,
    )
    values = efficiency_table(recipe.profile, phase.parameters(), recipe.max_order)
    table = Table(values[..., None], (order, phase), ("eta",))
    return Map(
        kind="profile",
        quantity="diffraction efficiency of an order",
        symbol="eta_m(phi)",
        tables={"efficiency": table},
        error=_error_of_table(recipe, table),
        recipe=recipe.model_dump(),
        constants={
            "max_order": recipe.max_order,
            "max_phase": recipe.max_phase,
            "symmetric": float(np.allclose(values, values[::-1], atol=1e-6)),
        },
    )


def _error_of_table(recipe: ProfileRecipe, table: Table) -> dict[str, float | str]:
    """The stored table, interpolated midway between phases, against the closed form."""
    orders, phase = table.axes
    stored = Table(table.values.astype(np.float16).astype(np.float64), table.axes, table.channels)
    φ = phase.parameter_from_texel(np.arange(phase.size - 1) + 0.5)
    m = np.arange(-recipe.max_order, recipe.max_order + 1)
    exact = np.stack([efficiency(recipe.profile, int(order), φ) for order in m])
    found = stored.sample(*np.meshgrid(orders.parameters(), φ, indexing="ij"))[..., 0]
    return {
        "relative_rms": float(np.sqrt(np.mean((found - exact) ** 2) / np.mean(exact**2))),
        "against": "closed-form Fourier coefficients, midway between texels",
    }
