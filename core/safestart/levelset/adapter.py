"""Use models written for hj-reachability unchanged: evaluate them on the nodes once, by JAX if they need it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from safestart.errors import InvalidInput, invalid
from safestart.levelset.dynamics import Aim, Ball, Box, Motion, Rates, check_bound
from safestart.levelset.lattice import Lattice
from safestart.model.scenario import Floats

_NEEDED = (
    "open_loop_dynamics",
    "control_jacobian",
    "disturbance_jacobian",
    "control_mode",
    "disturbance_mode",
    "control_space",
    "disturbance_space",
)


class _NoTime:
    """Stands for the time when a model must not use it: any use raises ``TypeError``."""

    __slots__ = ()


@dataclass(frozen=True)
class Tabulated:
    """A control- and disturbance-affine model with the methods and attributes of hj-reachability's.

    dx/dt = open_loop_dynamics(x, t) + control_jacobian(x, t) u + disturbance_jacobian(x, t) d, with ``control_space``
    and ``disturbance_space`` a box (``lo``, ``hi``) or a ball (``center``, ``radius``) and modes "min" or "max".
    """

    model: Any
    varies: bool
    traced: bool
    _compiled: dict[str, Callable[..., Any]] = field(default_factory=dict)

    @classmethod
    def of(cls, model: Any, lattice: Lattice) -> Tabulated:
        """Wrap a model; raises ``InvalidInput`` when it lacks a member or has another number of states."""
        for name in _NEEDED:
            if not hasattr(model, name):
                raise invalid(
                    "dynamics", "a model of this package, or affine with " + ", ".join(_NEEDED), name
                )
        state = np.array([axis[len(axis) // 2] for axis in lattice.axes])
        first = model.open_loop_dynamics(state, 0.0)
        if np.shape(first) != (lattice.ndim,):
            raise invalid("dynamics", f"open_loop_dynamics of shape ({lattice.ndim},)", np.shape(first))
        traced = type(first).__module__.partition(".")[0] in ("jax", "jaxlib")
        return cls(model, _reads_time(model, state, traced), traced)

    @property
    def bounds(self) -> list[tuple[Box | Ball, Aim, float]]:
        """Set, aim and price of control and disturbance."""
        found: list[tuple[Box | Ball, Aim, float]] = []
        for player in ("control", "disturbance"):
            space, mode = getattr(self.model, f"{player}_space"), getattr(self.model, f"{player}_mode")
            bound = _bound(f"{player}_space", space)
            check_bound(f"{player}_space", bound, mode, 0.0, len(bound.middle))
            found.append((bound, mode, 0.0))
        return found

    def rates(self, lattice: Lattice, time: float) -> Rates:
        """Rates on the nodes, each stored only over the axes it depends on."""
        drift = self._over_nodes("open_loop_dynamics", lattice, time)
        gains: list[list[list[Floats | None]]] = []
        for player, (bound, _, _) in zip(("control", "disturbance"), self.bounds, strict=True):
            whole = self._over_nodes(f"{player}_jacobian", lattice, time)
            m = len(bound.middle)
            if len(whole) != lattice.ndim * m:
                raise invalid(f"{player}_jacobian", f"shape ({lattice.ndim}, {m})", f"{len(whole)} entries")
            table = [whole[i * m : (i + 1) * m] for i in range(lattice.ndim)]
            gains.append(
                [[entry if entry.any() else None for entry in column] for column in zip(*table, strict=True)]
            )
        return Rates([[term] for term in drift], gains)

    def gains_at(self, states: Floats, time: float) -> list[Floats]:
        """G of control and disturbance (..., n, m) at states (..., n)."""
        flat = np.reshape(states, (-1, np.shape(states)[-1]))
        return [
            found.reshape(*np.shape(states), -1)
            for found in (
                self._call(name, flat, time) for name in ("control_jacobian", "disturbance_jacobian")
            )
        ]

    def _over_nodes(self, name: str, lattice: Lattice, time: float) -> list[Floats]:
        """Every component of a method on the nodes, with length 1 along axes on which it does not depend."""
        axes = lattice.axes
        rest = np.stack(np.meshgrid(*axes[1:], indexing="ij"), axis=-1).reshape(-1, lattice.ndim - 1)
        layers: list[list[Floats]] = []
        for first in axes[0]:
            states = np.concatenate([np.full((len(rest), 1), first), rest], axis=1)
            found = self._call(name, states, time)
            if not np.isfinite(found).all():
                raise invalid(f"dynamics.{name}", "finite values on every node", "NaN or infinity")
            layers.append([_narrow(part.reshape(1, *lattice.shape[1:])) for part in found.T])
        return [_narrow(np.concatenate(np.broadcast_arrays(*parts))) for parts in zip(*layers, strict=True)]

    def _call(self, name: str, states: Floats, time: float) -> Floats:
        """A method at states (P, n), flattened per state: (P, entries)."""
        method: Callable[..., Any] = getattr(self.model, name)
        if not self.traced:
            found = [np.ravel(method(state, time)) for state in states]
            return np.asarray(found, dtype=np.float64).reshape(len(states), -1)
        import jax

        with jax.enable_x64(True):
            if name not in self._compiled:
                self._compiled[name] = jax.jit(jax.vmap(method, in_axes=(0, None)))
            batch = self._compiled[name](states, float(time))
            return np.asarray(batch, dtype=np.float64).reshape(len(states), -1)


def as_motion(model: Any, lattice: Lattice) -> Motion:
    """Return a motion of this package unchanged; wrap anything else as a model of hj-reachability's form."""
    if hasattr(model, "rates") and hasattr(model, "bounds"):
        motion: Motion = model
        return motion
    return Tabulated.of(model, lattice)


def _bound(name: str, space: Any) -> Box | Ball:
    if hasattr(space, "lo") and hasattr(space, "hi"):
        low, high = np.atleast_1d(np.asarray(space.lo, float)), np.atleast_1d(np.asarray(space.hi, float))
        return Box(low, high)
    if hasattr(space, "center") and hasattr(space, "radius"):
        return Ball(np.atleast_1d(np.asarray(space.center, float)), float(space.radius))
    raise invalid(name, "a box (lo, hi) or a ball (center, radius)", type(space).__name__)


def _narrow(values: Floats) -> Floats:
    """Keep one entry along every axis without variation."""
    for axis in range(values.ndim):
        first = values.take([0], axis=axis)
        if (values == first).all():
            values = first
    return values


def _reads_time(model: Any, state: Floats, traced: bool) -> bool:
    """Whether a model uses its time argument; in doubt, yes."""
    for name in ("open_loop_dynamics", "control_jacobian", "disturbance_jacobian"):
        method = getattr(model, name)
        if traced:
            import jax

            program = jax.make_jaxpr(method)(state, 0.0).jaxpr
            clock = program.invars[-1]
            if any(clock is given for step in program.eqns for given in step.invars):
                return True
        else:
            try:
                method(state, _NoTime())
            except InvalidInput:
                raise
            except (TypeError, AttributeError):
                return True
    return False
