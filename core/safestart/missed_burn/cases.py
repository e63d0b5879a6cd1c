"""All possible failures of a plan, as sets of LVLH states from which the chaser drifts.

Every set is a centre and blocks of columns, M_k b_k with |b_k|_2 <= 1, at the time of a burn. A burn with errors is
a piece of a spherical shell; its enclosure is a segment along the burn and a disc across it. The interval [0, tau] of a
late or stuck burn is cut into short pieces. On each piece the curve of equivalent states at the time of the burn is
replaced by its tangent in the middle plus a box for its bend (Taylor's remainder).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from safestart.dynamics.cwh import input_matrix, transition_matrix
from safestart.missed_burn.plan import Burn, Question
from safestart.model.scenario import Floats

_BEND = 0.02
"""Pieces are so short that the box for the bend stays below this many metres."""
_MOST_PIECES = 64


@dataclass(frozen=True, slots=True)
class Case:
    """One event: from ``time`` s on the chaser drifts from the set for ``duration`` s.

    ``kind``: start (no burn is made), made, partial, late, stuck, misdirected. ``first``, ``last``: the piece, s.
    ``columns`` (C, 6) and ``ends`` (K,) of the blocks; ``labels`` (C) describe the columns: the name of an error and
    the number of its burn or axis.
    """

    kind: str
    burn: int
    first: float
    last: float
    time: float
    duration: float
    centre: Floats
    columns: Floats
    ends: NDArray[np.int64]
    labels: tuple[tuple[str, int], ...]


class _Set:
    """A set under construction."""

    def __init__(self, centre: Floats) -> None:
        self.centre = np.array(centre, dtype=np.float64)
        self.columns: list[Floats] = []
        self.ends: list[int] = []
        self.labels: list[tuple[str, int]] = []

    def block(self, columns: list[Floats], label: str, number: int) -> None:
        self.columns += columns
        self.ends.append(len(self.columns))
        self.labels += [(label, number)] * len(columns)

    def box(self, half: Floats, label: str) -> None:
        for axis in np.flatnonzero(half > 0.0).tolist():
            self.block([half[axis] * np.eye(6)[axis]], label, axis)

    def moved(self, matrix: Floats) -> None:
        self.centre = matrix @ self.centre
        self.columns = [matrix @ column for column in self.columns]

    def copy(self) -> _Set:
        other = _Set(self.centre)
        other.columns, other.ends, other.labels = list(self.columns), list(self.ends), list(self.labels)
        return other

    def case(self, kind: str, burn: int, time: float, duration: float, piece: tuple[float, float]) -> Case:
        columns = np.array(self.columns).reshape(-1, 6)
        ends = np.array(self.ends, dtype=np.int64)
        return Case(
            kind, burn, piece[0], piece[1], time, duration, self.centre, columns, ends, tuple(self.labels)
        )


def cases_of(question: Question) -> list[Case]:
    """Every case of a plan, in the order of its burns."""
    plan, errors, failures = question.plan, question.errors, question.failures
    n, times = plan.mean_motion, [burn.time for burn in plan.burns]
    planned, box = plan.before(), np.array([*errors.position, *errors.velocity])
    out: list[Case] = []
    state = _Set(planned[0])
    state.box(box, "navigation")
    still, share, angle = (0.0, 0.0), errors.thrust_share, errors.thrust_angle
    out.append(state.case("start", -1, times[0], max(question.horizon, failures.late), still))
    for k, burn in enumerate(plan.burns):
        if k:
            state.moved(transition_matrix(n, times[k] - times[k - 1]))
        if errors.at_each_burn:
            state = _Set(planned[k])
            state.box(box, "navigation")
        before = state.copy()
        _burn(state, burn, k, 1.0 - share, 1.0 + share, angle)
        gap = times[k + 1] - times[k] if k + 1 < len(times) else -failures.late
        # The drift lasts until the next burn, which may be late.
        out.append(state.case("made", k, times[k], max(question.horizon, gap + failures.late), still))
        if failures.partial:
            part = before.copy()
            _burn(part, burn, k, 0.0, 1.0 + share, angle)
            out.append(part.case("partial", k, times[k], question.horizon, still))
        if failures.misdirected > 0.0:
            turned = before.copy()
            _burn(turned, burn, k, 1.0 - share, 1.0 + share, min(angle + failures.misdirected, math.pi))
            out.append(turned.case("misdirected", k, times[k], question.horizon, still))
        for first, last in pieces(failures.late, 2.0 * n * burn.size):
            late = before.copy()
            _late(late, burn, k, n, (first, last), errors.thrust_share, errors.thrust_angle)
            out.append(late.case("late", k, times[k], question.horizon, (first, last)))
        for first, last in pieces(failures.stuck, failures.acceleration):
            stuck = state.copy()
            _stuck(stuck, burn, k, n, (first, last), question)
            out.append(stuck.case("stuck", k, times[k], question.horizon, (first, last)))
    return out


def pieces(length: float, bend: float) -> list[tuple[float, float]]:
    """[0, length] cut so that half the square of half a piece times ``bend`` (m/s^2) is small."""
    if length <= 0.0:
        return []
    count = min(max(math.ceil(length / math.sqrt(8.0 * _BEND / max(bend, 1e-12))), 1), _MOST_PIECES)
    cuts = [length * k / count for k in range(count + 1)]
    return list(pairwise(cuts))


def shell(least: float, greatest: float, angle: float) -> tuple[float, float, float]:
    """Enclosure of a piece of a shell: vectors of sizes [least, greatest] within ``angle`` of an axis.

    Middle and half-length along the axis, and the radius across it.
    """
    cosine = math.cos(angle)
    nearest = (least if cosine > 0.0 else greatest) * cosine
    across = greatest * math.sin(min(angle, 0.5 * math.pi))
    return 0.5 * (nearest + greatest), 0.5 * (greatest - nearest), across


def frame(vector: Floats) -> tuple[Floats, Floats, Floats]:
    """Unit vectors: along a vector, and two across it."""
    along = vector / np.linalg.norm(vector)
    other = np.eye(3)[int(np.argmin(np.abs(along)))]
    one = np.cross(along, other)
    one /= np.linalg.norm(one)
    return along, one, np.cross(along, one)


def _burn(
    state: _Set, burn: Burn, k: int, least: float, greatest: float, angle: float, after: Floats | None = None
) -> None:
    """Adds a burn with errors, moved by ``after`` (6, 6)."""
    lift = np.eye(6)[:, 3:] if after is None else after[:, 3:]
    middle, half, across = shell(least, greatest, angle)
    along, one, two = frame(np.array(burn.impulse))
    state.centre = state.centre + lift @ (middle * burn.size * along)
    if half > 0.0:
        state.block([lift @ (half * burn.size * along)], "along", k)
    if across > 0.0:
        state.block([lift @ (across * burn.size * one), lift @ (across * burn.size * two)], "across", k)


def drifted(size: float, seconds: float, n: float, longest: float) -> Floats:
    """Half-widths (6,) of the change of the equivalent state by a velocity of ``size`` m/s within ``seconds``.

    For phases up to p = n ``longest`` <= 0.5: |d/dt Phi(-t) (0, v)| is at most (1 + 2 p) |v| in each position and
    (2 + 4 p) n |v| in each velocity.
    """
    p = n * longest
    return size * seconds * np.repeat([1.0 + 2.0 * p, n * (2.0 + 4.0 * p)], 3)


def _late(
    state: _Set, burn: Burn, k: int, n: float, piece: tuple[float, float], share: float, angle: float
) -> None:
    """The burn comes ``piece`` s late: Phi(-t) (0, v) at the time that was planned, tangent and bend."""
    middle, half = 0.5 * (piece[0] + piece[1]), 0.5 * (piece[1] - piece[0])
    back = transition_matrix(n, -middle)
    _burn(state, burn, k, 1.0 - share, 1.0 + share, angle, back)
    v = np.array(burn.impulse) * shell(1.0 - share, 1.0 + share, angle)[0]
    first, second, third = _derivatives(n, v)
    state.block([half * (back @ first)], "piece", k)
    # The second derivative has no secular part: P cos n t + Q sin n t.
    bend = np.hypot(second, third / n) * 0.5 * half * half
    loose = burn.size * float(np.hypot(*shell(1.0 - share, 1.0 + share, angle)[1:]))
    state.box(bend + drifted(loose, half, n, piece[1]), "bend")


def _derivatives(n: float, v: Floats) -> tuple[Floats, Floats, Floats]:
    """First to third derivative of Phi(-t) (0, v) at t = 0: (-A)^m (0, v)."""
    a = -np.array(
        [
            [0, 0, 0, 1, 0, 0],
            [0, 0, 0, 0, 1, 0],
            [0, 0, 0, 0, 0, 1],
            [3 * n * n, 0, 0, 0, 2 * n, 0],
            [0, 0, 0, -2 * n, 0, 0],
            [0, 0, -n * n, 0, 0, 0],
        ]
    )
    first = a @ np.concatenate([np.zeros(3), v])
    second = a @ first
    return first, second, a @ second


def _stuck(state: _Set, burn: Burn, k: int, n: float, piece: tuple[float, float], question: Question) -> None:
    """After the burn the thrust goes on for ``piece`` s: int_0^s Phi(-t) (0, a) dt, tangent, bend, errors of thrust."""
    acceleration, errors = question.failures.acceleration, question.errors
    share, angle = errors.thrust_share, errors.thrust_angle
    middle, half = 0.5 * (piece[0] + piece[1]), 0.5 * (piece[1] - piece[0])
    along, _, _ = frame(np.array(burn.impulse))
    centre, within, across = shell(1.0 - share, 1.0 + share, angle)
    push = centre * acceleration * along
    state.centre = state.centre - input_matrix(n, -middle) @ push
    state.block([half * (transition_matrix(n, -middle)[:, 3:] @ push)], "piece", k)
    state.box(drifted(centre * acceleration, 0.5 * half * half, n, piece[1]), "bend")
    # The continuing thrust has the burn's errors; here they are taken as independent.
    loose = acceleration * float(np.hypot(within, across))
    state.box(
        np.concatenate([np.zeros(3), np.full(3, loose * piece[1])])
        + drifted(loose, piece[1] ** 2, n, piece[1]),
        "loose",
    )
