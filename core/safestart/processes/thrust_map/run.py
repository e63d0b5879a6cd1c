"""Run thrust-map: one certificate map per pair, one bisection per tumble rate."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from safestart.attitude.body_frame import body_to_lvlh
from safestart.closed_form.by_name import ClosedForm, go_of, map_of
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
    share: dict[ClosedForm, list[list[float]]] = {"certified": [], "paper": []}
    needed: dict[ClosedForm, list[float | None]] = {"certified": [], "paper": []}
    proved = []
    for k, rate in enumerate(inputs.omega_t_deg_s):
        for name in share:
            scenarios = [_scenario(inputs, rate, thrust) for thrust in inputs.a_max_m_s2]
            share[name].append(
                [100.0 * map_of(name, one, grid, inputs.rest).safe_fraction for one in scenarios]
            )
            needed[name].append(_certified(name, inputs, rate))
        if inputs.certificate == "paper":
            proved.append(_proved(inputs, rate, needed["paper"][-1]))
        context.step(k + 1, len(inputs.omega_t_deg_s), f"{rate:g} deg/s")
    return ProcessOutput(
        {
            "certificate": inputs.certificate,
            "omega_t_deg_s": inputs.omega_t_deg_s,
            "a_max_m_s2": inputs.a_max_m_s2,
            "safe_percent": share[inputs.certificate],
            "required_a_max_m_s2": proved or needed["certified"],
            "paper_safe_percent": share["paper"],
            "paper_required_a_max_m_s2": needed["paper"],
        }
    )


def _scenario(inputs: ThrustMapInputs, rate: float, thrust: float) -> Scenario:
    target = Target(math.radians(rate), inputs.mean_motion_rad_s)
    return Scenario(target, Chaser(thrust), inputs.corridor.shape())


def _certified(name: ClosedForm, inputs: ThrustMapInputs, rate: float) -> float | None:
    """Bisection on the logarithm for where the closed form starts to say GO.

    More thrust takes nothing away from the paper's conditions. The certificate may choose another manoeuvre with more
    thrust, so that below what is found there may be a thrust that is certified, too.
    """
    start = np.array([[0.0, inputs.stand_off_m]])
    return _least(
        lambda thrust: bool(go_of(name, _scenario(inputs, rate, thrust), start, inputs.rest)[0]),
        MIN_ACCELERATION,
        1e-6,
    )


def _proved(inputs: ThrustMapInputs, rate: float, found: float | None) -> float | None:
    """Where the paper's conditions call too little enough, more, so that a flight of :data:`PROVED_FOR_S` is proved."""
    start = np.array([0.0, inputs.stand_off_m])

    def stays(thrust: float) -> bool:
        at, velocity = body_to_lvlh(start, np.zeros(2), _turning(inputs, rate), 0.0)
        question = Question(_scenario(inputs, rate, thrust), DT_S, round(PROVED_FOR_S / DT_S))
        return decide(question, np.concatenate([at, velocity]), verdict_only=True).verdict is Verdict.GO

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
