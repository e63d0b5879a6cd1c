"""Where the printed limit on theta is not safe: an equilibrium inside it that the input cannot hold.

Paper 002 lets theta lie in the corridor up to y_max of (42). A chaser that stays there must give u_e(k; theta); near
spins about a principal axis that is more than the limit, because (35) leaves out the centripetal term.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from safestart.control.tracking_mpc import equilibrium
from safestart.control.tracking_mpc.sampled import Sampled
from safestart.control.tracking_mpc.theta_radius import printed_radius
from safestart.control.tracking_mpc.theta_set import printed_cut
from safestart.control.tracking_mpc.tumble import Tumble
from safestart.control.tracking_mpc.tuning import DockingCorridor, InputLimit
from safestart.model.scenario import Floats

_HIGHEST = 1e4


@dataclass(frozen=True)
class CounterExample:
    """A flight that stays at ``theta`` (3,): ``states`` (K, 6) LVLH, ``inputs`` (K, 3) body axes, m/s.

    ``first`` is the first step whose input is above the limit.
    """

    theta: Floats
    states: Floats
    inputs: Floats
    first: int


def counter_example(
    shape: DockingCorridor,
    tumble: Tumble,
    motion: Sampled,
    u_max: float,
    attitudes: Floats,
    limit: InputLimit = "box",
) -> CounterExample | None:
    """The corner of the printed set that needs most, flown under ``attitudes`` (K + 2, 3, 3).

    None: every corner can be held, or thrust is held and the printed formula says nothing.
    """
    if motion.held:
        return None
    y_max = printed_cut(shape, printed_radius(tumble, motion, u_max))
    if not 0.0 < y_max < _HIGHEST:
        return None
    maps = equilibrium.inputs(motion, attitudes)
    x, z = shape.x0 + y_max / shape.c_x, shape.z0 + y_max / shape.c_z
    corners = np.array([[side_x * x, y_max, side_z * z] for side_x in (-1, 1) for side_z in (-1, 1)])
    asked = np.einsum("kij,cj->cki", maps, corners)
    needed = np.abs(asked).max(axis=2) if limit == "box" else np.linalg.norm(asked, axis=2)
    corner = int(needed.max(axis=1).argmax())
    if needed[corner].max() <= u_max:
        return None
    theta = corners[corner]
    states = equilibrium.states(motion, attitudes)[: len(maps)] @ theta
    first = int(np.nonzero(needed[corner] > u_max)[0][0])
    return CounterExample(theta, states, maps @ theta, first)
