"""Height fields: measured or generated micro-relief, and what the shaders look up of it."""
