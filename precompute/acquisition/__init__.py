"""Foils from photographs: what a capture is told, its simulation, and its solution."""
