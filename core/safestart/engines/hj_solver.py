"""The time loop of hj-reachability, compiled ahead of time and kept for every problem of the same shape.

Tumble rate, thrust and box are arguments of the compiled program, so that a second operating point costs no
compilation. Arithmetic is float32, JAX's default.
"""

from __future__ import annotations

import threading
import time
from collections import OrderedDict
from functools import partial
from typing import Any

import hj_reachability as hj
import jax
import jax.numpy as jnp
import numpy as np

from safestart.engines.hj_domain import CFL_NUMBER, Domain
from safestart.engines.hj_model import BodyFrame, coefficients
from safestart.engines.hj_settings import Settings
from safestart.scenario import Floats, Scenario, SetKind

KEPT_PROGRAMS = 8


def _edge(values: Any, width: int) -> Any:
    """Pad by repeating the last value: no slope across the wall, so nothing can flow in that is not inside.

    With the first-order scheme the update is then a mean of values on the grid, and the value stays between
    the extremes of the target function. The library's ``extrapolate_away_from_zero`` continues the slope
    outwards instead, and inflow feeds on it without bound.
    """
    return jnp.pad(values, width, "edge")


_BOUNDARIES = {
    "edge": _edge,
    "extrapolate_away_from_zero": hj.boundary_conditions.extrapolate_away_from_zero,
}


def make_lattice(domain: Domain, settings: Settings) -> hj.Grid:
    """Grid of the library over a box, axes (x, y, vx, vy)."""
    box = hj.sets.Box(jnp.asarray(-domain.half, jnp.float32), jnp.asarray(domain.half, jnp.float32))
    return hj.Grid.from_lattice_parameters_and_boundary_conditions(
        box, settings.shape, boundary_conditions=(_BOUNDARIES[settings.boundary],) * 4
    )


def _advance(scheme: Any, lattice: Any, parameters: Any, values: Any, span: Any) -> Any:
    """Value ``span`` seconds earlier, and whether it is finite with its extremes.

    The model has no time in it, so that every stretch may run from 0 to -span: in float32 a clock that has
    run for an hour cannot resolve a step of a tenth of a millisecond.
    """
    dynamics = BodyFrame(parameters[0], parameters[1], parameters[2])
    start = jnp.zeros((), jnp.float32)
    values = hj.step(scheme, dynamics, lattice, start, values, -span, progress_bar=False)
    return values, jnp.isfinite(values).all(), values.min(), values.max()


_programs: OrderedDict[tuple[Any, ...], Any] = OrderedDict()
_lock = threading.Lock()


def _program(settings: Settings, kind: SetKind, lattice: Any, values: Any) -> tuple[Any, float]:
    """Compiled :func:`_advance` and the seconds its compilation took (0 when it was there already)."""
    key = (settings.shape, settings.accuracy, settings.boundary, kind)
    with _lock:
        if key in _programs:
            _programs.move_to_end(key)
            return _programs[key], 0.0
        begin = time.perf_counter()
        tube = kind is SetKind.TUBE
        scheme = hj.SolverSettings.with_accuracy(
            settings.accuracy,
            hamiltonian_postprocessor=hj.solver.backwards_reachable_tube if tube else hj.solver.identity,
            CFL_number=CFL_NUMBER,
        )
        example = (lattice, jnp.zeros(3, jnp.float32), values, jnp.zeros((), jnp.float32))
        _programs[key] = jax.jit(partial(_advance, scheme)).lower(*example).compile()
        if len(_programs) > KEPT_PROGRAMS:
            _programs.popitem(last=False)
        return _programs[key], time.perf_counter() - begin


class Solver:
    """Value function on the lattice, stepped backwards in stretches.

    ``values`` is the library's array over (x, y, vx, vy), metres; ``compile_s`` what compilation took, with
    one warm-up stretch of no length, so that :meth:`advance` runs compiled code only.
    """

    def __init__(
        self, scenario: Scenario, domain: Domain, settings: Settings, kind: SetKind, target: Floats
    ) -> None:
        self.lattice = make_lattice(domain, settings)
        turn, push = coefficients(scenario.target)
        self._parameters = jnp.array([turn, push, scenario.chaser.max_acceleration], jnp.float32)
        self.values = jnp.asarray(target, jnp.float32)
        self._run, self.compile_s = _program(settings, kind, self.lattice, self.values)
        begin = time.perf_counter()
        self._run(self.lattice, self._parameters, self.values, jnp.zeros((), jnp.float32))[
            1
        ].block_until_ready()
        self.compile_s += time.perf_counter() - begin

    def advance(self, span: float) -> tuple[bool, float, float]:
        """Step ``span`` seconds back; returns whether all values are finite, and their least and largest."""
        self.values, finite, low, high = self._run(
            self.lattice, self._parameters, self.values, jnp.asarray(span, jnp.float32)
        )
        return bool(finite), float(low), float(high)

    def value(self) -> Floats:
        """The value function in float64."""
        return np.asarray(self.values, dtype=np.float64)
