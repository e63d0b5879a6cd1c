"""What no target and start can have, found before a job waits for it: a body that is none, a start outside."""

from __future__ import annotations

import math

import numpy as np

from safestart.control.tracking_mpc.tumble import Tumble
from safestart.control.tracking_mpc.tuning import FIXED_TOLERANCE, DockingCorridor
from safestart.errors import InvalidInput, invalid
from safestart.processes.tracking_mpc.spec import TrackingMpcInputs

_WIRE_NAMES = {
    "inertia": "inertia_kg_m2",
    "attitude": "attitude_wxyz",
    "body_rate": "body_rate_deg_s",
    "period": "period_s",
}


def require_possible(inputs: TrackingMpcInputs) -> None:
    """Raise ``InvalidInput`` for a body that is none, a start outside, a period in which the target turns too far."""
    try:
        tumble_of(inputs).slow_enough(inputs.period_s)
    except InvalidInput as error:
        name = str(error.field)
        raise invalid(_WIRE_NAMES.get(name, name), str(error.required), error.received) from None
    slack = float(shape_of(inputs).faces().slack(np.array(inputs.start.position_m)).min())
    if slack < -FIXED_TOLERANCE:
        raise invalid("start.position_m", "a position inside the corridor", f"one {-slack:.3g} m outside")
    if inputs.thrust == "held" and inputs.theta_limit == "printed":
        raise invalid("theta_limit", "a limit for held thrust: ball, corners, polytope or zero", "printed")


def shape_of(inputs: TrackingMpcInputs) -> DockingCorridor:
    """The corridor."""
    corridor = inputs.corridor
    return DockingCorridor(corridor.c_x, corridor.c_z, corridor.x0_m, corridor.z0_m)


def tumble_of(inputs: TrackingMpcInputs) -> Tumble:
    """The target."""
    rows = [tuple(float(value) for value in row) for row in inputs.inertia_kg_m2]
    rate = tuple(math.radians(value) for value in inputs.body_rate_deg_s)
    quaternion = tuple(float(value) for value in inputs.attitude_wxyz)
    return Tumble(tuple(rows), quaternion, rate, inputs.mean_motion, inputs.attitude_reference)  # type: ignore[arg-type]
