"""Precompute what the diffraction shaders look up, and hold the float64 reference they are checked against."""

__version__ = "0.1.0"
