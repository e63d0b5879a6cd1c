"""An environment of Gymnasium's shape (reset, step, five values) over safestart, without the dependency.

Observation: body-frame position and velocity in LVLH, (6,). Action: thrust in LVLH, (3,), m/s². The reward is minus the
impulse; an episode ends outside the corridor.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import safestart as ss


class Approach:
    """One chaser in the rotating corridor; each step is one control interval."""

    def __init__(self, scenario: ss.Scenario, dt_s: float = 2.0, steps: int = 30) -> None:
        self.scenario, self.dt_s, self.steps = scenario, dt_s, steps
        self._start, self._history = np.zeros(2), np.zeros((0, 3))

    def reset(self, *, seed: int | None = None) -> tuple[np.ndarray, dict[str, Any]]:
        """A certified start at rest."""
        rng = np.random.default_rng(seed)
        while True:
            start = rng.uniform([-20.0, 10.0], [20.0, 60.0])
            if ss.certify(self.scenario, start).go:
                break
        self._start, self._history = start, np.zeros((0, 3))
        return np.array([*start, 0.0, 0.0, 0.0, 0.0]), {}

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Observation, reward, terminated (outside), truncated (time is up), information."""
        self._history = np.vstack([self._history, action])
        flight = ss.fly(
            self.scenario,
            self._start,
            _Replay(self._history),
            horizon_s=self.dt_s * len(self._history),
            dt_s=self.dt_s,
        )
        moved = (flight.lvlh_m[-1] - flight.lvlh_m[-2]) / self.dt_s
        seen = np.array([*flight.body_m[-1], 0.0, *moved, 0.0])
        cost = float(np.linalg.norm(flight.thrust_m_s2[-1])) * self.dt_s
        info = {"closest_m": flight.closest_m, "delta_v_m_s": flight.delta_v_m_s}
        return seen, -cost, not flight.safe, len(self._history) >= self.steps, info


class _Replay:
    def __init__(self, history: np.ndarray) -> None:
        self._history = history

    def command(self, k: int, state: np.ndarray) -> np.ndarray:
        return self._history[k]


if __name__ == "__main__":
    env = Approach(ss.Scenario.of(3.0, 0.1), steps=10)
    seen, _ = env.reset(seed=1)
    total, ended = 0.0, False
    while not ended:
        seen, reward, outside, over, info = env.step(np.array([0.0, 0.0, 0.0]))
        total, ended = total + reward, outside or over
    print("drifted to", seen[:2], "return", total, info)
    assert total == 0.0
