"""The avoid game's value on a grid at several times to go, joined with the certified bounds, readable at any state."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import IntEnum
from functools import partial

import numpy as np

from safestart.collision_avoidance.bounds.certified import MAX_HORIZON_S, lower, upper
from safestart.collision_avoidance.game import Game, Players
from safestart.collision_avoidance.joining import Check, join, reading_errors
from safestart.collision_avoidance.tube_settings import SCHEMES, TubeSettings, make_lattice
from safestart.errors import invalid
from safestart.levelset import Kind, Lattice, Linear, Options, ValueField, solve
from safestart.levelset.warm import warm
from safestart.model.scenario import Bools, Floats, number
from safestart.runtime.progress import Context


class Answer(IntEnum):
    """The answer for a state: proved, judged by the grid beyond its measured error, or undecided."""

    PROVED_UNSAFE = -2
    UNSAFE = -1
    UNDECIDED = 0
    SAFE = 1
    PROVED_SAFE = 2


@dataclass(frozen=True)
class Tube:
    """Values (m) on ``lattice`` at ``times`` to go (s, ascending from 0): ``raw`` the grid's own, ``values`` joined.

    {V <= 0} is unsafe. Arrays are (kept, nodes...), states (..., 2 m) in the game's order. ``check`` counts the grid's
    errors (None without a comparison). If the computation cannot be trusted, ``failure`` gives the reason and all
    values are -inf, so that nothing counts as safe.
    """

    game: Game
    settings: TubeSettings
    lattice: Lattice
    motion: Linear
    times: Floats
    raw: Floats
    values: Floats
    check: Check | None
    warnings: list[str] = field(default_factory=list)
    failure: str = ""
    steps: int = 0
    run_s: float = 0.0

    @property
    def horizon_s(self) -> float:
        """Longest time to go."""
        return float(self.times[-1])

    @property
    def grid_error_m(self) -> float:
        """Largest distance of :meth:`value` from the certified bounds near the boundary or across it, at the horizon.

        Measured at the middles of all cells (on the nodes it is zero). Infinite without a comparison.
        """
        return math.inf if self.check is None else max(self.check.read_high_m, self.check.read_low_m)

    def covers(self, states: Floats) -> Bools:
        """Whether states lie in the lattice's box, (...)."""
        states = np.asarray(states, dtype=np.float64)
        low, high = np.array(self.lattice.low), np.array(self.lattice.high)
        return np.asarray(((states >= low) & (states <= high)).all(axis=-1))

    def value(self, states: Floats, time_to_go: float | None = None) -> Floats:
        """Joined value (...) at states (..., 2 m), multilinear in state and time; the horizon's by default.

        Raises ``InvalidInput`` for states outside the lattice and for times beyond the horizon.
        """
        return self.read(states, time_to_go)[0]

    def gradient(self, states: Floats, time_to_go: float | None = None) -> Floats:
        """Gradient (..., 2 m) of the joined value by the state; raises as :meth:`value`."""
        return self.read(states, time_to_go)[1]

    def answer(self, states: Floats, time_to_go: float | None = None) -> Floats:
        """:class:`Answer` (...) of states (..., 2 m): first by the bounds at the state itself, then by the grid.

        If neither bound decides, the value must exceed the grid's measured error to count. The paper's variant has no
        proofs.
        """
        states = np.asarray(states, dtype=np.float64)
        time = self.horizon_s if time_to_go is None else time_to_go
        value, error = self.value(states, time), self.grid_error_m
        found = np.where(
            value > error, Answer.SAFE, np.where(value < -error, Answer.UNSAFE, Answer.UNDECIDED)
        )
        if self.settings.players is Players.AVOID:
            unsafe = upper(self.game, states, time) <= 0.0
            safe = lower(self.game, states, max(time, 1e-9), goal_m=1e-6) > 0.0
            found = np.where(unsafe, Answer.PROVED_UNSAFE, np.where(safe, Answer.PROVED_SAFE, found))
        return np.asarray(found, dtype=np.int8)

    def slice(self, velocity: tuple[float, ...]) -> tuple[list[Floats], Floats]:
        """Position axes and joined values over them at one velocity (m/s), at the horizon, for pictures."""
        m = self.game.channels
        if len(velocity) != m:
            raise invalid("velocity", f"{m} components", velocity)
        axes = self.lattice.axes[:m]
        mesh = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
        states = np.concatenate([mesh, np.broadcast_to(np.asarray(velocity, float), mesh.shape)], axis=-1)
        return axes, self.value(states)

    def read(self, states: Floats, time_to_go: float | None) -> tuple[Floats, Floats]:
        """Interpolate value and gradient at once; raises as :meth:`value`."""
        time = self.horizon_s if time_to_go is None else time_to_go
        if not 0.0 <= time <= self.horizon_s:
            raise invalid("time_to_go", f"0 to {self.horizon_s:g} s", time)
        later = min(max(int(np.searchsorted(self.times, time)), 1), len(self.times) - 1)
        share = (time - self.times[later - 1]) / (self.times[later] - self.times[later - 1])
        value, gradient = ValueField(self.lattice, self.values[later]).read(states)
        if share < 1.0:
            before = ValueField(self.lattice, self.values[later - 1]).read(states)
            value = share * value + (1.0 - share) * before[0]
            gradient = share * gradient + (1.0 - share) * before[1]
        return value, gradient


def solve_tube(
    game: Game, horizon_s: float, settings: TubeSettings | None = None, context: Context | None = None
) -> Tube:
    """Solve the game back from the horizon, piece by piece, and join the values with the certified bounds.

    With a price of fuel the value is sup over u, inf over d of the least l - price * (fuel until then), which is at
    most V. Raises ``InvalidInput`` for bad input and ``Cancelled`` when dismissed.
    """
    settings, context = settings or TubeSettings(), context or Context()
    horizon = number("horizon_s", horizon_s, 0.0, MAX_HORIZON_S, open_low=True)
    lattice, warnings = make_lattice(game, horizon, settings)
    motion = game.motion(settings.players, settings.fuel_price, settings.together)
    warm(settings.precision)
    options = Options(SCHEMES[settings.accuracy], precision=settings.precision, threads=settings.threads)
    times = np.linspace(0.0, horizon, settings.kept)
    target = np.broadcast_to(game.distance(lattice.coordinates()[: game.channels]), lattice.shape)
    raw = np.empty((settings.kept, *lattice.shape))
    raw[0] = target
    steps, run_s, failure = 0, 0.0, ""
    marching = context.part(0.0, 0.6 if settings.join else 1.0, 1.0, "value")
    for k in range(1, settings.kept):
        piece = solve(
            lattice,
            motion,
            raw[k - 1],
            float(times[k] - times[k - 1]),
            # With a price, stopping is free and waiting is not, so the least over stopping times is a cap, not min(0,
            # H).
            kind=Kind.FIXED if settings.fuel_price > 0.0 else Kind.TUBE,
            cap=target if settings.fuel_price > 0.0 else None,
            options=options,
            context=marching.part(k - 1, 1.0, settings.kept - 1, "piece"),
        )
        steps, run_s = steps + piece.steps, run_s + piece.run_s
        if piece.field is None:
            failure = piece.failure
            break
        raw[k] = piece.field.values
    made = partial(Tube, game, settings, lattice, motion, times)
    if failure:
        raw[:] = -math.inf
        return made(raw, raw, None, warnings, failure, steps, run_s)
    if not settings.join:
        return made(raw, raw, None, warnings, "", steps, run_s)
    bounds = context.part(0.6, 0.2, 1.0, "bounds")
    joined, check = join(game, lattice, raw, times, bounds, only_upper=settings.fuel_price > 0.0)
    values = joined if settings.players is Players.AVOID else raw
    bounds = context.part(0.8, 0.2, 1.0, "bounds")
    check.read_high_m, check.read_low_m = reading_errors(game, lattice, values[-1], horizon, bounds)
    return made(raw, values, check, warnings, "", steps, run_s)
