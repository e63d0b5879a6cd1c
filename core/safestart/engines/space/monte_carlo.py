"""Closed-loop flights in space: every start flown by the sequence controller, watched at all times by the simulation.

A start is safe when no distance of its flight became negative in continuous time. Without navigation noise the
controller flies its first plan, and its set is that of the exact question `stay`; the flight itself, its motion and its
watch are the simulation's own.
"""

from __future__ import annotations

import time
from functools import cache
from typing import Any

import numpy as np

from safestart.attitude.attitude import Attitude
from safestart.constraints.corridor import polyhedron
from safestart.dynamics.motion import RelativeMotion
from safestart.engines.base import EngineResult, ResultCode
from safestart.engines.space.problem import PlaneProblem
from safestart.engines.space.sequence import SequenceInSpace
from safestart.exact.space.question import Face, SpaceQuestion
from safestart.model.scenario import Floats
from safestart.runtime.progress import Context
from safestart.simulation.loop import fly
from safestart.simulation.noise import Drawn, draws, truth_of
from safestart.simulation.plant import Plant
from safestart.simulation.record import Record


class _Still:
    """LVLH itself as an attitude: for faces that do not turn."""

    def rotation(self, times: Floats) -> Floats:
        """The identity at every time."""
        return np.broadcast_to(np.eye(3), (*np.shape(times), 3, 3))

    def angular_velocity(self, times: Floats) -> Floats:
        """0 at every time."""
        return np.zeros((*np.shape(times), 3))

    def rate_bounds(self) -> tuple[float, float]:
        """0."""
        return 0.0, 0.0


class _Fixed:
    """The faces of one frame as a constraint."""

    def __init__(self, faces: list[Face]) -> None:
        self._still = _Still() if faces[0].frame == "lvlh" else None
        names = tuple(face.name for face in faces)
        normals = np.array([face.normal for face in faces])
        self._inner = polyhedron(normals, np.array([face.offset for face in faces]), names)
        self.names = names

    def room(self, times: Floats, states: Floats, attitude: Attitude) -> tuple[Floats, Floats]:
        """See :class:`safestart.constraints.constraint.Constraint`."""
        return self._inner.room(times, states, self._still or attitude)


class _Remembered(RelativeMotion):
    """A motion that computes each matrix once: all flights ask for the same times."""

    def __init__(self, motion: RelativeMotion) -> None:
        self._transition, self._held = cache(motion.transition), cache(motion.held)

    def transition(self, t0: float, t1: float) -> Floats:
        """See :class:`~safestart.dynamics.motion.RelativeMotion`."""
        return self._transition(t0, t1)

    def held(self, t0: float, t1: float) -> Floats:
        """See :class:`~safestart.dynamics.motion.RelativeMotion`."""
        return self._held(t0, t1)


class FlownInSpace:
    """Flies starts of one question by the sequence controller; ``sigma`` is the noise of navigation, m and m/s.

    Case ``n`` has the same noise in every study with this ``seed``.
    """

    def __init__(self, question: SpaceQuestion, sigma: tuple[float, float], seed: int) -> None:
        frames = [[face for face in question.faces if face.frame == frame] for frame in ("body", "lvlh")]
        self._question, self._seed = question, seed
        self._constraints = [_Fixed(faces) for faces in frames if faces]
        self._plant = Plant(_Remembered(question.motion), question.attitude)
        self._controller = SequenceInSpace(question)
        self._truth = truth_of(position_sigma=sigma[0], velocity_sigma=sigma[1])

    def fly(self, state: Floats, case: int) -> Record:
        """One flight from ``state`` (6,), LVLH, watched at all times until it leaves the faces."""
        question = self._question
        drawn = draws(self._truth, self._seed, np.array([case]), question.steps, planar=False)
        errors = Drawn(self._truth, drawn[0] if len(drawn) else drawn)
        return fly(
            self._plant, self._constraints, self._controller, state, question.steps, question.dt, errors
        )


class MonteCarlo:
    """Flies every start inside the faces over the whole horizon."""

    def solve(self, problem: PlaneProblem, context: Context) -> EngineResult:
        """``margin`` is the least distance of the flight, m; outside the faces that of the start."""
        begin = time.perf_counter()
        question = problem.question
        flown = FlownInSpace(question, problem.sigma, problem.seed)
        distance = problem.distance()
        margin = distance.copy()
        inside = np.argwhere(distance >= 0.0)
        states = problem.states()
        safe = planned = steps = fallbacks = 0
        effort = 0.0
        for done, (row, column) in enumerate(inside.tolist()):
            flight = flown.fly(states[row, column], row * problem.across + column)
            margin[row, column] = flight.margin[0]
            safe += int(flight.margin[0] >= 0.0)
            steps += int(flight.steps[0])
            fallbacks += int(flight.fallbacks[0])
            effort += float(flight.delta_v[0])
            planned += sum(command.label == "planned" for command in flight.paths[0].commands)
            context.step(done + 1, len(inside), "flights")
        run = time.perf_counter() - begin
        if not np.isfinite(margin).all():
            message = "a flight left the floating-point numbers"
            return EngineResult(ResultCode.NUMERICAL_FAILURE, None, None, run, 0.0, message)
        detail: dict[str, Any] = {
            "controller": "sequence",
            "t_sim_s": question.horizon,
            "dt_s": question.dt,
            "position_sigma_m": problem.sigma[0],
            "velocity_sigma_m_s": problem.sigma[1],
            "flights": len(inside),
            "safe_flights": safe,
            "control_steps": steps,
            "plans": planned,
            "infeasible_plans_flown": fallbacks,
            "mean_delta_v_m_s": effort / len(inside) if len(inside) else 0.0,
        }
        mask = (distance >= 0.0) & (margin >= 0.0)
        return EngineResult(ResultCode.OK, mask, margin, run, detail=detail)
