"""Where commands are flown, one control interval at a time: exact CWH, or two bodies with J2 by DOP853."""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np

from safestart.constraints.corridor import corridor_of
from safestart.dynamics.cwh import input_matrix, transition_matrix
from safestart.dynamics.two_body import Orbit, RelativeMotion
from safestart.exact.watch import dips
from safestart.model.scenario import Floats, Scenario
from safestart.simulation.passage import advance, cubic_root, slopes
from safestart.simulation.truth import CONTINUOUS

LONGEST_SAMPLE_S, LARGEST_TURN = 0.5, 0.02


def samples_of(scenario: Scenario, dt: float) -> int:
    """Parts of an interval between which a cubic follows a face distance to about 1e-7 m."""
    rate = scenario.target.tumble_rate
    longest = min(LONGEST_SAMPLE_S, LARGEST_TURN / rate if rate > 0.0 else math.inf)
    return math.ceil(dt / longest)


class World(Protocol):
    """The flown world from one start on."""

    state: Floats
    """LVLH state (6,) now, m and m/s."""
    time: float
    """Seconds flown: whole intervals, less where the last one ended at a violation."""
    margin: float
    """Least face distance so far, m."""
    violated_at: float
    """Seconds until the first violation, infinite without one."""

    def fly(self, thrust: Floats) -> None:
        """Hold ``thrust`` (2,), LVLH m/s^2, for one interval, or until a violation."""
        ...


class CwhWorld:
    """Exact CWH in the plane; the corridor is checked at all times."""

    def __init__(self, scenario: Scenario, state: Floats, dt: float) -> None:
        self._rate, self._dt = scenario.target.tumble_rate, dt
        self._samples = samples_of(scenario, dt)
        self._step = dt / self._samples
        n = scenario.target.mean_motion
        self._phi, self._gamma = transition_matrix(n, self._step), input_matrix(n, self._step)
        corridor = corridor_of(scenario.corridor)
        self._normals = corridor.normals / corridor.lengths[:, None]
        self._offsets = corridor.offsets / corridor.lengths
        self._intervals = 0
        self._before, self._after = np.empty((2, 3)), np.empty((2, 3))
        self.state, self.time = np.array(state, dtype=np.float64), 0.0
        first = np.ascontiguousarray(self._normals.T)
        slopes(first, self._offsets, self.state, 2, 3, self._rate, self._step, self._before)
        self.margin = float(self._before[0].min())
        self.violated_at = math.inf if self.margin >= 0.0 else 0.0

    def fly(self, thrust: Floats) -> None:
        """One interval."""
        begin = self._intervals * self._dt
        times: Floats = begin + self._step * np.arange(1.0, self._samples + 1.0)
        faces = _turned(self._normals, self._rate * times)
        least, late = advance(
            0, self.state, float(thrust[0]), float(thrust[1]), 0.0, self._phi, self._gamma, faces[None],
            self._offsets, self._rate, self._step, CONTINUOUS, self._before, self._after, _NO_LOG,
        )  # fmt: skip
        self._intervals += 1
        self.margin = min(self.margin, least) if math.isfinite(least) else math.nan
        self.time = begin + self._dt
        if late < math.inf:
            self.violated_at = begin + late
            self.time = begin + self._step * math.ceil(late / self._step - 1e-9)


class TwoBodyWorld:
    """Target and chaser under gravity with J2; the corridor turns at the tumble rate against the target's true LVLH."""

    def __init__(self, scenario: Scenario, state: Floats, dt: float, orbit: Orbit | None = None) -> None:
        self._rate, self._dt = scenario.target.tumble_rate, dt
        self._samples = samples_of(scenario, dt)
        corridor = corridor_of(scenario.corridor)
        self._normals = corridor.normals / corridor.lengths[:, None]
        self._offsets = corridor.offsets / corridor.lengths
        self._motion = RelativeMotion(orbit or Orbit.of(scenario.target.mean_motion), state)
        self._intervals = 0
        self.state, self.time = np.array(state, dtype=np.float64), 0.0
        value, _ = self._distances(np.zeros(1), self.state[None])
        self.margin = float(value.min())
        self.violated_at = math.inf if self.margin >= 0.0 else 0.0

    def fly(self, thrust: Floats) -> None:
        """One interval; the thrust is held in the target's LVLH axes."""
        begin = self._intervals * self._dt
        times: Floats = begin + self._dt / self._samples * np.arange(self._samples + 1.0)
        states = self._motion.fly(np.array([thrust[0], thrust[1], 0.0]), times)
        value, slope = self._distances(times, states)
        step = self._dt / self._samples
        slope *= step
        low, at = dips(value, slope)
        self._intervals += 1
        self.state, self.time = states[-1], float(times[-1])
        out = np.nonzero((low < 0.0).any(axis=1))[0]
        seen = low if not len(out) else low[: out[0] + 1]
        self.margin = min(self.margin, float(seen.min())) if np.isfinite(low).all() else math.nan
        if len(out):
            k = int(out[0])
            roots = [
                cubic_root(value[k, i], slope[k, i], value[k + 1, i], slope[k + 1, i], at[k, i])
                for i in np.nonzero(low[k] < 0.0)[0]
            ]
            self.violated_at = float(times[k]) + step * min(roots)

    def _distances(self, times: Floats, states: Floats) -> tuple[Floats, Floats]:
        """Face distances (T, F) and their rates."""
        faces = _turned(self._normals, self._rate * times)
        turning = self._rate * np.stack([-faces[:, 1], faces[:, 0]], axis=1)
        value = self._offsets - np.einsum("tdf,td->tf", faces, states[:, :2])
        rate = -np.einsum("tdf,td->tf", faces, states[:, 3:5]) - np.einsum(
            "tdf,td->tf", turning, states[:, :2]
        )
        return value, rate


_NO_LOG = np.empty((0, 6))


def _turned(normals: Floats, angles: Floats) -> Floats:
    """Unit normals (F, 2) of the body frame in LVLH at the angles (T,), shape (T, 2, F)."""
    cos, sin = np.cos(angles)[:, None], np.sin(angles)[:, None]
    return np.ascontiguousarray(
        np.stack(
            [cos * normals[:, 0] - sin * normals[:, 1], sin * normals[:, 0] + cos * normals[:, 1]], axis=1
        )
    )
