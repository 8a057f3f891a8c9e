"""Rows of orientations in polarised light."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from precompute.acquisition.jones import Plastic
from precompute.report.polarization_model import (
    ORIENTATIONS,
    PICTURE,
    found_orientations,
    polarization_model_rows,
)

RATIO = complex(1.001 * np.exp(1j * np.radians(172)))


def off_deg(found: np.ndarray) -> np.ndarray:
    return np.degrees(np.abs(np.mod(found - ORIENTATIONS + np.pi / 2, np.pi) - np.pi / 2))


@pytest.mark.parametrize("is_normalised", [False, True])
def test_without_retardation_half_the_phase_is_the_orientation(is_normalised: bool) -> None:
    assert off_deg(found_orientations(RATIO, Plastic(), is_normalised)).max() < 1e-3


def test_retarding_plastic_is_harmless_over_the_means_only() -> None:
    """sin 2Δ = 0.105 from the mirror, A = 0.14 from gratings: half of arcsin(0.75), 24 deg."""
    plastic = Plastic(np.radians(3))
    assert off_deg(found_orientations(RATIO, plastic, False)).max() == pytest.approx(24, abs=1)
    assert off_deg(found_orientations(RATIO, plastic, True)).max() < 0.2


def test_rows_and_their_picture(tmp_path: Path) -> None:
    rows = list(polarization_model_rows(tmp_path))
    assert len({row.case for row in rows}) == len(rows)
    assert all(row.truth == 0 and row.noise_db is None for row in rows)
    assert Image.open(tmp_path / PICTURE).width == 900
