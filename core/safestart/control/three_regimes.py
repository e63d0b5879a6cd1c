"""The controller of paper 000: the nominal command of three regimes, then the single-input safety filter.

For thousands of flights :mod:`safestart.simulation.compiled_loop` gives the same commands.
"""

from __future__ import annotations

import math

import numpy as np

from safestart.control.controller import Command
from safestart.control.forecast import Plan
from safestart.control.regimes import REGIMES, nominal_command
from safestart.control.safety_filter import filter_command
from safestart.model.scenario import Floats


class ThreeRegimes:
    """One flight after another with the tables of ``plan``; commands are labelled with their regime.

    A command is feasible if (7) was; otherwise it is the fallback's. In a planar plan the thrust has no z part. A
    flight that goes on from another one begins in interval ``first`` of the plan, after the command ``before`` (d,),
    m/s^2.
    """

    def __init__(self, plan: Plan, *, first: int = 0, before: Floats | None = None) -> None:
        self._plan, self._first = plan, first
        self._dimensions = plan.normals.shape[1]
        self._before = np.zeros(self._dimensions) if before is None else before
        self._previous, self._range, self._fastest = self._before, 0.0, 0.0

    def begin(self, state: Floats) -> None:
        """Reset the previous command; set the speed cap from the range."""
        plan = self._plan
        self._previous = self._before
        self._range = math.sqrt(float(state[:3] @ state[:3]))
        self._fastest = plan.closing_factor * math.sqrt(plan.law.max_acceleration * self._range)

    def command(self, k: int, state: Floats) -> Command:
        """See :class:`safestart.control.controller.Controller`."""
        plan, k = self._plan, k + self._first
        cos, sin = plan.rotation[k].tolist()
        x, y, z, vx, vy, vz = state.tolist()
        time, law = k * plan.dt, plan.law
        *wanted, regime = nominal_command(
            x, y, z, vx, vy, vz, time, cos, sin, self._range, self._fastest, law
        )
        self._previous, feasible = filter_command(plan, k, state, np.array(wanted), self._previous)
        thrust = np.zeros(3)
        thrust[: self._dimensions] = self._previous
        return Command(thrust, feasible, REGIMES[regime])
