"""Flights by name of controller in any world, interval by interval: the slow loop behind every truth option.

The fast loop for ``filter`` against CWH is :mod:`safestart.simulation.compiled_loop`; both fly the same commands.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from safestart.control.forecast import flight_plan
from safestart.control.gains import Gains
from safestart.control.regimes import nominal_command
from safestart.control.safety_filter import filter_command
from safestart.control.sequence_mpc import Plan, SequencePlanner
from safestart.exact.answer import Verdict
from safestart.exact.question import Question
from safestart.model.scenario import Floats, Scenario
from safestart.simulation.passage import delivered
from safestart.simulation.truth import Truth
from safestart.simulation.worlds import World


@dataclass(slots=True)
class Flown:
    """One flight of :mod:`safestart.simulation.compiled_loop`, with the times, states and commands of its nodes.

    ``fallbacks``: steps at which the controller found no admissible command. ``replans``: sequences made after the
    first. ``verdict``: the exact answer for the start, where the controller asked for it.
    """

    margin: float = math.inf
    violated_at: float = math.inf
    delta_v: float = 0.0
    fallbacks: int = 0
    replans: int = 0
    verdict: Verdict | None = None
    times: list[float] = field(default_factory=list)
    states: list[Floats] = field(default_factory=list)
    commands: list[Floats] = field(default_factory=list)

    @property
    def safe(self) -> bool:
        """Never outside the corridor, and a number throughout."""
        return self.margin >= 0.0 and math.isinf(self.violated_at)


class Pilot(Protocol):
    """A controller for one flight after another."""

    def begin(self, state: Floats) -> None:
        """A new flight starts at the LVLH state (6,)."""
        ...

    def command(self, step: int, state: Floats, flown: Flown) -> Floats:
        """Thrust (2,), m/s^2, for interval ``step`` from the state as navigation has it."""
        ...


class FilterPilot:
    """Three regimes and the single-input filter (paper 000)."""

    def __init__(self, scenario: Scenario, gains: Gains, dt: float, steps: int, nodes: int) -> None:
        self._plan = flight_plan(scenario, gains, dt, steps, nodes=nodes)
        self._previous, self._range, self._fastest = np.zeros(2), 0.0, 0.0

    def begin(self, state: Floats) -> None:
        """Nothing was commanded before; the speed cap follows from the range."""
        plan = self._plan
        self._previous = np.zeros(2)
        self._range = math.sqrt(float(state[:3] @ state[:3]))
        self._fastest = plan.closing_factor * math.sqrt(plan.law.max_acceleration * self._range)

    def command(self, step: int, state: Floats, flown: Flown) -> Floats:
        """Nominal command, then the filter."""
        plan = self._plan
        cos, sin = plan.rotation[step].tolist()
        x, y, z, vx, vy, vz = state.tolist()
        time, law = step * plan.dt, plan.law
        wanted = nominal_command(x, y, z, vx, vy, vz, time, cos, sin, self._range, self._fastest, law)
        self._previous, feasible = filter_command(plan, step, state, np.array(wanted[:3]), self._previous)
        flown.fallbacks += not feasible
        return self._previous


class SequencePilot:
    """MPC over the whole sequence."""

    def __init__(self, scenario: Scenario, dt: float, steps: int) -> None:
        self._planner = SequencePlanner(Question(scenario, dt, steps))
        self._plan: Plan | None = None
        self._first = 0

    def begin(self, state: Floats) -> None:  # noqa: ARG002
        """No plan yet."""
        self._plan = None

    def command(self, step: int, state: Floats, flown: Flown) -> Floats:
        """The plan's thrust, from a new plan where the old one no longer holds."""
        planar = state[[0, 1, 3, 4]]
        plan = self._plan and self._planner.kept(self._plan, self._first, step, planar)
        if plan is None:
            flown.replans += self._plan is not None
            plan, self._first = self._planner.plan(step, planar), step
            self._plan = plan
            if flown.verdict is None:
                flown.verdict = plan.verdict
        flown.fallbacks += plan.verdict is not Verdict.GO
        thrust: Floats = plan.thrust[step - self._first]
        return thrust


def fly_in(world: World, pilot: Pilot, steps: int, dt: float, truth: Truth, draws: Floats) -> Flown:
    """Fly ``steps`` intervals, or to the first violation; ``draws`` (K, 6) or empty, see :mod:`guidance.truth`."""
    flown = Flown(world.margin, world.violated_at)
    flown.times.append(world.time)
    flown.states.append(world.state.copy())
    pilot.begin(world.state)
    drawing = truth.noisy
    scale = np.zeros(6)
    scale[[0, 1]], scale[[3, 4]] = truth.position_sigma, truth.velocity_sigma
    for step in range(steps):
        if not world.margin >= 0.0:
            break
        seen = world.state
        if drawing:
            seen = seen + scale * np.array([draws[step, 0], draws[step, 1], 0.0, *draws[step, 2:4], 0.0])
        thrust = pilot.command(step, seen, flown)
        if drawing:
            thrust = np.array(delivered(truth, thrust[0], thrust[1], draws[step, 4], draws[step, 5]))
        size = math.sqrt(float(thrust @ thrust))
        if size * dt < truth.minimum_impulse:
            thrust, size = np.zeros(2), 0.0
        flown.delta_v += size * dt
        flown.commands.append(thrust)
        world.fly(thrust)
        flown.times.append(world.time)
        flown.states.append(world.state.copy())
    flown.margin, flown.violated_at = world.margin, world.violated_at
    return flown
