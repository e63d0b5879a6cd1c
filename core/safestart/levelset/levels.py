"""Upper and lower levels of a value, and the joint effect of moving levels over a time step."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np

from safestart.model.scenario import Floats

Level = Floats | Callable[[float], Floats]
"""Values that broadcast against the lattice, or a function of time (s) that gives them."""

Pair = tuple[Floats | None, Floats | None]

# Between two samples a level may change by half of its change between neighbouring nodes, or by this share of its
# range; the time of a jump is bisected to this depth.
_CELLS, _SHARE, _DEPTH = 0.5, 1e-3, 10


class Levels:
    """``cap`` keeps V <= cap, ``floor`` V >= floor.

    ``resolution`` (s): moving levels are sampled at least this often within a step, and more often when they change by
    more than half a cell; None: only at the end of a step.
    """

    def __init__(self, cap: Level | None, floor: Level | None, resolution: float | None) -> None:
        self._cap, self._floor, self._resolution = cap, floor, resolution
        self._last: tuple[float, Pair] | None = None

    @property
    def moving(self) -> bool:
        """Whether a level depends on time."""
        return callable(self._cap) or callable(self._floor)

    def at(self, time: float) -> Pair:
        """Cap and floor at a time (s); None for a missing one."""
        cap, floor = (
            np.asarray(level(time), dtype=np.float64) if callable(level) else level
            for level in (self._cap, self._floor)
        )
        return cap, floor

    def over(self, begin: float, end: float) -> Pair:
        """One cap and one floor for a step back from ``begin`` to ``end`` (s), equal to all those met on the way.

        V <- max(floor, min(cap, V)) at each of the times; such a sequence is again a cap and a floor. The level at
        ``begin`` belongs to the step before, except for the first step.
        """
        if not self.moving or self._resolution is None:
            return self.at(end)
        first = self._last is None or self._last[0] != begin
        met = self.at(begin) if first or self._last is None else self._last[1]
        folded: Pair = met if first else (None, None)
        for time, pair in self._moments(begin, met, end):
            folded = _then(folded, pair)
            self._last = (time, pair)
        return folded

    def _moments(self, begin: float, met: Pair, end: float) -> Iterator[tuple[float, Pair]]:
        """Times after ``begin`` down to ``end``, close enough together, with the levels there."""
        count = max(1, math.ceil((begin - end) / (self._resolution or math.inf)))
        now = begin
        for k in range(1, count + 1):
            work = [(end if k == count else begin - (begin - end) * k / count, 0)]
            while work:
                time, depth = work[-1]
                pair = self.at(time)
                middle = 0.5 * (now + time)
                if depth < _DEPTH and time < middle < now and _far(met, pair):
                    work.append((middle, depth + 1))
                    continue
                work.pop()
                now, met = time, pair
                yield time, pair


def _far(one: Pair, two: Pair) -> bool:
    """Whether a level changes so much between two samples that the times between matter."""
    for a, b in zip(one, two, strict=True):
        if a is None or b is None or a is b:
            continue
        change = float(np.abs(a - b).max(initial=0.0))
        if change > max(_CELLS * max(_steepest(a), _steepest(b)), _SHARE * float(np.ptp(a))) and change > 0.0:
            return True
    return False


def _steepest(level: Floats) -> float:
    """Largest difference between neighbouring nodes."""
    steps = [float(np.abs(np.diff(level, axis=k)).max(initial=0.0)) for k in range(level.ndim)]
    return max(steps, default=0.0)


def _then(first: Pair, second: Pair) -> Pair:
    """Cap and floor equal to one pair after another."""
    (cap, floor), (next_cap, next_floor) = first, second
    if next_cap is not None:
        cap = next_cap if cap is None else np.minimum(cap, next_cap)
        floor = None if floor is None else np.minimum(floor, next_cap)
    if next_floor is not None:
        floor = next_floor if floor is None else np.maximum(floor, next_floor)
        cap = None if cap is None else np.maximum(cap, next_floor)
    return cap, floor
