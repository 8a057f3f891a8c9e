"""What a camera makes of light: its channels' sensitivity, filters, noise."""

from __future__ import annotations

from pathlib import Path

import colour
import numpy as np
from numpy.typing import NDArray

from precompute.acquisition.capture import Camera, Filter, FlashLight
from precompute.acquisition.taking import SensorNoise
from precompute.files import written_aside
from precompute.spectra import WAVELENGTHS, illuminant, spectral_columns

Array = NDArray[np.float64]

CHANNELS: dict[str, tuple[str, ...]] = {"rgb": ("r", "g", "b"), "grey": ("grey",)}
TYPICAL = "Nikon 5100 (NPL)"
"""The sensor, measured by the National Physical Laboratory, that stands for cameras that say
nothing of their own."""


def sensitivity(camera: Camera, folder: Path) -> Array:
    """Relative sensitivity of a camera's channels on `WAVELENGTHS`.

    Args:
        camera: The camera; without a response of its own it is like `TYPICAL`, a grey one like the
            mean of its channels.
        folder: Where its CSV is.

    Returns:
        Shape (401, channels), its largest number 1.

    Raises:
        InputError: The CSV cannot be read or used.
    """
    if camera.spectral_response_csv is not None:
        names = CHANNELS[camera.channels]
        values = spectral_columns(folder / camera.spectral_response_csv, names)
    else:
        data = colour.MSDS_CAMERA_SENSITIVITIES[TYPICAL]
        columns = [np.interp(WAVELENGTHS, data.wavelengths / 1000, v) for v in data.values.T]
        values = np.stack(columns, axis=-1)
        if camera.channels == "grey":
            values = values.mean(axis=1, keepdims=True)
    return values / values.max()


def transmittance(filter_: Filter | None) -> Array:
    """Of a filter, the share of light, 1 where there is none, shape (401,).

    >>> green = transmittance(Filter(peak_um=0.53, fwhm_um=0.03))
    >>> [round(float(green[i]), 3) for i in (135, 150, 165)]  # 515, 530, 545 nm
    [0.5, 1.0, 0.5]
    """
    if filter_ is None:
        return np.ones_like(WAVELENGTHS)
    return np.exp(-4 * np.log(2) * ((WAVELENGTHS - filter_.peak_um) / filter_.fwhm_um) ** 2)


def channel_weights(
    light: FlashLight, filter_: Filter | None, sensitivity: Array, folder: Path
) -> Array:
    """S(λ) T(λ) r_c(λ): what channels make of light at each wavelength.

    Args:
        light: Its spectrum S, of power, 1 at its largest.
        filter_: Its transmittance T.
        sensitivity: r_c, shape (401, channels).
        folder: Where a spectrum's CSV is.

    Returns:
        Relative, as S and r_c are, shape (401, channels).

    Raises:
        InputError: The spectrum's CSV cannot be read or used.
    """
    name = folder / light.spectrum if light.spectrum.endswith(".csv") else light.spectrum
    return (illuminant(name) * transmittance(filter_))[:, None] * sensitivity


def noisy(values: Array, sensor: SensorNoise, rng: np.random.Generator) -> Array:
    """Light, shares of full scale, with the sensor's noise added, of any shape.

    Args:
        values: Light, shares of full scale.
        sensor: How noisy.
        rng: Draws the noise.
    """
    if sensor.full_well is not None:
        variance = np.maximum(values, 0) / sensor.full_well
        variance += (sensor.read_noise / sensor.full_well) ** 2
        return values + np.sqrt(variance) * rng.standard_normal(values.shape)
    if sensor.noise_db is not None:
        return values + 10 ** (-sensor.noise_db / 20) * rng.standard_normal(values.shape)
    return values


def write_response(file: Path, camera: Camera, response: Array) -> None:
    """Write the sensitivity of a camera's channels, shape (401, channels), for a capture.

    Args:
        file: A CSV.
        camera: Which channels there are.
        response: Relative sensitivities at `WAVELENGTHS`.
    """
    lines = [",".join(["wavelength_um", *CHANNELS[camera.channels]])]
    for λ, values in zip(WAVELENGTHS, response, strict=True):
        lines.append(",".join([f"{λ:.3f}", *(f"{value:.6g}" for value in values)]))
    with written_aside(file) as aside:
        aside.write_text("\n".join(lines) + "\n", "utf-8")
