"""From mode 1 to mode 2: every state on one plane of the guard at the first entry, with the time of crossing.

The flow is expanded about one time t*: with z = z* + w the state there (z* of the centre), f = A z*, q = A^2 z* and
delta = t_c - t*,

    z(t_c) = z + delta f + e,   e = delta A w + delta^2/2 q + r,   |r| <= D^2/2 |A^2 w| + D^3/6 sup |A^3 z|,

where |delta| <= D. Now h.z(t_c) = b - sag gives delta = d - h.e/(h.f), with d affine in the symbols of the start and in
the sag; so z(t_c) is the projection of z + e along f onto the plane, shifted by the sag. With d instead of delta, e is
of second order in the symbols. This part is kept: each product of two symbols becomes a new symbol, on which the time
of crossing depends too. The rest, |delta - d| |A w| and the like, is of third order and becomes a box, together with
the deviation of the nonlinear motion from the linear one. (Mode 2 soon brings all starts to nearly the same speed; a
box of second order would not shrink with them.)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from safestart.model.scenario import Floats
from safestart.passive_safety.model import Motion, matrix
from safestart.passive_safety.reach.flow import flow_at
from safestart.passive_safety.reach.rounding import SLACK, UP

_ROUNDS = 4

REMAINDERS = 4
"""Number of generators of the box of remainders, the last ones of a crossing set."""


@dataclass(frozen=True, slots=True)
class Crossing:
    """Crossing set of one plane: ``centre`` (4,), ``gens`` (m, 4), the last four a box of remainders.

    Crossing time (min): ``time`` + ``time_gens`` (k,) . xi +- ``time_radius`` with xi those of the first k generators,
    and in [``first``, ``last``]; k is m - 4 if the remainders are so small that their symbols need not be kept.
    ``normal`` (2,) points out of the guard; ``name`` is the face.
    """

    name: str
    normal: Floats
    centre: Floats
    gens: Floats
    time: float
    time_gens: Floats
    time_radius: float
    first: float
    last: float


@dataclass(frozen=True, slots=True)
class Passage:
    """The flight around the crossing: between ``first`` and ``last`` (min), expanded at ``middle``.

    ``centre`` (4,) and ``gens`` (g, 4) of mode 1 at time 0; ``second`` and ``third`` (4,) bound |A^2 z| and |A^3 z| in
    between, ``strays`` (4,) bounds the deviation from the linear motion.
    """

    motion: Motion
    centre: Floats
    gens: Floats
    first: float
    middle: float
    last: float
    second: Floats
    third: Floats
    strays: Floats


@dataclass(frozen=True, slots=True)
class Quadratic:
    """A vector that is quadratic in symbols: ``constant`` (4,), ``linear`` (k, 4), ``products`` (k (k + 1)/2, 4).

    The products are new symbols in [-1, 1]: xi_i xi_j, and 2 xi_i^2 - 1.
    """

    constant: Floats
    linear: Floats
    products: Floats

    @property
    def whole(self) -> Floats:
        """Linear part and products, (k + k (k + 1)/2, 4)."""
        result: Floats = np.vstack([self.linear, self.products])
        return result


def second_order(offset: float, slopes: Floats, rates: Floats, jerk: Floats) -> Quadratic:
    """d A w + d^2/2 q, d = ``offset`` + ``slopes`` (k,) . xi, A w = xi . ``rates`` (k, 4), q = ``jerk`` (4,)."""
    i, j = np.triu_indices(len(slopes), 1)
    squares = slopes[:, None] * rates + 0.5 * slopes[:, None] ** 2 * jerk
    mixed = slopes[i, None] * rates[j] + slopes[j, None] * rates[i] + (slopes[i] * slopes[j])[:, None] * jerk
    return Quadratic(
        0.5 * offset**2 * jerk + 0.5 * squares.sum(axis=0),
        offset * (rates + slopes[:, None] * jerk),
        np.vstack([0.5 * squares, mixed]),
    )


def first_order(widest: float, passage: Passage, rates: Floats) -> Floats:
    """Bound (4,) on e, |delta| <= ``widest``."""
    result: Floats = widest * np.abs(rates).sum(axis=0) + 0.5 * widest**2 * passage.second
    return result


def remainder(widest: float, stray: float, passage: Passage, rates: Floats, jerk: Floats) -> Floats:
    """Bound (4,) on e without its second order: |delta| <= ``widest``, |delta - d| <= ``stray`` (min)."""
    a = matrix(passage.motion)
    result: Floats = (
        stray * (np.abs(rates).sum(axis=0) + (widest + 0.5 * stray) * np.abs(jerk))
        + 0.5 * widest**2 * np.abs(rates @ a.T).sum(axis=0)
        + widest**3 / 6.0 * passage.third
    )
    return result


def cross_plane(passage: Passage, name: str, normal: Floats, limit: float, sag: float = 0.0) -> Crossing:
    """Crossing set of the plane ``normal`` . (x, y) in ``limit`` +- ``sag`` (m)."""
    row, a = np.concatenate([normal, np.zeros(2)]), matrix(passage.motion)
    low, middle, high = passage.first, passage.middle, passage.last
    phi, _ = flow_at(passage.motion, middle)
    nominal, spread = phi @ passage.centre, passage.gens @ phi.T
    flow = a @ nominal
    jerk = a @ flow
    fall = float(row @ flow)
    offset = (limit - float(row @ nominal)) / fall
    slopes, known = (
        -(spread @ row) / fall,
        np.abs(phi) @ (np.abs(passage.centre) + np.abs(passage.gens).sum(axis=0)),
    )
    if sag > 0.0:
        slopes, spread = np.append(slopes, sag / fall), np.vstack([spread, np.zeros(4)])
    rates = spread @ a.T
    widest = max(high - middle, middle - low)
    pace = np.abs(a) @ known
    # Round-off of the states, and of the times that are quotients of them.
    late = SLACK * (1.0 + abs(middle) + widest + (float(np.abs(row) @ known) + abs(limit) + sag) / abs(fall))
    rounded = SLACK * (known + (1.0 + widest) * (pace + widest * np.abs(a) @ pace))
    rounded += late * (pace + widest * np.abs(a) @ pace)
    # A bound of first order on e, and the delay of the crossing that it allows.
    for _ in range(_ROUNDS):
        error = UP * (first_order(widest, passage, rates) + passage.strays) + rounded
        stray = UP * float(np.abs(row) @ error) / abs(fall) + late
        widest = min(widest, UP * (abs(offset) + float(np.abs(slopes).sum()) + stray))
    # Any affine time is allowed; the middle of the second order leaves the smallest remainder.
    lead = offset - float(row @ second_order(offset, slopes, rates, jerk).constant) / fall
    bent = second_order(lead, slopes, rates, jerk)
    least = abs(offset - lead - float(row @ bent.constant) / fall) + float(
        np.abs(bent.whole @ row).sum()
    ) / abs(fall)
    closer, finer = stray + abs(offset - lead), error
    for _ in range(_ROUNDS):
        finer = UP * (remainder(widest, closer, passage, rates, jerk) + passage.strays) + rounded
        closer = min(closer, UP * (least + float(np.abs(row) @ finer) / abs(fall)) + late)
    # Sets so wide that the second order does not help get only the box of first order, large enough to keep its
    # symbols.
    spare = np.zeros(REMAINDERS)
    curve = Quadratic(np.zeros(4), np.zeros((len(slopes), 4)), np.zeros((0, 4)))
    if closer < stray:
        curve, error, spare = bent, finer, np.zeros(0)
    project = np.eye(4) - np.outer(flow, row) / fall
    # Additional round-off for the projection, whose entries are at most |f| |h| / |h f|.
    stretch = np.abs(np.eye(4)) + np.outer(np.abs(flow), np.abs(row)) / abs(fall)
    box = UP * (np.abs(project) @ error) + SLACK * (stretch @ (known + pace + abs(limit) + sag))
    # A symbol moves the state by w and, through the time, along f; apart from the sag the sum lies in the plane.
    symbols = spread + slopes[:, None] * flow
    count = len(slopes)
    bends, shifts = curve.whole @ project.T, curve.whole @ row / fall
    return Crossing(
        name,
        normal,
        nominal + flow * offset + project @ curve.constant,
        np.vstack([symbols + bends[:count], bends[count:], np.diag(box)]),
        middle + offset - float(row @ curve.constant) / fall,
        np.concatenate([slopes - shifts[:count], -shifts[count:], spare]),
        UP * float(np.abs(row) @ error) / abs(fall) + late,
        low,
        high,
    )
