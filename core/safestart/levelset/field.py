"""A value function on a lattice, read at any state inside it, and the optimal inputs there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from safestart.errors import invalid
from safestart.levelset.dynamics import Ball, Motion
from safestart.levelset.kernels.lookup import lookup
from safestart.levelset.lattice import Boundary, Lattice
from safestart.model.scenario import Floats
from safestart.model.unit import unit


@dataclass(frozen=True, slots=True)
class ValueField:
    """``values`` (shape of the lattice, float64), the value function at one time."""

    lattice: Lattice
    values: Floats

    def value_at(self, states: Floats) -> Floats:
        """V (...) at states (..., n), multilinear. Raises ``InvalidInput`` for states outside the lattice."""
        return self.read(states)[0]

    def gradient_at(self, states: Floats) -> Floats:
        """Gradient of V (..., n) at states (..., n): central differences, multilinear between nodes.

        Raises ``InvalidInput`` for states outside the lattice.
        """
        return self.read(states)[1]

    def read(self, states: Floats) -> tuple[Floats, Floats]:
        """Value (...) and gradient (..., n) at states (..., n); raises ``InvalidInput`` outside the lattice."""
        lattice = self.lattice
        states = np.asarray(states, dtype=np.float64)
        if states.ndim == 0 or states.shape[-1] != lattice.ndim:
            raise invalid("states", f"last axis of length {lattice.ndim}", states.shape)
        flat = states.reshape(-1, lattice.ndim)
        periodic = np.array([b is Boundary.PERIODIC for b in lattice.boundary])
        low, high = np.array(lattice.low), np.array(lattice.high)
        slack = 1e-12 * (high - low)
        inside = ((flat >= low - slack) & (flat <= high + slack) | (periodic & np.isfinite(flat))).all(axis=1)
        if not inside.all():
            raise invalid(
                "states",
                f"inside the lattice, {list(lattice.low)} to {list(lattice.high)}",
                flat[np.argmin(inside)].tolist(),
            )
        out = np.empty((len(flat), 1 + lattice.ndim))
        shape = np.array(lattice.shape, dtype=np.int64)
        values = np.ascontiguousarray(self.values, dtype=np.float64).ravel()
        lookup(
            values, shape, low, lattice.spacing, periodic.astype(np.int64), np.ascontiguousarray(flat), out
        )
        lead = states.shape[:-1]
        return out[:, 0].reshape(lead), out[:, 1:].reshape(states.shape)


def optimal_inputs(motion: Motion, gradient: Floats, states: Floats, time: float = 0.0) -> list[Floats]:
    """Each player's optimal input (..., m) for gradients (..., n) at states (..., n).

    The input of an aim "max" maximises gradient . G u over its set, "min" minimises it. If the gradient does not move a
    channel of a box, "max" takes its upper end and "min" its lower end; a ball gives its middle. A priced input stays
    at zero if its effect is not worth the price.
    """
    found = []
    for (bound, aim, price), gains in zip(motion.bounds, motion.gains_at(states, time), strict=True):
        slope = np.einsum("...i,...ic->...c", gradient, gains)
        if aim == "min":
            slope = -slope
        if isinstance(bound, Ball):
            size = np.linalg.norm(slope, axis=-1, keepdims=True)
            found.append(bound.middle + bound.radius * np.where(size > price, unit(slope), 0.0))
        else:
            ends = np.where(slope < 0.0, bound.low, bound.high)
            if aim == "min":
                ends = np.where(slope > 0.0, bound.high, bound.low)
            found.append(np.where(np.abs(slope) > price, ends, 0.0) if price > 0.0 else ends)
    return found
