"""From the inputs of tracking-mpc to the core's terms; refuses what its models cannot say."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from safestart.control.tracking_mpc.controller import Program
from safestart.control.tracking_mpc.sampled import Sampled
from safestart.control.tracking_mpc.theta_set import theta_set
from safestart.control.tracking_mpc.tumble import Tumble
from safestart.control.tracking_mpc.tuning import DockingCorridor, Tuning
from safestart.model.scenario import Floats
from safestart.processes.tracking_mpc.possible import require_possible, shape_of, tumble_of
from safestart.processes.tracking_mpc.spec import TrackingMpcInputs
from safestart.tracking.certificate import shifts_needed

LEAST_WINDOW = 300
"""Nodes at which theta's rows are imposed at least: the target's motion is not periodic."""


@dataclass(frozen=True)
class Setup:
    """One request: ``attitudes`` (W, 3, 3) of the window, ``start`` (6,) LVLH, ``shifts`` that a certificate needs."""

    tumble: Tumble
    motion: Sampled
    shape: DockingCorridor
    tuning: Tuning
    program: Program
    attitudes: Floats
    start: Floats
    shifts: int


def setup_of(inputs: TrackingMpcInputs, tightening: Any = None) -> Setup:
    """Build; raises ``InvalidInput`` as :func:`require_possible` does."""
    require_possible(inputs)
    shape = shape_of(inputs)
    tuning = Tuning(
        inputs.u_max_m_s,
        inputs.n_c,
        inputs.n_lqr,
        inputs.rho,
        inputs.tau,
        inputs.theta_limit,
        inputs.input_limit,
    )
    motion = Sampled(inputs.mean_motion, inputs.period_s, inputs.thrust == "held")
    tumble = tumble_of(inputs)
    position = np.array(inputs.start.position_m)
    # The regulator alone says how many steps a certificate looks ahead.
    pace = motion.a + motion.b @ motion.regulator(inputs.rho)
    shifts = shifts_needed(pace)
    count = max(LEAST_WINDOW, inputs.steps + tuning.inputs + shifts + 1 + motion.ahead)
    attitudes = tumble.nodes(inputs.period_s, count)
    limit = theta_set(tuning, shape, tumble, motion, attitudes)
    program = Program(motion, shape, tuning, limit, tightening)
    start = np.concatenate([attitudes[0].T @ position, np.array(inputs.start.velocity_m_s)])
    return Setup(tumble, motion, shape, tuning, program, attitudes, start, shifts)
