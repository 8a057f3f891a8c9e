"""The methods that can be asked about a grating; apart, so that the command line starts fast."""

from typing import Literal

Method = Literal["reference", "closed-form", "wavelength-loop"]
"""The float64 integral, the shipped closed form, and the papers' sum over wavelengths."""
