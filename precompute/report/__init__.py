"""Error against run time: the scenes of tests/scenes, drawn in Chromium, and the reference."""
