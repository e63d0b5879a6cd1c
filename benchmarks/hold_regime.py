"""Do flights of the three-regime controller end in the set that its hold keeps? ``python -m benchmarks.hold_regime``.

Starts at rest in the corridor, 5 to 80 m ahead, flown for 600 s: how many last, how many of these come into the set and
stay in the regime from then on, and when. docs/theory/hold.md has the figures.
"""

from __future__ import annotations

import sys

import numpy as np

from benchmarks.asked import parser
from safestart.attitude.spin import Spin
from safestart.control.forecast import flight_plan
from safestart.control.gains import PRESETS
from safestart.control.hold.ellipsoid import ellipsoid
from safestart.control.hold.regime_hold import RegimeHold
from safestart.control.three_regimes import ThreeRegimes
from safestart.dynamics.cwh import Cwh
from safestart.model.scenario import Scenario
from safestart.simulation.loop import fly
from safestart.simulation.plant import Plant

CASES = (
    (0.0, 0.1, "tuned"),
    (1.0, 0.02, "tuned"),
    (3.0, 0.1, "tuned"),
    (5.0, 0.05, "tuned"),
    (1.0, 0.02, "paper"),
)
DT_S, STEPS, NODES, STARTS = 2.0, 300, 6, 60


def entered(rate: float, most: float, name: str, rng: np.random.Generator) -> str:
    """One row."""
    scenario, gains = Scenario.of(rate, most), PRESETS[name]
    own = RegimeHold.of(scenario, gains, DT_S, NODES, 1.0, 0.1)
    level = ellipsoid(own).level
    plan = flight_plan(scenario, gains, DT_S, STEPS, nodes=NODES)
    plant = Plant(Cwh(scenario.target.mean_motion), Spin(scenario.target.tumble_rate))
    lasted, times = 0, []
    for _ in range(STARTS):
        ahead = rng.uniform(5.0, 80.0)
        start = np.array([rng.uniform(-0.5, 0.5) * ahead, ahead, 0.0, 0.0, 0.0, 0.0])
        record = fly(plant, [own.corridor], ThreeRegimes(plan), start, STEPS, DT_S)
        if record.margin[0] < 0.0:
            continue
        lasted += 1
        path = record.paths[0]
        for k in range(1, STEPS):
            now = np.concatenate([path.states[k][[0, 1, 3, 4]], path.commands[k - 1].thrust[:2]])
            error = now - own.at(np.zeros(6), own.reference.rate * DT_S * k)
            if error @ own.cost @ error <= level:
                if not all(command.label == "hold" and command.feasible for command in path.commands[k:]):
                    raise RuntimeError(f"a flight left the set that it was in after {DT_S * k:g} s")
                times.append(DT_S * k)
                break
    when = f"after {np.median(times):g} s (median), {max(times):g} s at most" if times else ""
    return f"{rate:g} deg/s, {most:g} m/s2, {name}: {lasted} of {STARTS} last, {len(times)} end in the set {when}"


def main() -> None:
    """All rows."""
    rng = np.random.default_rng(2)
    for case in CASES:
        sys.stdout.write(entered(*case, rng) + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    parser(__doc__).parse_args()
    main()
