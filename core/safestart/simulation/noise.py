"""Deviations of the simulated world from the plan: navigation noise, thruster errors, external accelerations."""

from __future__ import annotations

import math
from typing import NamedTuple, Protocol

import numpy as np

from safestart.attitude.turn_kernel import out_of_body
from safestart.dynamics.burn import scattered
from safestart.model.scenario import Floats, number
from safestart.runtime.kernels.compiled import compiled

AT_NODES, AT_SUBSTEPS, CONTINUOUS = 0, 1, 2
CHECKS = {"nodes": AT_NODES, "substeps": AT_SUBSTEPS, "continuous": CONTINUOUS}
"""Where to look for violations: at control nodes, at the sub-steps of paper 000, or at all times."""

DRAWS = 6
"""Standard normals per control step in the plane: navigation x, y, vx, vy, thrust magnitude, thrust direction."""

DRAWS_IN_SPACE = 9
"""Navigation x, y, z, vx, vy, vz, thrust magnitude, thrust direction about two axes."""


class Truth(NamedTuple):
    """Settings of the simulated world, as the compiled kernels take them.

    ``position_sigma`` (m) and ``velocity_sigma`` (m/s): white navigation noise per axis and control step;
    ``magnitude_sigma`` (relative) and ``direction_sigma`` (rad): error of each held thrust; ``minimum_impulse`` (m/s):
    a thrust whose impulse over the interval is smaller is not delivered.
    """

    check: int = AT_SUBSTEPS
    position_sigma: float = 0.0
    velocity_sigma: float = 0.0
    magnitude_sigma: float = 0.0
    direction_sigma: float = 0.0
    minimum_impulse: float = 0.0

    @property
    def noisy(self) -> bool:
        """Whether anything is drawn."""
        return any(self[1:5])

    @property
    def exact(self) -> bool:
        """Whether the world is perfect: exact thrust and a known state."""
        return not any(self[1:])


def truth_of(check: str = "continuous", **values: float) -> Truth:
    """Checked settings; raises ``InvalidInput`` for a value that is negative or not finite."""
    return Truth(CHECKS[check], **{name: number(name, value, 0.0, 1e3) for name, value in values.items()})


NO_DRAWS = np.empty((0, 0, DRAWS))


def draws(
    truth: Truth,
    seed: int,
    cases: np.ndarray[tuple[int], np.dtype[np.int64]],
    steps: int,
    *,
    planar: bool = True,
) -> Floats:
    """Standard normals (M, K, ``DRAWS`` or ``DRAWS_IN_SPACE``) of the numbered cases; empty when nothing is drawn.

    Each case has its own counter-based generator, so its draws depend only on seed and number.
    """
    if not truth.noisy:
        return NO_DRAWS
    out = np.empty((len(cases), steps, DRAWS if planar else DRAWS_IN_SPACE))
    for row, case in enumerate(cases.tolist()):
        bits = np.random.Philox(key=seed, counter=[0, 0, case, 0])
        out[row] = np.random.Generator(bits).standard_normal(out.shape[1:])
    return out


class Errors(Protocol):
    """The interface between a controller and the world."""

    def seen(self, k: int, state: Floats) -> Floats:
        """Navigation's estimate of the state (6,) at the start of interval ``k``."""
        ...

    def delivered(self, k: int, asked: Floats, held_s: float) -> Floats:
        """The thrust (3,) that the thrusters deliver over ``held_s`` seconds; for an impulse ``held_s`` is 1."""
        ...

    def push(self, k: int, state: Floats, thrust: Floats) -> Floats | None:
        """An external acceleration (3,), which costs no propellant, at the true state under ``thrust``; or None."""
        ...


class Exact:
    """No errors: known state, exact thrust, no external acceleration; the base of all other kinds."""

    def seen(self, k: int, state: Floats) -> Floats:  # noqa: ARG002
        """Navigation sees the state itself."""
        return state

    def delivered(self, k: int, asked: Floats, held_s: float) -> Floats:  # noqa: ARG002
        """The commanded thrust."""
        return asked

    def push(self, k: int, state: Floats, thrust: Floats) -> Floats | None:  # noqa: ARG002
        """No acceleration acts from outside."""
        return None


EXACT = Exact()


class Drawn(Exact):
    """Errors of one flight from its ``draws`` (K, ``DRAWS``) in the plane, (K, ``DRAWS_IN_SPACE``) in space.

    Empty draws leave the minimum impulse alone. The planar draws are those of the compiled loop.
    """

    def __init__(self, truth: Truth, draws: Floats) -> None:
        self._truth, self._draws = truth, draws
        self._planar = draws.shape[-1] == DRAWS
        self._scale = np.repeat([truth.position_sigma, truth.velocity_sigma], 3)
        if self._planar:
            self._scale[[2, 5]] = 0.0

    def seen(self, k: int, state: Floats) -> Floats:
        """White noise on every axis."""
        if not len(self._draws):
            return state
        drawn = self._draws[k]
        if self._planar:
            drawn = np.array([drawn[0], drawn[1], 0.0, *drawn[2:4], 0.0])
        noisy: Floats = state + self._scale * drawn[:6]
        return noisy

    def delivered(self, k: int, asked: Floats, held_s: float) -> Floats:
        """Scaled, turned, and nothing below the minimum impulse."""
        thrust = asked
        if len(self._draws):
            drawn = self._draws[k]
            if self._planar:
                thrust = np.array([*delivered(self._truth, asked[0], asked[1], drawn[4], drawn[5]), asked[2]])
            else:
                thrust = scattered(asked, self._truth.magnitude_sigma, self._truth.direction_sigma, drawn[6:])
        if math.sqrt(float(thrust @ thrust)) * held_s < self._truth.minimum_impulse:
            return np.zeros(3)
        return thrust


@compiled(error_model="numpy")
def delivered(truth, ux, uy, magnitude, direction):  # type: ignore[no-untyped-def]
    """In-plane thrust as the thrusters deliver it: scaled and turned."""
    scale = 1.0 + truth.magnitude_sigma * magnitude
    cos, sin = math.cos(truth.direction_sigma * direction), math.sin(truth.direction_sigma * direction)
    turned_x, turned_y = out_of_body(cos, sin, ux, uy)
    return scale * turned_x, scale * turned_y
