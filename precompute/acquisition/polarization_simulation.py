"""The recipe of polarisation photographs that nobody took: a foil, a panel, a camera, angles."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, TypeAdapter, model_validator

from precompute.acquisition.capture import Filter, Vector
from precompute.acquisition.taking import Albedo, Length, Part, Taking
from precompute.gratings import Positive
from precompute.recipes import Illuminant, validated
from precompute.spectra import IndexedMetal

Angle = Annotated[float, Field(ge=-360, le=360)]
Omitted = Literal[
    "camera.position_mm",
    "camera.rotation_deg",
    "camera.focal_px",
    "camera.distortion",
    "camera.spectral_response_csv",
    "photographs.corners_px",
]


class Ratio(Part):
    """R = R_−/R_+ = r e^{iζ} of a grating, in place of a metal's.

    Attributes:
        r: Its size.
        zeta_deg: Its angle.
    """

    r: Annotated[float, Field(ge=1e-4, le=1e4)]
    zeta_deg: Angle


class Metal(Part):
    """What the gratings are pressed into.

    Attributes:
        kind: Whose index of refraction.
        angle_deg: Angle of incidence, in air, at which Fresnel's ratio for it is the gratings' R.
        ratio: R itself.
    """

    kind: IndexedMetal = "aluminium"
    angle_deg: Annotated[float, Field(ge=0, le=60)] = 10.0
    ratio: Ratio | None = None


class Layer(Part):
    """The plastic over the metal.

    Attributes:
        index: Of refraction.
        retardation_deg: Δ at 0.55 µm, each way; at others in inverse proportion to wavelength.
        axis_deg: Of its fast axis, from x.
        first_surface: r_p, amplitude that its upper side reflects; by its index if left out.
        first_surface_phase_deg: Of that over what the metal reflects.
        first_surface_retardation_deg: Of that, at 0.55 µm.
    """

    index: Annotated[float, Field(ge=1, le=2.5)] = 1.468
    retardation_deg: Annotated[float, Field(ge=0, le=90)] = 0.0
    axis_deg: Angle = 0.0
    first_surface: Annotated[float, Field(gt=-1, lt=1)] | None = None
    first_surface_phase_deg: Angle = 0.0
    first_surface_retardation_deg: Annotated[float, Field(ge=0, le=90)] = 0.0


class Sheet(Part):
    """The sheet and how far from ideal it is.

    Attributes:
        size_mm: Width and height; a larger sheet than the foil's tile shows it repeatedly.
        bare: What shows where nothing diffracts, ``mirror`` or ``matte``.
        bare_albedo: Of what is matte there.
        haze: Albedo of what the plastic scatters everywhere.
        table: Albedo of what the sheet lies on.
        bumps_deg: Standard deviation of the normal from point to point, along each axis.
        bump_mm: How far apart points are whose normals differ, a Gaussian's standard deviation.
    """

    size_mm: tuple[Positive, Positive]
    bare: Literal["mirror", "matte"] = "mirror"
    bare_albedo: Albedo = 0.5
    haze: Albedo = 0.02
    table: Albedo = 0.3
    bumps_deg: Annotated[float, Field(ge=0, le=10)] = 0.0
    bump_mm: Positive = 5.0


class Panel(Part):
    """A disc of circularly polarised light, parallel to the sheet.

    Attributes:
        position_mm: Of its middle.
        radius_mm: Of its disc.
        falloff: Its radiance goes with the cosine of the angle at which it is seen to this power.
        spectrum: Illuminant by name, or a CSV beside the recipe.
    """

    position_mm: Vector
    radius_mm: Positive = 150.0
    falloff: Annotated[float, Field(ge=0, le=20)] = 2.0
    spectrum: Illuminant = "LED-B3"

    @model_validator(mode="after")
    def _in_front(self) -> Panel:
        if self.position_mm[2] <= 0:
            raise ValueError("a position_mm in front of the sample, its z above 0")
        return self


class Handling(Part):
    """What differs between photographs that should not; standard deviations.

    Attributes:
        polariser_deg: Of the polariser's angle from what is noted.
        shift_px: Of each coordinate of what the camera shows.
        turn_deg: Of its turn about the picture's middle.
        light: Of the panel's brightness, over itself.
    """

    polariser_deg: Annotated[float, Field(ge=0, le=45)] = 0.0
    shift_px: Length = 0.0
    turn_deg: Annotated[float, Field(ge=0, le=45)] = 0.0
    light: Annotated[float, Field(ge=0, le=0.3)] = 0.0


class PolarizationSimulation(Taking):
    """A polarisation capture to be simulated.

    Attributes:
        metal: Under its gratings.
        plastic: Over them.
        sheet: What is photographed.
        panel: The light.
        filter: Before the camera.
        polariser_deg: ψ of each photograph, from x.
        exposures_s: Of each photograph. A mirror reaches full scale in 1 s.
        handling: What differs between photographs; the first is as it should be.
        omit: What the capture file does not say.
        step_nm: Of wavelength.
    """

    kind: Literal["polarization-capture"]
    metal: Metal = Metal()
    plastic: Layer = Layer()
    sheet: Sheet
    panel: Panel
    filter: Filter | None = Filter(peak_um=0.55, fwhm_um=0.03)
    polariser_deg: Annotated[tuple[Angle, ...], Field(min_length=1)]
    exposures_s: Annotated[tuple[Positive, ...], Field(min_length=1)] = (0.5,)
    handling: Handling = Handling()
    omit: tuple[Omitted, ...] = ()
    step_nm: Annotated[int, Field(ge=1, le=20)] = 10

    @property
    def first_surface(self) -> float:
        """r_p, a ratio of amplitudes: as stated, or Fresnel's at normal incidence from air."""
        stated = self.plastic.first_surface
        index = self.plastic.index
        return (1 - index) / (1 + index) if stated is None else stated


_SIMULATION: TypeAdapter[PolarizationSimulation] = TypeAdapter(PolarizationSimulation)


def read_polarization_simulation(file: Path) -> PolarizationSimulation:
    """Read the recipe of a simulated polarisation capture.

    Raises:
        InputError: It is missing, no JSON, or a field is unknown, missing or out of range.
    """
    return validated(file, _SIMULATION)
