"""Rough costs of answers in seconds of one core, from the inputs alone.

The service uses them to choose where an answer is computed and to refuse one that takes too long. Each formula is a fit
to measured times on one core of 2 GHz; an error of a factor of two does no harm.
"""

from __future__ import annotations

FIRST_S = 0.05
"""What every heavy answer costs at least, to load its solver among others."""


def program_s(horizon_s: float) -> float:
    """One cone program over a horizon: 7 ms at 60 s, 0.1 s at 300 s, 0.7 s at 600 s."""
    return 0.006 * horizon_s / 60.0 + 0.65 * float((horizon_s / 600.0) ** 3)


def region_s(horizon_s: float) -> float:
    """One safe-start region over a horizon: 0.3 s at 60 s, 4 s at 240 s, 40 s at 600 s."""
    return 0.28 * float((horizon_s / 60.0) ** 2.15)
