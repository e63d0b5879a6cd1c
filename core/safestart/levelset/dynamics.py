"""The motion of a level-set problem: dx/dt = f(x, t) + sum over inputs of G(x, t) u, u in a box or a ball.

An input with ``aim`` "min" makes the value small, one with "max" makes it large. The Hamiltonian is then

    H = p . f + sum over inputs of (+-) sigma_U(G^T p),    sigma_U(s) = max over u in U of s . u,

with the plus sign for "max". With the inputs in this form the minimum and the maximum may be exchanged (Isaacs).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal, Protocol

import numpy as np

from safestart.errors import invalid
from safestart.levelset.lattice import Lattice
from safestart.model.scenario import Floats

Aim = Literal["min", "max"]


@dataclass(frozen=True, slots=True)
class Box:
    """Inputs between ``low`` and ``high``, (m,)."""

    low: Floats
    high: Floats

    @property
    def middle(self) -> Floats:
        """Centre (m,)."""
        return 0.5 * (self.low + self.high)

    @property
    def half(self) -> Floats:
        """Half widths (m,)."""
        return 0.5 * (self.high - self.low)


@dataclass(frozen=True, slots=True)
class Ball:
    """Inputs within ``radius`` of ``middle``, (m,)."""

    middle: Floats
    radius: float


@dataclass(frozen=True, slots=True)
class Input:
    """One player's input: gains ``matrix`` (n, m), its set, and whether it lowers or raises the value.

    ``price`` is a running cost of the input's size (its norm; for a box the sum of the components' sizes), paid
    by the player who chooses: the support function a |s| of a ball becomes a max(|s| - price, 0).
    """

    matrix: Floats
    bound: Box | Ball
    aim: Aim
    price: float = 0.0


@dataclass(frozen=True, slots=True)
class Rates:
    """Motion on the nodes at one time, arrays that broadcast against the grid.

    ``drift[i]`` holds the terms whose sum is dx_i/dt without inputs; ``gains[k][c][i]`` is the effect of one unit of
    channel c of input k on dx_i/dt, None for no effect.
    """

    drift: list[list[Floats]]
    gains: list[list[list[Floats | None]]]


class Motion(Protocol):
    """The interface of a model to the solver: its input sets, and its rates on a lattice."""

    @property
    def bounds(self) -> list[tuple[Box | Ball, Aim, float]]:
        """Set, aim and price of every input."""
        ...

    @property
    def varies(self) -> bool:
        """Whether the rates depend on time."""
        ...

    def rates(self, lattice: Lattice, time: float) -> Rates:
        """Rates on the nodes at ``time``."""
        ...

    def gains_at(self, states: Floats, time: float) -> list[Floats]:
        """G of every input, arrays that broadcast to (..., n, m), at states (..., n)."""
        ...


@dataclass(frozen=True)
class Linear:
    """dx/dt = A x + c + sum of G u, ``matrix`` (n, n) constant or a function of time (s), ``offset`` c (n,)."""

    matrix: Floats | Callable[[float], Floats]
    inputs: tuple[Input, ...] = ()
    offset: Floats | None = None
    varies: bool = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "varies", callable(self.matrix))
        a = self.at(0.0)
        n = len(a)
        if a.shape != (n, n) or not np.isfinite(a).all():
            raise invalid("matrix", "a finite square matrix", a.shape)
        for k, given in enumerate(self.inputs):
            check_input(f"inputs[{k}]", given, n)

    def at(self, time: float) -> Floats:
        """A (n, n) at a time (s)."""
        return np.asarray(self.matrix(time) if callable(self.matrix) else self.matrix, dtype=np.float64)

    @property
    def bounds(self) -> list[tuple[Box | Ball, Aim, float]]:
        """Set, aim and price of every input."""
        return [(given.bound, given.aim, given.price) for given in self.inputs]

    def rates(self, lattice: Lattice, time: float) -> Rates:
        """Rates on the nodes: one term per nonzero coefficient, so that no array is as large as the grid."""
        a, n = self.at(time), lattice.ndim
        if len(a) != n:
            raise invalid("matrix", f"{n} states, as many as the lattice has axes", a.shape)
        one = np.ones((1,) * n)
        offset = np.zeros(n) if self.offset is None else np.asarray(self.offset, dtype=np.float64)
        x = lattice.coordinates()
        drift = [[a[i, k] * x[k] for k in range(n) if a[i, k] != 0.0] + [offset[i] * one] for i in range(n)]
        gains: list[list[list[Floats | None]]] = []
        for given in self.inputs:
            g = np.asarray(given.matrix, dtype=np.float64)
            gains.append(
                [[g[i, c] * one if g[i, c] != 0.0 else None for i in range(n)] for c in range(g.shape[1])]
            )
        return Rates(drift, gains)

    def gains_at(self, states: Floats, time: float) -> list[Floats]:
        """G (n, m) of every input: the same at all states."""
        del states, time
        return [np.asarray(given.matrix, dtype=np.float64) for given in self.inputs]


def check_input(name: str, given: Input, n: int) -> None:
    """Raise ``InvalidInput`` unless gains, set, aim and price fit each other."""
    shape = np.shape(given.matrix)
    if len(shape) != 2 or shape[0] != n or not np.isfinite(given.matrix).all():
        raise invalid(f"{name}.matrix", f"a finite matrix with {n} rows", shape)
    check_bound(name, given.bound, given.aim, given.price, shape[1])


def check_bound(name: str, bound: Box | Ball, aim: str, price: float, channels: int) -> None:
    """Raise ``InvalidInput`` unless a set has ``channels`` components and finite size."""
    sizes = bound.half if isinstance(bound, Box) else np.array([bound.radius])
    if np.shape(bound.middle) != (channels,) or not np.isfinite(bound.middle).all():
        raise invalid(f"{name}.bound", f"{channels} finite components", bound.middle)
    if not (np.isfinite(sizes).all() and (sizes >= 0.0).all()):
        raise invalid(f"{name}.bound", "finite half widths or radius, not negative", sizes.tolist())
    if aim not in ("min", "max"):
        raise invalid(f"{name}.aim", "min or max", aim)
    if not (price >= 0.0 and (price == 0.0 or not np.any(bound.middle))):
        raise invalid(f"{name}.price", "a price >= 0, and with a price a set centred at zero", price)
