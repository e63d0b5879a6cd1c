"""From the inputs of tracking-mpc to the core's terms; refuses what its models cannot say."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from safestart.control.tracking_mpc.controller import FIXED_TOLERANCE, Program
from safestart.control.tracking_mpc.sampled import Sampled
from safestart.control.tracking_mpc.theta_set import theta_set
from safestart.control.tracking_mpc.tumble import Tumble
from safestart.control.tracking_mpc.tuning import DockingCorridor, Tuning
from safestart.errors import InvalidInput, invalid
from safestart.model.scenario import Floats
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
    """Build; raises ``InvalidInput`` for a body that is none, a start outside, a period that is too long."""
    corridor = inputs.corridor
    shape = DockingCorridor(corridor.c_x, corridor.c_z, corridor.x0_m, corridor.z0_m)
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
    try:
        tumble = tumble_of(inputs)
        tumble.slow_enough(inputs.period_s)
    except InvalidInput as error:
        raise _under_wire_name(error) from None
    position = np.array(inputs.start.position_m)
    outside = -float(shape.faces().slack(position).min())
    # A start on a face is inside, whatever the last bit of its slack.
    if outside > FIXED_TOLERANCE:
        raise invalid("start", "a position inside the corridor", f"one {outside:.3g} m outside")
    # The regulator alone says how many steps a certificate looks ahead.
    pace = motion.a + motion.b @ motion.regulator(inputs.rho)
    shifts = shifts_needed(pace)
    count = max(LEAST_WINDOW, inputs.steps + tuning.inputs + shifts + 1 + motion.ahead)
    attitudes = tumble.nodes(inputs.period_s, count)
    limit = theta_set(tuning, shape, tumble, motion, attitudes)
    program = Program(motion, shape, tuning, limit, tightening)
    start = np.concatenate([attitudes[0].T @ position, np.array(inputs.start.velocity_m_s)])
    return Setup(tumble, motion, shape, tuning, program, attitudes, start, shifts)


def _under_wire_name(error: InvalidInput) -> InvalidInput:
    """The same error about the input's field."""
    names = {"inertia": "inertia_kg_m2", "attitude": "attitude_wxyz", "body_rate": "body_rate_deg_s"}
    named = (names | {"period": "period_s"}).get(error.field or "")
    return error if named is None else invalid(named, error.required or "", error.received)


def tumble_of(inputs: TrackingMpcInputs) -> Tumble:
    """The target."""
    rows = [tuple(float(value) for value in row) for row in inputs.inertia_kg_m2]
    rate = tuple(math.radians(value) for value in inputs.body_rate_deg_s)
    quaternion = tuple(float(value) for value in inputs.attitude_wxyz)
    return Tumble(tuple(rows), quaternion, rate, inputs.mean_motion, inputs.attitude_reference)  # type: ignore[arg-type]
