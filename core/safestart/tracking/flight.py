"""One flight under the tracking MPC without errors: plan, apply the first input, and so on.

The truth is HCW or two bodies with J2; the attitude is the target's own. Where the first program has no plan, nothing
is flown: infeasible is an answer.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from safestart.control.tracking_mpc.controller import Plan, Program
from safestart.control.tracking_mpc.tumble import Tumble
from safestart.dynamics.cwh import Cwh
from safestart.dynamics.two_body import Orbit, TwoBody
from safestart.model.scenario import Floats
from safestart.optim.prediction import held_through
from safestart.runtime.progress import Context

Truth = Literal["hcw", "two_body_j2"]
_BETWEEN = 10
"""Instants per step at which the corridor is looked at between nodes."""


@dataclass(frozen=True)
class TrackedFlight:
    """K steps: ``states`` (K + 1, 6) LVLH and ``body`` (K + 1, 3) at the nodes, ``plans`` (K).

    ``least_slack``, m: least distance to the corridor's faces at the nodes; ``least_between``, m: at ten instants in
    every step, where the controller promises nothing. ``finished``: every step had a plan.
    """

    states: Floats
    body: Floats
    plans: tuple[Plan, ...]
    least_slack: float
    least_between: float
    finished: bool

    @property
    def inputs(self) -> Floats:
        """(K, 3), m/s, body axes."""
        return np.array([plan.inputs[0] for plan in self.plans]).reshape(-1, 3)

    @property
    def ranges(self) -> Floats:
        """(K + 1,), m."""
        out: Floats = np.linalg.norm(self.states[:, :3], axis=1)
        return out

    def settled(self, radius: float) -> int | None:
        """The first node from which on the range stays below ``radius`` m; None: it does not."""
        outside = np.nonzero(self.ranges >= radius)[0]
        first = int(outside[-1]) + 1 if len(outside) else 0
        return first if first < len(self.states) else None


def fly(
    program: Program,
    tumble: Tumble,
    attitudes: Floats,
    start: Floats,
    steps: int,
    truth: Truth = "hcw",
    context: Context | None = None,
) -> TrackedFlight:
    """Fly up to ``steps`` steps from an LVLH ``start`` (6,) under ``attitudes`` (>= steps + ``ahead``, 3, 3)."""
    period, motion = program.motion.period, program.motion
    state = np.array(start, dtype=np.float64)
    states, plans = [state], []
    underway = TwoBody(Orbit.of(motion.mean_motion)).start(state) if truth == "two_body_j2" else None
    for k in range(steps):
        if context is not None:
            context.step(k, steps, "flight")
        plan = program.plan(attitudes[k:], state)
        if not plan.feasible:
            break
        given = attitudes[k].T @ plan.inputs[0]
        if underway is None:
            state = motion.after(state, given)
        else:
            thrust = given / period if motion.held else np.zeros(3)
            underway.fly(thrust, np.array([k * period, (k + 1) * period]))
            if not motion.held:
                underway.push(given)
            state = underway.state.copy()
        plans.append(plan)
        states.append(state)
    path = np.array(states)
    body = np.einsum("kij,kj->ki", attitudes[: len(path)], path[:, :3])
    slack = float(program.faces.slack(body).min())
    given = np.array([frame.T @ plan.inputs[0] for frame, plan in zip(attitudes, plans, strict=False)])
    between = _between(program, tumble, path, given.reshape(-1, 3))
    return TrackedFlight(path, body, tuple(plans), slack, between, len(plans) == steps)


def _between(program: Program, tumble: Tumble, path: Floats, given: Floats) -> float:
    """Least slack between the nodes (HCW) with the LVLH inputs ``given`` (K, 3), m."""
    motion, least = program.motion, np.inf
    nodes = motion.period * np.arange(float(len(path) - 1))
    times = motion.period * np.arange(1.0, _BETWEEN + 1.0) / (_BETWEEN + 1)
    transition, push = held_through(Cwh(motion.mean_motion), 0.0, times)
    for phi, effect, time in zip(transition, push, times.tolist(), strict=True):
        places = path[:-1] @ phi[:3].T
        if motion.held:
            places += given @ effect[:3].T / motion.period
        turned = tumble.attitude.rotation(nodes + time)
        body = np.einsum("kij,kj->ki", turned, places)
        least = min(least, float(np.min(program.faces.slack(body), initial=np.inf)))
    return least
