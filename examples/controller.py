"""Our controller in a simulator of your own, and your controller in our loop."""

import numpy as np

import safestart as ss

scenario = ss.Scenario.of(3.0, 0.1)
start = (5.0, 40.0)
n = scenario.target.mean_motion


def simulate(state: np.ndarray, thrust: np.ndarray, seconds: float, steps: int = 200) -> np.ndarray:
    """Your simulator: here Clohessy-Wiltshire by small steps; LVLH, m and m/s."""
    h = seconds / steps
    for _ in range(steps):
        x, _, z, vx, vy, _ = state
        pull = np.array([3 * n * n * x + 2 * n * vy, -2 * n * vx, -n * n * z])
        velocity = state[3:] + h * (pull + thrust)
        state = np.concatenate([state[:3] + 0.5 * h * (state[3:] + velocity), velocity])
    return state


pilot = ss.controller("filter", scenario, duration_s=60.0, dt_s=2.0)
state = np.array([*start, 0.0, 0.0, 0.0, 0.0])
pilot.begin(state)
for k in range(pilot.steps):
    command = pilot.command(k, state)
    state = simulate(state, command.thrust, pilot.dt_s)
ours = ss.fly(scenario, start, "filter")
print("in your simulator", state[:2], "in our loop", ours.lvlh_m[-1])
assert np.allclose(state[:2], ours.lvlh_m[-1], atol=0.05)


class Damper:
    """Yours: brake whatever moves."""

    def command(self, k: int, state: np.ndarray) -> np.ndarray:
        """Thrust (3,), LVLH, m/s²."""
        return -0.05 * state[3:]


print("your controller in our loop:", dict(ss.fly(scenario, start, Damper()).facts()))
