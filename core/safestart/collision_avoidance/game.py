"""The avoid game of paper 001: one satellite keeps its distance, the other tries to close it.

Axes are the paper's: x tangential (along-track), y radial, z normal to the orbit, then their rates. Controllers and
records are in LVLH; only ``Game.to_lvlh`` and its relatives convert between the two. Eqs. (4) and (5):

    x'' = -2 w y' + u_x + d_x,   y'' = 2 w x' + 3 w^2 y + u_y + d_y,   z'' = -w^2 z + u_z + d_z.

Player 1 chooses u and keeps |p| above the keep-out distance on [0, T]; Player 2 chooses d and wants it below once.
The value of a start X is V(X, T) = sup over u, inf over d of the least |p| - d_FCC on the way: unsafe where V <= 0.
The paper's eq. (12) swaps infimum and supremum, which makes Player 1 seek the collision.

Both players push the same channels, so Player 1 can realise every sum in W = U - D (Pontryagin difference), and Player
2 can hold the sum to W: the game is the problem of one player with inputs in W. See docs/theory/collision-avoidance.md.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from safestart.collision_avoidance.inputs import held_down, left_over
from safestart.constraints.thrust import InputSet
from safestart.dynamics.cwh import input_matrix, system_matrix, transition_matrix
from safestart.errors import invalid
from safestart.levelset import Ball, Box, Input, Linear
from safestart.levelset.dynamics import Aim
from safestart.model.scenario import MAX_MEAN_MOTION, Floats, number

MAX_KEEP_OUT = 100_000.0

# Positions of a game with m channels, as axes of LVLH (0 radial, 1 along-track, 2 normal).
_AXES = {1: (2,), 2: (1, 0), 3: (1, 0, 2)}


class Players(StrEnum):
    """The players' aims. ``PAPER`` is eq. (12) as printed, where Player 1 seeks the disk and Player 2 prevents it."""

    AVOID = "avoid"
    PAPER = "paper"


@dataclass(frozen=True, slots=True)
class Game:
    """Mean motion w (rad/s), inputs of Player 1 and Player 2, keep-out distance (m).

    The number of channels selects the motion: 2 the orbit plane, state (x, y, vx, vy); 3 space, state
    (x, y, z, vx, vy, vz); 1 the motion normal to the plane alone, state (z, vz). Raises ``InvalidInput``.
    """

    mean_motion: float
    control: InputSet
    disturbance: InputSet
    keep_out_m: float

    def __post_init__(self) -> None:
        number("mean_motion", self.mean_motion, 0.0, MAX_MEAN_MOTION)
        number("keep_out_m", self.keep_out_m, 0.0, MAX_KEEP_OUT, open_low=True)
        if self.disturbance.channels != self.control.channels:
            raise invalid(
                "disturbance",
                f"{self.control.channels} channels, as the control has",
                self.disturbance.channels,
            )

    @property
    def channels(self) -> int:
        """Number of channels m, and of positions; states have 2 m components."""
        return self.control.channels

    @property
    def realisable(self) -> InputSet | None:
        """Sums u + d that Player 1 can realise against every d; None when the disturbance is stronger."""
        return left_over(self.control, self.disturbance)

    @property
    def enforceable(self) -> InputSet:
        """Sums u + d to which Player 2 can hold every u."""
        return held_down(self.control, self.disturbance)

    @property
    def one_player(self) -> InputSet | None:
        """The sums to which the game reduces exactly; None if the two bounds differ."""
        return self.enforceable if self.realisable == self.enforceable else None

    @property
    def axes(self) -> tuple[int, ...]:
        """The LVLH axes (0, 1, 2) of the channels, in order."""
        return _AXES[self.channels]

    def to_lvlh(self, states: Floats) -> Floats:
        """States (..., 2 m) in LVLH, (..., 6); components outside the game are 0."""
        out = np.zeros((*states.shape[:-1], 6))
        out[..., self._rows] = states
        return out

    def from_lvlh(self, states: Floats) -> Floats:
        """LVLH states (..., 6) in the game's axes, (..., 2 m)."""
        # In C order, so that the memory layout does not affect the rounding of products.
        return np.ascontiguousarray(states[..., self._rows])

    def thrust_to_lvlh(self, inputs: Floats) -> Floats:
        """Inputs (..., m) in LVLH axes, (..., 3)."""
        out = np.zeros((*inputs.shape[:-1], 3))
        out[..., self.axes] = inputs
        return out

    def thrust_from_lvlh(self, thrust: Floats) -> Floats:
        """Thrust (..., 3) in LVLH axes by channel, (..., m)."""
        return np.ascontiguousarray(thrust[..., self.axes])

    @property
    def _rows(self) -> list[int]:
        return [*self.axes, *(axis + 3 for axis in self.axes)]

    def matrix(self) -> Floats:
        """A (2 m, 2 m) of eq. (5)."""
        return self._cut(system_matrix(self.mean_motion))

    def transition(self, tau: float) -> Floats:
        """Phi(tau) (2 m, 2 m), tau in seconds."""
        return self._cut(transition_matrix(self.mean_motion, tau))

    def held_input(self, tau: float) -> Floats:
        """Effect of one unit of a constant input on the state after ``tau`` seconds, (2 m, m)."""
        held: Floats = input_matrix(self.mean_motion, tau)[np.ix_(self._rows, self.axes)]
        return held

    def motion(
        self, players: Players | str = Players.AVOID, fuel_price: float = 0.0, together: bool = True
    ) -> Linear:
        """The game for the level-set solver.

        ``fuel_price`` (m per m/s) makes Player 1 pay for the size of u (sum of the channels' for a box).
        ``together`` merges the two into one input if the Hamiltonian stays the same (same shape, no price): the
        solver's dissipation then depends on the difference of the bounds and not on their sum.
        """
        players = Players(players)
        own: Aim = "max" if players is Players.AVOID else "min"
        other: Aim = "min" if players is Players.AVOID else "max"
        if together and fuel_price == 0.0 and self.one_player is not None:
            return Linear(self.matrix(), _inputs(self.one_player, own, 0.0))
        return Linear(
            self.matrix(),
            (*_inputs(self.control, own, fuel_price), *_inputs(self.disturbance, other, 0.0)),
        )

    def distance(self, positions: list[Floats]) -> Floats:
        """l = |p| - keep-out (m), the positions m arrays that broadcast."""
        squares = sum((p * p for p in positions), start=np.zeros(()))
        return np.asarray(np.sqrt(squares) - self.keep_out_m)

    def restricted(self, begin: int, end: int) -> Game:
        """The game of channels ``begin`` to ``end`` alone: of a game in space, (0, 2) the plane, (2, 3) normal to it.

        The two motions are decoupled, so each is a separate game. Player 1 keeps the section of its set and Player 2
        the projection, which are equal for these shapes.
        """
        if self.channels != 3 or (begin, end) not in ((0, 2), (2, 3)):
            raise invalid("channels", "(0, 2) or (2, 3) of a game in space", (begin, end))
        return Game(
            self.mean_motion,
            self.control.restricted(begin, end),
            self.disturbance.restricted(begin, end),
            self.keep_out_m,
        )

    def _cut(self, full: Floats) -> Floats:
        cut: Floats = full[np.ix_(self._rows, self._rows)]
        return cut


def _inputs(given: InputSet, aim: Aim, price: float) -> tuple[Input, ...]:
    """One input of the solver per ball; all channels of a box together."""
    m = given.channels
    gains = np.concatenate([np.zeros((m, m)), np.eye(m)])
    if given.shape == "box":
        half = np.array(given.bound)
        return (Input(gains, Box(-half, half), aim, price),)
    return tuple(
        Input(gains[:, p.begin : p.end], Ball(np.zeros(p.end - p.begin), p.radius), aim, price)
        for p in given.parts
    )
