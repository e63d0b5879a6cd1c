"""The compiled watched flight: CWH, a steady spin about z, the corridor in the orbit plane."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from safestart.attitude.spin import Spin
from safestart.constraints.constraint import Constraint
from safestart.constraints.corridor import Corridor, faces_about_z
from safestart.dynamics.cwh import Cwh
from safestart.model.scenario import Floats
from safestart.simulation.noise import CONTINUOUS
from safestart.simulation.passage import advance, slopes
from safestart.simulation.plant import Plant
from safestart.simulation.watch import Watched, WatchedFlight, samples_of

_NO_LOG = np.empty((0, 6))


class PlanarFlight:
    """The same flight as :class:`safestart.simulation.watch.WatchedFlight`; it stops one sample after a violation."""

    def __init__(self, motion: Cwh, spin: Spin, corridor: Corridor, start: Floats, dt: float) -> None:
        self._spin, self._rate, self._dt = spin, spin.rate * spin.axis[2], dt
        self._samples = samples_of(spin, dt)
        self._step = dt / self._samples
        self._phi, self._gamma = motion.transition(0.0, self._step), motion.held(0.0, self._step)
        self._normals = corridor.normals / corridor.lengths[:, None]
        self._offsets = corridor.offsets / corridor.lengths
        count = len(self._offsets)
        self._intervals = 0
        self._before, self._after = np.empty((2, count)), np.empty((2, count))
        self.state, self.time = np.array(start, dtype=np.float64), 0.0
        first = self._turned(np.zeros(1))[0]
        slopes(first, self._offsets, self.state, 2, count, self._rate, self._step, self._before)
        self.margin = float(self._before[0].min())
        self.violated_at = math.inf if self.margin >= 0.0 else 0.0

    def fly(self, thrust: Floats, impulse: Floats | None = None) -> None:
        """One interval."""
        begin = self._intervals * self._dt
        if impulse is not None:
            self.state[3:] += impulse
            slopes(
                self._turned(np.full(1, begin))[0], self._offsets, self.state, 2, len(self._offsets),
                self._rate, self._step, self._before,
            )  # fmt: skip
        times: Floats = begin + self._step * np.arange(1.0, self._samples + 1.0)
        least, late = advance(
            0, self.state, float(thrust[0]), float(thrust[1]), float(thrust[2]), self._phi, self._gamma,
            self._turned(times)[None], self._offsets, self._rate, self._step, CONTINUOUS, self._before,
            self._after, _NO_LOG,
        )  # fmt: skip
        self._intervals += 1
        self.margin = min(self.margin, least) if math.isfinite(least) else math.nan
        self.time = begin + self._dt
        if late < math.inf:
            self.violated_at = begin + late
            self.time = begin + self._step * math.ceil(late / self._step - 1e-9)

    def _turned(self, times: Floats) -> Floats:
        """Unit normals (T, 2, F) in LVLH axes."""
        turned = faces_about_z(self._normals, self._spin.axis[2] * self._spin.angle(times))
        return np.ascontiguousarray(turned.swapaxes(1, 2))


def watched_flight(plant: Plant, constraints: Sequence[Constraint], start: Floats, dt: float) -> Watched:
    """The flight from ``start`` (6,), compiled if its parts allow it."""
    motion, spin = plant.motion, plant.attitude
    if len(constraints) == 1 and isinstance(motion, Cwh) and isinstance(spin, Spin) and spin.planar:
        corridor = constraints[0]
        if isinstance(corridor, Corridor) and corridor.normals.shape[1] == 2:
            return PlanarFlight(motion, spin, corridor, start, dt)
    return WatchedFlight(plant, constraints, start, dt)
