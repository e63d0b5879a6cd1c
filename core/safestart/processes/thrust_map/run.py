"""Run thrust-map: one certificate map per pair, one bisection per tumble rate."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from safestart.attitude.body_frame import body_to_lvlh
from safestart.closed_form.paper import certify, certify_grid
from safestart.exact.answer import Verdict
from safestart.exact.decide import decide
from safestart.exact.question import Question
from safestart.model.scenario import MAX_ACCELERATION, MIN_ACCELERATION, Chaser, Grid, Rest, Scenario, Target
from safestart.processes.base import ProcessOutput
from safestart.processes.thrust_map.spec import PROVED_FOR_S, ThrustMapInputs
from safestart.processes.wire import DT_S
from safestart.runtime.progress import Context

_CELLS = 61


def run(inputs: ThrustMapInputs, context: Context) -> ProcessOutput:
    """Evaluate every pair and bisect every rate."""
    grid = Grid(_CELLS, _CELLS, inputs.y_max_m)
    share, required = [], []
    for k, rate in enumerate(inputs.omega_t_deg_s):
        share.append(
            [
                100.0 * certify_grid(_scenario(inputs, rate, thrust), grid, inputs.rest).safe_fraction
                for thrust in inputs.a_max_m_s2
            ]
        )
        required.append(_required(inputs, rate))
        context.step(k + 1, len(inputs.omega_t_deg_s), f"{rate:g} deg/s")
    return ProcessOutput(
        {
            "omega_t_deg_s": inputs.omega_t_deg_s,
            "a_max_m_s2": inputs.a_max_m_s2,
            "safe_percent": share,
            "required_a_max_m_s2": required,
        }
    )


def _scenario(inputs: ThrustMapInputs, rate: float, thrust: float) -> Scenario:
    target = Target(math.radians(rate), inputs.mean_motion_rad_s)
    return Scenario(target, Chaser(thrust), inputs.corridor.shape())


def _required(inputs: ThrustMapInputs, rate: float) -> float | None:
    """Bisection on the logarithm: more thrust never removes a certificate or the proof of a flight."""
    start = np.array([[0.0, inputs.stand_off_m]])

    def certified(thrust: float) -> bool:
        return bool(certify(_scenario(inputs, rate, thrust), start, inputs.rest).safe[0])

    def stays(thrust: float) -> bool:
        scenario = _scenario(inputs, rate, thrust)
        at, velocity = body_to_lvlh(start[0], np.zeros(2), _turning(inputs, rate), 0.0)
        question = Question(scenario, DT_S, round(PROVED_FOR_S / DT_S))
        return decide(question, np.concatenate([at, velocity]), verdict_only=True).verdict is Verdict.GO

    found = _least(certified, MIN_ACCELERATION, 1e-6)
    # The paper's conditions ignore the mean motion and a narrow corridor's geometry, so a thrust that they accept may
    # be proved too small. Above it the proof decides.
    return found if found is None or stays(found) else _least(stays, found, 1e-4)


def _turning(inputs: ThrustMapInputs, rate: float) -> float:
    """Rate (rad/s) at which a start at rest is carried along."""
    return math.radians(rate) if inputs.rest is Rest.BODY else 0.0


def _least(enough: Callable[[float], bool], low: float, tolerance: float) -> float | None:
    """Smallest sufficient thrust from ``low`` on, rounded up within a relative ``tolerance``; None: no thrust
    suffices."""
    if enough(low):
        return low
    high = MAX_ACCELERATION
    if not enough(high):
        return None
    while high / low > 1.0 + tolerance:
        middle = math.sqrt(low * high)
        low, high = (low, middle) if enough(middle) else (middle, high)
    return high
