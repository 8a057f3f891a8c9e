"""What `diffraction inspect` says of a height field."""

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from precompute.cli import app
from precompute.height_fields.generate import generated
from precompute.height_fields.inspection import period_estimate
from precompute.height_fields.recipe import Blazed, Cosine


def test_a_blazed_gratings_period_is_found_by_diffraction() -> None:
    """The thesis' evaluation, on a period of 2.5 µm, to 2 nm."""
    estimate = period_estimate(generated(Blazed(period=2.5)))
    assert len(estimate.periods) == 41  # every 10 nm from 380 to 780
    assert np.abs(estimate.periods - 2.5).max() < 0.002
    assert estimate.periods.var() < 1e-6


@pytest.mark.parametrize("period", [0.8, 1.25])
def test_viewing_angles_obey_the_grating_equation(period: float) -> None:
    estimate = period_estimate(generated(Cosine(period=period, height=0.1)))
    sine = np.sin(np.deg2rad(75)) - estimate.wavelengths / period
    assert len(sine) > 20
    np.testing.assert_allclose(np.sin(estimate.angles), sine, atol=0.002)


def test_inspect_says_and_draws_what_is_in_a_field(tmp_path: Path) -> None:
    recipe = tmp_path / "wave.json"
    source = {"kind": "cosine", "period": 1.25, "height": 0.2}
    recipe.write_text(json.dumps({"kind": "height-field", "source": source}))
    result = CliRunner().invoke(app, ["inspect", str(recipe), "-o", str(tmp_path / "pictures")])
    assert result.exit_code == 0
    text = " ".join(result.stdout.split())
    assert "height, lowest to highest 0.2 um" in text
    assert "height, rms 0.0707107 um" in text  # 0.2/√8
    assert "period 1.25 um at 0.0 deg, 100.0 % of h²" in text
    assert "jacobi-anger, largest phase 3.307 rad" in text  # 4π/0.38 · 0.1
    assert "taylor, largest phase 6.614 rad" in text
    assert "period by diffraction at 75 deg 1.2" in text
    pictures = sorted(file.name for file in (tmp_path / "pictures").iterdir())
    assert pictures == ["wave-brdf.png", "wave-heights.png"]


def test_inspecting_a_field_that_cannot_be_made_ends_with_one_line(tmp_path: Path) -> None:
    recipe = tmp_path / "lost.json"
    source = {"kind": "file", "path": "missing.npy", "height_um": 1, "pitch_um": 0.05}
    recipe.write_text(json.dumps({"kind": "height-field", "source": source}))
    result = CliRunner().invoke(app, ["inspect", str(recipe)])
    assert result.exit_code != 0
    assert "missing.npy" in result.output
    assert "Traceback" not in result.output
