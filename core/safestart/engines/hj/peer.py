"""The time loop of hj-reachability, compiled ahead of time and reused for problems of the same shape.

Frame, tumble rate, thrust, corridor and box are arguments of the compiled program, so a second operating point needs no
compilation. Arithmetic is float32, JAX's default.
"""

from __future__ import annotations

import math
import threading
import time
from collections import OrderedDict
from enum import StrEnum
from functools import partial
from typing import Any, NamedTuple

import hj_reachability as hj
import jax
import jax.numpy as jnp
import numpy as np

from safestart.attitude.body_frame import into_body
from safestart.engines.base import Problem
from safestart.engines.hj.domain import Domain
from safestart.engines.hj.frame import Frame, coefficients
from safestart.engines.hj.model import LinearMotion
from safestart.engines.hj.settings import Settings
from safestart.engines.hj.target import MATCH_S, faces
from safestart.model.scenario import Floats, SetKind

KEPT_PROGRAMS = 8


def _edge(values: Any, width: int) -> Any:
    """Pad by repeating the last value: without a slope across the wall nothing can flow in from outside.

    With the first-order scheme the update is then a mean of values on the grid, and the value stays between
    the extremes of the target function. The library's ``extrapolate_away_from_zero`` continues the slope
    outwards instead, and inflow feeds on it without bound.
    """
    return jnp.pad(values, width, "edge")


def make_lattice(domain: Domain, settings: Settings) -> hj.Grid:
    """Grid of the library over a box, axes (x, y, vx, vy)."""
    box = hj.sets.Box(jnp.asarray(-domain.half, jnp.float32), jnp.asarray(domain.half, jnp.float32))
    return hj.Grid.from_lattice_parameters_and_boundary_conditions(
        box, settings.shape, boundary_conditions=(_edge,) * 4
    )


class Sweep(StrEnum):
    """How the value is limited on the way back in time."""

    END = "end"
    """No limit: the corridor counts only at the horizon."""
    STILL = "still"
    """It never rises: a tube towards a fixed corridor (min(0, H) of the library)."""
    TURNING = "turning"
    """It is cut off at l(R(-omega_t t) p) after every step: a tube towards a turning corridor."""

    @classmethod
    def of(cls, kind: SetKind, frame: Frame) -> Sweep:
        """The sweep for a kind of set in a frame."""
        if kind is not SetKind.TUBE:
            return cls.END
        return cls.STILL if frame is Frame.BODY else cls.TURNING


class Parameters(NamedTuple):
    """The arguments of a compiled program: numbers () and the corridor's ``faces`` (k, 3), all float32.

    ``match`` is None for the position-only target, which has its own program.
    """

    turn: Any
    gx: Any
    gy: Any
    a_max: Any
    match: Any
    courant: Any
    tumble_rate: Any
    faces: Any


def _distance(rows: Any, angle: Any, lattice: Any) -> Any:
    """l(R(-angle) p) on the nodes, shape (nx, ny, 1, 1), metres."""
    x, y = lattice.coordinate_vectors[0][:, None], lattice.coordinate_vectors[1][None, :]
    c, s = jnp.cos(angle), jnp.sin(angle)
    points = jnp.stack([*into_body(c, s, x, y), jnp.ones_like(x + y)], axis=-1)
    return (points @ rows.T).max(axis=-1)[:, :, None, None]


def _mismatch(parameters: Parameters, lattice: Any) -> Any:
    """tau (|v - omega x p| - match) on the nodes in LVLH, (nx, ny, nvx, nvy), metres; the same at every time."""
    x, y, vx, vy = jnp.meshgrid(*lattice.coordinate_vectors, indexing="ij", sparse=True)
    rate = parameters.tumble_rate
    return MATCH_S * (jnp.hypot(vx + rate * y, vy - rate * x) - parameters.match)


def _advance(
    accuracy: str, sweep: Sweep, lattice: Any, parameters: Parameters, values: Any, span: Any, angle: Any
) -> Any:
    """Value ``span`` seconds earlier, and whether it is finite with its extremes.

    The model does not depend on time, so every stretch may run from 0 to -span: after an hour a float32 clock cannot
    resolve a step of a tenth of a millisecond. ``angle`` is the corridor's turn at the stretch's later end.
    """

    def cut(time: Any, value: Any) -> Any:
        target = _distance(parameters.faces, angle + parameters.tumble_rate * time, lattice)
        if parameters.match is not None:
            target = jnp.maximum(target, _mismatch(parameters, lattice))
        return jnp.minimum(value, target)

    scheme = hj.SolverSettings.with_accuracy(
        accuracy,
        hamiltonian_postprocessor=(
            hj.solver.backwards_reachable_tube if sweep is Sweep.STILL else hj.solver.identity
        ),
        value_postprocessor=cut if sweep is Sweep.TURNING else hj.solver.identity,
        CFL_number=parameters.courant,
    )
    dynamics = LinearMotion(parameters.turn, parameters.gx, parameters.gy, parameters.a_max)
    start = jnp.zeros((), jnp.float32)
    values = hj.step(scheme, dynamics, lattice, start, values, -span, progress_bar=False)
    return values, jnp.isfinite(values).all(), values.min(), values.max()


_programs: OrderedDict[tuple[Any, ...], Any] = OrderedDict()
_lock = threading.Lock()


def _program(settings: Settings, sweep: Sweep, arguments: tuple[Any, ...]) -> tuple[Any, float]:
    """Compiled :func:`_advance` and its compilation time in seconds (0 if it was compiled already)."""
    key = (settings.shape, settings.accuracy, sweep, settings.match is None)
    with _lock:
        if key in _programs:
            _programs.move_to_end(key)
            return _programs[key], 0.0
        begin = time.perf_counter()
        _programs[key] = jax.jit(partial(_advance, settings.accuracy, sweep)).lower(*arguments).compile()
        if len(_programs) > KEPT_PROGRAMS:
            _programs.popitem(last=False)
        return _programs[key], time.perf_counter() - begin


class PeerSolver:
    """Value function on the lattice, stepped backwards in stretches from the horizon.

    ``values`` is the library's array over (x, y, vx, vy), metres; ``compile_s`` the time for compilation and one
    warm-up stretch of no length, so that :meth:`advance` only runs compiled code.
    """

    def __init__(
        self, problem: Problem, domain: Domain, settings: Settings, terminal: Floats, courant: float
    ) -> None:
        scenario = problem.scenario
        self._lattice = make_lattice(domain, settings)
        self._tumble_rate, self._time = scenario.target.tumble_rate, problem.horizon
        turn, gx, gy = coefficients(scenario.target, settings.frame)
        self._parameters = Parameters(
            turn=jnp.asarray(turn, jnp.float32),
            gx=jnp.asarray(gx, jnp.float32),
            gy=jnp.asarray(gy, jnp.float32),
            a_max=jnp.asarray(scenario.chaser.max_acceleration, jnp.float32),
            match=None if settings.match is None else jnp.asarray(settings.match, jnp.float32),
            courant=jnp.asarray(courant, jnp.float32),
            tumble_rate=jnp.asarray(self._tumble_rate, jnp.float32),
            faces=jnp.asarray(faces(scenario.corridor), jnp.float32),
        )
        self.values = jnp.asarray(terminal, jnp.float32)
        sweep = Sweep.of(problem.kind, settings.frame)
        self._run, self.compile_s = _program(settings, sweep, self._arguments(0.0))
        begin = time.perf_counter()
        self._run(*self._arguments(0.0))[1].block_until_ready()
        self.compile_s += time.perf_counter() - begin

    def _arguments(self, span: float) -> tuple[Any, ...]:
        # Reduce the angle in float64: after an hour a float32 angle would cause errors of centimetres.
        angle = math.fmod(self._tumble_rate * self._time, math.tau)
        scalars = (jnp.asarray(span, jnp.float32), jnp.asarray(angle, jnp.float32))
        return self._lattice, self._parameters, self.values, *scalars

    def advance(self, span: float) -> tuple[bool, float, float]:
        """Step ``span`` seconds back; returns whether all values are finite, and the least and largest value."""
        self.values, finite, low, high = self._run(*self._arguments(span))
        self._time -= span
        return bool(finite), float(low), float(high)

    def value(self) -> Floats:
        """The value function in float64."""
        return np.asarray(self.values, dtype=np.float64)
