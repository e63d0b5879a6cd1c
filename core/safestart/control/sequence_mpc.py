"""MPC over the whole thrust sequence: shrinking horizon, thrust disk, corridor kept at all times.

A plan is a thrust sequence for the rest of the flight together with the margin that it keeps in continuous time, proved
by the cubic enclosure of :mod:`safestart.exact.watch`. The horizon shrinks with the flight, so the tail of an
admissible plan is admissible: recursively feasible by construction. The cost is total impulse, which adds up over the
steps; without disturbance the tail of an optimal plan is therefore optimal (Bellman) and solving again would return
it. So each step checks the plan, and solves again only when the state has left the plan by more than its margin covers.

If no plan keeps the corridor, the controller flies the plan with the least violation, counts the case, and tries again
in every step.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from safestart.control.controller import Command
from safestart.control.least_fuel import least_fuel
from safestart.exact.answer import GUARD, Verdict
from safestart.exact.question import Question
from safestart.exact.search import Search
from safestart.exact.watch import Watch, watch_of
from safestart.model.scenario import Floats

TOLERANCE = 0.01
"""Bracket (m) to which the largest margin is found before impulse is saved."""

CLEARANCE, SHARE = 0.25, 0.5
"""Margin (m) that a plan keeps if possible; if the largest margin is smaller, this share of it."""

KEPT = 0.5
"""A plan stays while its tail, from the chaser's true state, keeps this share of its margin."""


@dataclass(frozen=True, slots=True)
class Plan:
    """Thrusts (m, 2) in m/s^2, the node states (m + 1, 4) on the way, and the kept margin (m).

    ``verdict`` is the exact answer for the state the plan begins at; NO_GO and UNDECIDED plans violate least.
    """

    thrust: Floats
    nodes: Floats
    margin: float
    verdict: Verdict


class SequencePlanner:
    """Plans of one scenario with ``steps`` intervals of ``dt`` seconds in the orbit plane."""

    def __init__(self, question: Question) -> None:
        self.question = question
        self._turn = question.scenario.target.tumble_rate * question.dt

    def plan(self, step: int, state: Floats) -> Plan:
        """Plan from ``state`` (4,) at the start of interval ``step`` to the end of the flight."""
        watch = self._watch(step)
        search = Search(watch, state)
        search.narrow(TOLERANCE)
        verdict = Verdict.UNDECIDED
        if search.lower > GUARD:
            verdict = Verdict.GO
        elif search.upper < -GUARD or search.distance_now < -GUARD:
            verdict = Verdict.NO_GO
        thrust, margin = search.thrust, search.lower
        if thrust is None:  # the solver gave nothing usable: coast and report it
            thrust = np.zeros((watch.question.steps, 2))
            margin = watch.minima(state, thrust).lowest
        if verdict is Verdict.GO:
            wanted = min(CLEARANCE, SHARE * search.lower)
            saved = least_fuel(watch, state, search.times, search.faces, wanted)
            if saved is not None:
                thrust, margin = saved
        return Plan(thrust, self._nodes(watch, state, thrust), margin, verdict)

    def kept(self, plan: Plan, first: int, step: int, state: Floats) -> Plan | None:
        """``plan``, made at interval ``first``, if its tail still holds from ``state`` at ``step``; None otherwise."""
        tail = plan.thrust[step - first :]
        off = state - plan.nodes[step - first]
        left = (self.question.steps - step) * self.question.dt
        # |Phi_r(t)| over at most an hour is near (1, t); a fifth more covers CWH up to n t = 0.3.
        reach = 1.2 * (float(np.hypot(off[0], off[1])) + left * float(np.hypot(off[2], off[3])))
        if plan.verdict is not Verdict.GO:
            return plan if reach <= 1e-6 else None
        if reach <= (1.0 - KEPT) * plan.margin:
            return plan
        watch = self._watch(step)
        if watch.minima(state, tail).lowest >= KEPT * plan.margin:
            return plan
        return None

    def _watch(self, step: int) -> Watch:
        question = self.question
        left = Question(question.scenario, question.dt, question.steps - step)
        return watch_of(left, step * self._turn)

    def _nodes(self, watch: Watch, state: Floats, thrust: Floats) -> Floats:
        flown = watch.prediction.flight(state, thrust)
        return np.concatenate([flown[:, 0], flown[-1:, -1]])


@dataclass(frozen=True, slots=True)
class PlannedCommand(Command):
    """A command of a plan, labelled ``planned`` or ``kept``; ``verdict`` is the exact answer where the plan begins."""

    verdict: Verdict = Verdict.UNDECIDED


class SequenceMpc:
    """The planner as a controller: the plan's thrust, from a new plan when the old one no longer holds."""

    def __init__(self, question: Question) -> None:
        self._planner = SequencePlanner(question)
        self._plan: Plan | None = None
        self._first = 0

    def begin(self, state: Floats) -> None:  # noqa: ARG002
        """No plan yet."""
        self._plan = None

    def command(self, k: int, state: Floats) -> PlannedCommand:
        """See :class:`safestart.control.controller.Controller`; feasible when the plan keeps the corridor."""
        planar = state[[0, 1, 3, 4]]
        plan = self._plan and self._planner.kept(self._plan, self._first, k, planar)
        label = "kept" if plan else "planned"
        if plan is None:
            plan, self._first = self._planner.plan(k, planar), k
            self._plan = plan
        thrust = np.append(plan.thrust[k - self._first], 0.0)
        return PlannedCommand(thrust, plan.verdict is Verdict.GO, label, verdict=plan.verdict)


def start_verdict(commands: Sequence[Command]) -> Verdict | None:
    """The exact answer for the first state of a flight's commands; None for another controller."""
    first = commands[0] if commands else None
    return first.verdict if isinstance(first, PlannedCommand) else None
