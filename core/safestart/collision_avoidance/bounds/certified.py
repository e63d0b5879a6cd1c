"""Certified bounds of the avoid game's value, without a grid: proved unsafe, proved safe, and how far apart they are.

Upper bound: let W be a set to which Player 2 can hold the sum u + d, q(t) the drift position and R_W(t) the
displacements from W. A start is lost if at one time t <= T all of q(t) + R_W(t) lies within the keep-out distance;
:func:`upper` is the least such distance, V <= upper. Lower bound: let W be the sums that Player 1 can realise. Any w(.)
in W whose path keeps away at all times is a witness; :func:`lower` is the distance of the best one found, V >= lower.
Derivations in docs/theory/collision-avoidance.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from safestart.collision_avoidance.bounds.admissible import INSIDE, inner_radii, realisable, square_limits
from safestart.collision_avoidance.bounds.closing_kernel import closest_certain
from safestart.collision_avoidance.bounds.directions import covering, guesses
from safestart.collision_avoidance.bounds.witness_kernel import farthest
from safestart.collision_avoidance.game import Game
from safestart.constraints.thrust import InputSet
from safestart.errors import invalid
from safestart.model.scenario import Bools, Floats, number

MAX_HORIZON_S = 7200.0
EFFORT = 40
"""Steps of ascent from each of the best three guesses."""
_SLACK = 1e-9
"""Rounding allowance relative to the size of a state: a path of some hundred steps needs less than a hundredth of
it."""


@dataclass(frozen=True, slots=True)
class _Closing:
    drift: Floats
    supports: Floats


@lru_cache(maxsize=16)
def _closing(game: Game, horizon: float) -> _Closing:
    """Drift rows and support functions at 4 times a second (64 to 1024 times), the integral bounded from above."""
    times = min(max(math.ceil(4.0 * horizon), 64), 1024)
    fine = 4 * times
    grid = np.linspace(0.0, horizon, fine + 1)
    transitions = np.array([game.transition(tau) for tau in grid])
    m = game.channels
    directions, _ = covering(m)
    # Support of the displacement's rate: sigma_W(M(tau)^T s), M the effect of an impulse on the position.
    rates = np.empty((fine + 1, len(directions)))
    for j, found in enumerate(transitions):
        rates[j] = game.enforceable.support(directions @ found[:m, m:])
    h = horizon / fine
    sums = np.concatenate(
        [np.zeros((1, rates.shape[1])), np.cumsum(0.5 * h * (rates[1:] + rates[:-1]), axis=0)]
    )
    # A norm is convex: the trapezoid's error on the low side is at most the curve's distance from its chord, and |M''|
    # <= 6 w.
    bend = 0.125 * h * h * 6.0 * game.mean_motion * game.enforceable.radius
    supports = (sums + (grid * bend)[:, None])[:: fine // times]
    drift = np.zeros((times + 1, 1 + m, 2 * m))
    drift[:, 0, 0] = grid[:: fine // times]
    drift[:, 1:] = transitions[:: fine // times, :m]
    return _Closing(drift, np.ascontiguousarray(supports))


def upper(game: Game, states: Floats, times_to_go: Floats | float) -> Floats:
    """Upper bound on V (m) of states (..., 2 m), for one or several ascending times to go (s): (...) or (times, ...).

    Raises ``InvalidInput`` for states that are not finite or of the wrong length.
    """
    flat, lead = _check(game, states)
    kept = np.atleast_1d(np.asarray(times_to_go, dtype=np.float64))
    if kept.ndim != 1 or not np.isfinite(kept).all() or (np.diff(kept) <= 0.0).any() or kept[0] < 0.0:
        raise invalid("times_to_go", "ascending numbers of seconds, not negative", times_to_go)
    horizon = number("times_to_go", float(kept[-1]), 0.0, MAX_HORIZON_S)
    out = np.empty((len(kept), len(flat)))
    if horizon == 0.0:
        out[0] = np.linalg.norm(flat[:, : game.channels], axis=1)
    else:
        tables = _closing(game, horizon)
        directions, widen = covering(game.channels)
        slack = _SLACK * np.abs(flat).max(axis=1, initial=0.0)
        bound = _closest_on_a_line if game.channels == 1 else closest_certain
        bound(flat, tables.drift, tables.supports, directions, widen, slack, kept * (1.0 + 1e-12), out)
    out -= game.keep_out_m
    return out.reshape(lead) if np.ndim(times_to_go) == 0 else out.reshape(len(kept), *lead)


def _closest_on_a_line(
    states: Floats, drift: Floats, supports: Floats, directions: Floats, widen: float, slack: Floats,
    kept: Floats, out: Floats,
) -> None:  # fmt: skip
    """:func:`closest_certain` for one position, where no path changes sides without passing zero."""
    del directions, widen
    side = np.where(states[:, 0] < 0.0, -1.0, 1.0)
    reach = side * (drift[:, 1] @ states.T) + supports[:, :1] + slack
    reach[0] = np.abs(states[:, 0])
    least = np.maximum(np.minimum.accumulate(reach), 0.0)
    out[:] = least[np.searchsorted(drift[:, 0, 0], kept, side="right") - 1]


@dataclass(frozen=True, slots=True)
class Witness:
    """Sums w = u + d, ``inputs`` (..., J, m), each held for ``step_s`` seconds, and the ``margin_m`` (...) they keep.

    Player 1 flies u = w - d. The margin holds at all times to go, not only at the samples; it may be negative.
    """

    step_s: float
    inputs: Floats
    margin_m: Floats


def lower(
    game: Game, states: Floats, horizon_s: float, *, goal_m: Floats | float = math.inf, effort: int = EFFORT
) -> Floats:
    """Lower bound on V (m) of states (..., 2 m) over a horizon; -inf where Player 1 can realise nothing.

    The search for a state ends when it keeps ``goal_m`` (a number or (...)); ``effort`` 0 tries only constant inputs.
    """
    return _search(game, states, horizon_s, goal_m, effort, keep=False).margin_m


def witness(game: Game, states: Floats, horizon_s: float, *, effort: int = EFFORT) -> Witness:
    """The controls behind :func:`lower`, which can be flown; raises ``InvalidInput`` when Player 1 has none."""
    if game.realisable is None:
        raise invalid("disturbance", "no stronger than the control", game.disturbance.bound)
    return _search(game, states, horizon_s, math.inf, effort, keep=True)


def unavoidable(game: Game, states: Floats, horizon_s: float) -> Bools:
    """Whether loss of separation within the horizon is proved for every u, (...)."""
    return np.asarray(upper(game, states, horizon_s) <= 0.0)


def _search(
    game: Game, states: Floats, horizon: float, goal: Floats | float, effort: int, *, keep: bool
) -> Witness:
    flat, lead = _check(game, states)
    horizon = number("horizon_s", horizon, 0.0, MAX_HORIZON_S, open_low=True)
    m, radii = game.channels, inner_radii(game)
    pieces = min(max(math.ceil(horizon / 0.75), 40), 1024)
    h = horizon / pieces
    out = np.full(len(flat), -np.inf)
    best = np.zeros((len(flat) if keep else 0, pieces, m))
    if radii is not None:
        w = game.control.with_bound(tuple(INSIDE * radius for radius in radii))
        goals = np.broadcast_to(np.asarray(goal, dtype=np.float64), lead).ravel() + game.keep_out_m
        farthest(
            flat,
            game.transition(h),
            game.held_input(h),
            _sag(game, w, h),
            w.extreme(guesses(m)),
            np.array([[part.begin, part.end] for part in w.parts]),
            np.array([part.radius for part in w.parts]),
            square_limits(radii),
            pieces,
            np.ascontiguousarray(goals),
            effort,
            max(0.1 * w.radius * horizon**2, 1e-3),
            out,
            best,
        )
    out -= game.keep_out_m + _SLACK * np.abs(flat).max(axis=1, initial=0.0)
    if keep:
        # Claim nothing for inputs that Player 1 does not have.
        out[~realisable(game, best)] = -np.inf
    return Witness(h, best.reshape(*lead, pieces, m) if keep else best, out.reshape(lead))


def _sag(game: Game, inputs: InputSet, h: float) -> Floats:
    """A path's deviation from its chord: h^2 / 8 of its acceleration, per speed, per distance, and constant.

    |p''| <= a with a = 2 w (|v| + h a) + 3 w^2 (|p| + h |v| + h^2 a) + |w|, speed and distance at the piece's start.
    """
    w = game.mean_motion
    share = 0.125 * h * h / (1.0 - 2.0 * w * h - 3.0 * w * w * h * h)
    return share * np.array([2.0 * w + 3.0 * w * w * h, 3.0 * w * w, inputs.radius])


def _check(game: Game, states: Floats) -> tuple[Floats, tuple[int, ...]]:
    states = np.asarray(states, dtype=np.float64)
    if states.ndim == 0 or states.shape[-1] != 2 * game.channels:
        raise invalid("states", f"last axis of length {2 * game.channels}", states.shape)
    if not np.isfinite(states).all():
        raise invalid("states", "finite numbers", "NaN or infinity")
    return np.ascontiguousarray(states.reshape(-1, 2 * game.channels)), states.shape[:-1]
