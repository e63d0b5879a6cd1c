"""Inverse problems of an approach: the angles at which it takes a given time or costs a given amount of fuel.

Time falls from 0 deg to a least value beyond the R-bar and rises again; fuel rises to a peak near 63 deg and falls
again. So no, one or several angles may exist; all of them up to the last fold are found.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from safestart.errors import invalid
from safestart.hopping.approach import Approach, approach, distances
from safestart.hopping.hop_time import fold_deg
from safestart.model.scenario import number

_SAMPLES = 181

MEASURES: dict[str, Callable[[Approach], float]] = {
    "orbits": lambda a: a.orbits,
    "fuel_1norm": lambda a: a.fuel_1norm,
    "fuel_2norm": lambda a: a.fuel_2norm,
}


def greatest_angle(start: float, hold: float, hops: int, gamma: float | None = None) -> float:
    """Angle, deg, up to which every hop of the approach exists; 180 where none has a fold."""
    d = distances(start, hold, hops, gamma)
    folds = [fold_deg(rho) for rho in (d[1:] / d[:-1]).tolist()]
    return min((fold for fold in folds if fold is not None), default=180.0)


@dataclass(frozen=True, slots=True)
class Curve:
    """A ``measure`` (``orbits``, ``fuel_1norm``, ``fuel_2norm``; m/s) over the angle, from 0 deg to the first fold.

    ``angles`` and ``values`` (S,) sample it; ``of`` asks at any angle of the branch, deg.
    """

    measure: str
    angles: tuple[float, ...]
    values: tuple[float, ...]
    of: Callable[[float], float]

    def angles_for(self, value: float) -> list[float]:
        """Every angle, deg, at which the measure has the value, ascending; empty if none has.

        Assumes that the measure passes the value at most once between sampled angles (about 0.8 deg apart). Raises
        ``InvalidInput``.
        """
        number("value", value, 0.0, 1e6)
        off = [at - value for at in self.values]
        found = [angle for angle, at in zip(self.angles, off, strict=True) if at == 0.0]
        found += [
            _bisect(lambda angle: self.of(angle) - value, self.angles[k], self.angles[k + 1], off[k])
            for k in range(len(off) - 1)
            if off[k] * off[k + 1] < 0.0
        ]
        return sorted(found)


def curve_of(
    measure: str, mean_motion: float, start: float, hold: float, hops: int, gamma: float | None = None
) -> Curve:
    """A measure of an approach over all its angles. Raises ``InvalidInput``."""
    if measure not in MEASURES:
        raise invalid("measure", f"one of {', '.join(MEASURES)}", measure)

    def of(angle: float) -> float:
        return MEASURES[measure](approach(mean_motion, angle, start, hold, hops, gamma))

    end = greatest_angle(start, hold, hops, gamma) - 1e-9
    angles = tuple(np.linspace(0.0, end, _SAMPLES).tolist())
    return Curve(measure, angles, tuple(of(angle) for angle in angles), of)


def _bisect(function: Callable[[float], float], low: float, high: float, at_low: float) -> float:
    while high - low > 1e-10:
        middle = 0.5 * (low + high)
        at = function(middle)
        if at * at_low > 0.0:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)
