"""What the diffraction shaders look up, and the float64 reference they are checked against."""

__version__ = "0.1.0"
