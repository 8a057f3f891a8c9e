"""Foils: maps of gratings that vary over the surface, designed by a recipe."""
