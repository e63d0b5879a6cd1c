"""About how far a flight of the linear model is from one of two bodies with J2: an estimate, not a bound.

Over T seconds about T^2 / 2 times what the linear equations leave out: J2's gradient, 6 J2 (R_E / R)^2 mu / R^3 r,
and the second order of the point mass, 3 mu r^2 / R^4, both at the perigee (``benchmarks.model_error`` measures it).
"""

from __future__ import annotations

import math

from safestart.dynamics.two_body import J2
from safestart.exact.space.question import SpaceQuestion
from safestart.model.orbit import EARTH_RADIUS, MU
from safestart.model.scenario import Floats


def model_error(question: SpaceQuestion, state: Floats) -> float:
    """Metres, for a start ``state`` (6,) over the question's horizon; 0 without an orbit."""
    orbit, horizon = question.orbit, question.horizon
    if orbit.mean_motion == 0.0:
        return 0.0
    perigee = (MU / orbit.mean_motion**2) ** (1.0 / 3.0) * (1.0 - orbit.eccentricity)
    away = math.hypot(*state[:3].tolist()) + math.hypot(*state[3:].tolist()) * horizon
    bulge = 6.0 * J2 * (EARTH_RADIUS / perigee) ** 2 * MU / perigee**3 * away
    return float(0.5 * horizon**2 * (bulge + 3.0 * MU * away**2 / perigee**4))
