"""Can the tracking MPC take this start? Its nominal flight with held thrust, until it is at rest at the port.

The flight is a thrust history, so that what answers the exact question can bound its distances at all times; here only
the nodes count. ``reserve`` moves the corridor's faces in, so that the flight keeps its distance between nodes, too.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from safestart.attitude.attitude import Attitude
from safestart.control.tracking_mpc.controller import Plan, Program
from safestart.control.tracking_mpc.sampled import Sampled
from safestart.control.tracking_mpc.theta_set import theta_set
from safestart.control.tracking_mpc.tuning import DockingCorridor, Tuning
from safestart.model.scenario import Floats
from safestart.tracking.certificate import recursion, shifts_needed

LEAST_RESERVE = 0.01
"""Metres by which the first try moves the faces in."""
_TRIES = 4
_LEAST_WINDOW = 300


@dataclass(frozen=True)
class Approach:
    """What the controller is asked to do: reach rest at the port, (0, y0, 0) in the body, within ``most`` steps.

    At rest means within ``radius`` m of the port and ``rest`` m/s of the body; the flight lasts ``least`` steps at
    least. ``turn`` (3, 3) as tuples: rotates the body's axes into those of ``shape``.
    """

    mean_motion: float
    period: float
    shape: DockingCorridor
    attitude: Attitude
    tuning: Tuning
    most: int
    least: int
    radius: float
    rest: float
    turn: tuple[tuple[float, ...], ...] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@dataclass(frozen=True)
class Taken:
    """The flight from one start: ``thrust`` (K, 3), LVLH m/s^2, and ``states`` (K + 1, 6).

    ``arrived``: the first node at which it is at rest at the port, None if it is not. ``certified``: every plan has
    candidates for all later steps. ``margin``, m: the proved distance that the thrust keeps. ``theta`` (3,): reference
    of the first plan. ``violation``, m: least violation of the first program; inf: no plan whatever is given up.
    ``lost``: a step after the first had no plan.
    """

    thrust: Floats
    states: Floats
    arrived: int | None
    certified: bool
    margin: float
    theta: Floats | None
    violation: float
    reserve: float
    lost: bool = False


def take(approach: Approach, start: Floats, margin: Callable[[Floats], float]) -> Taken:
    """Fly from an LVLH ``start`` (6,); ``margin`` bounds the distance of a thrust history (K, 3) from below, m.

    While the flight arrives but comes too close between nodes, it is planned again with the faces moved in further.
    """
    reserve, flown = LEAST_RESERVE, None
    for _ in range(_TRIES):
        found = _flight(approach, start, reserve)
        if found.arrived is None and flown is not None:
            break
        kept = margin(found.thrust) if len(found.thrust) else -math.inf
        flown = replace(found, margin=kept)
        if found.arrived is None or kept > 0.0:
            break
        reserve += LEAST_RESERVE - 1.2 * kept
    assert flown is not None
    return flown


@lru_cache(maxsize=16)
def _made(approach: Approach, reserve: float) -> tuple[Program, Floats, Floats, int]:
    """Program, attitudes (W, 3, 3) and rates (W, 3) at the nodes, and the shifts that a certificate needs."""
    motion = Sampled(approach.mean_motion, approach.period, held=True)
    tuning, turn = approach.tuning, np.array(approach.turn)
    shifts = shifts_needed(motion.a + motion.b @ motion.regulator(tuning.rho))
    flown = max(approach.most, approach.least)
    count = max(_LEAST_WINDOW, flown + tuning.inputs + shifts + 2 + motion.ahead)
    times = approach.period * np.arange(float(count))
    attitudes = np.ascontiguousarray(turn @ approach.attitude.rotation(times))
    rates = approach.attitude.angular_velocity(times) @ turn.T
    limit = theta_set(tuning, approach.shape, None, motion, attitudes)
    tightening = np.full(tuning.inputs + 1, reserve), np.zeros(tuning.inputs)
    return Program(motion, approach.shape, tuning, limit, tightening), attitudes, rates, shifts


def _flight(approach: Approach, start: Floats, reserve: float) -> Taken:
    made, attitudes, rates, shifts = _made(approach, reserve)
    program = made.apart()
    motion, port = program.motion, np.array([0.0, approach.shape.y0, 0.0])
    state = np.array(start, dtype=np.float64)
    states, given, plans, arrived = [state], [], [], None
    first: Plan | None = None
    for k in range(max(approach.most, approach.least)):
        plan = program.plan(attitudes[k:], state, soft=k == 0)
        first = first or plan
        if not plan.feasible:
            break
        plans.append(plan)
        given.append(attitudes[k].T @ plan.inputs[0])
        state = motion.after(state, given[-1])
        states.append(state)
        body = attitudes[k + 1] @ state[:3]
        speed = attitudes[k + 1] @ state[3:] - np.cross(rates[k + 1], body)
        near = float(np.linalg.norm(body - port)) <= approach.radius
        if arrived is None and near and float(np.linalg.norm(speed)) <= approach.rest:
            arrived = k + 1
        if arrived is not None and k + 1 >= approach.least:
            break
    if arrived is not None and arrived > approach.most:
        arrived = None
    assert first is not None
    whole = arrived is not None and len(given) >= approach.least
    certified = whole and all(
        recursion(program, attitudes[k:], plan, shifts).holds for k, plan in enumerate(plans)
    )
    return Taken(
        np.array(given).reshape(-1, 3) / approach.period,
        np.array(states),
        arrived if whole else None,
        certified,
        -math.inf,
        first.theta if plans else None,
        first.violation,
        reserve,
        lost=bool(plans) and not plan.feasible,
    )
