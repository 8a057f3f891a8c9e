"""One profile of each kind, with parameters other than their defaults."""

from precompute.profiles import Blazed, Profile, Rectangular, Sampled, Sinusoidal, Triangular

PROFILES: list[Profile] = [
    Sinusoidal(),
    Rectangular(duty=0.3),
    Blazed(),
    Triangular(apex=0.4),
    Sampled(heights=(0.0, 0.7, 1.0, 0.9, 0.2)),
]
