"""Sets of LVLH states from which the chaser drifts, and the enclosure of a burn with errors.

Every set is a centre and blocks of columns, M_k b_k with |b_k|_2 <= 1, at the time of a burn. A burn with errors is
a piece of a spherical shell; its enclosure is a segment along the burn and a disc across it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from safestart.dynamics.burn import frame
from safestart.missed_burn.plan import Burn, Errors
from safestart.model.scenario import Floats

_BEND = 0.02
"""Pieces are so short that the box for the bend stays below this many metres."""
_MOST_PIECES = 64


@dataclass(frozen=True, slots=True)
class Thrust:
    """How long a burn with a duration lasts, ``first`` to ``last`` s, and the time, s after the planned one, from which
    on the chaser may drift from the set."""

    first: float = 0.0
    last: float = 0.0
    begin: float = 0.0


_IMPULSE = Thrust()


@dataclass(frozen=True, slots=True)
class Case:
    """One event: from ``time`` s on the chaser drifts from the set for ``duration`` s.

    ``kind``: start (no burn is made), made, cut, partial, late, stuck, misdirected. ``first``, ``last``: the piece, s.
    ``columns`` (C, 6) and ``ends`` (K,) of the blocks; ``labels`` (C) describe the columns: the name of an error and
    the number of its burn or axis. ``share`` of its burn is in the flight that the set lies near (model earth).
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
    thrust: Thrust = _IMPULSE
    share: float = 1.0


class StateSet:
    """A set under construction."""

    def __init__(self, centre: Floats) -> None:
        self.centre = np.array(centre, dtype=np.float64)
        self.columns: list[Floats] = []
        self.ends: list[int] = []
        self.labels: list[tuple[str, int]] = []

    def block(self, columns: list[Floats], label: str, number: int) -> None:
        """Add a block."""
        self.columns += columns
        self.ends.append(len(self.columns))
        self.labels += [(label, number)] * len(columns)

    def box(self, half: Floats, label: str) -> None:
        """Add a box of half-widths (6,), one segment for each axis."""
        for axis in np.flatnonzero(half > 0.0).tolist():
            self.block([half[axis] * np.eye(6)[axis]], label, axis)

    def navigation(self, errors: Errors) -> None:
        """Add the errors of the state: a box and an ellipsoid."""
        self.box(np.array([*errors.position, *errors.velocity]), "navigation")
        columns = [np.array(column) for column in errors.ellipsoid]
        if any(column.any() for column in columns):
            self.columns += columns
            self.ends.append(len(self.columns))
            self.labels += [("ellipsoid", j) for j in range(6)]

    def moved(self, matrix: Floats) -> None:
        """Replace the set by its image."""
        self.centre = matrix @ self.centre
        self.columns = [matrix @ column for column in self.columns]

    def copy(self) -> StateSet:
        """A set that grows on its own."""
        other = StateSet(self.centre)
        other.columns, other.ends, other.labels = list(self.columns), list(self.ends), list(self.labels)
        return other

    def case(
        self,
        kind: str,
        burn: int,
        time: float,
        duration: float,
        piece: tuple[float, float],
        thrust: Thrust = _IMPULSE,
        share: float | None = None,
    ) -> Case:
        """The set as a case."""
        if share is None:
            share = {"start": 0.0, "partial": 0.5}.get(kind, 1.0)
        columns = np.array(self.columns).reshape(-1, 6)
        ends = np.array(self.ends, dtype=np.int64)
        return Case(
            kind, burn, *piece, time, duration, self.centre, columns, ends, tuple(self.labels), thrust, share
        )


def pieces(length: float, bend: float) -> list[tuple[float, float]]:
    """[0, length] cut so that half the square of half a piece times ``bend`` (m/s^2) is small."""
    if length <= 0.0:
        return []
    count = min(max(math.ceil(length / math.sqrt(8.0 * _BEND / max(bend, 1e-12))), 1), _MOST_PIECES)
    # The last one ends at the length itself, which length * count / count may miss by its rounding.
    cuts = [*(length * k / count for k in range(count)), length]
    return list(pairwise(cuts))


def shell(least: float, greatest: float, angle: float) -> tuple[float, float, float]:
    """Enclosure of a piece of a shell: vectors of sizes [least, greatest] within ``angle`` of an axis.

    Middle and half-length along the axis, and the radius across it.
    """
    cosine = math.cos(angle)
    nearest = (least if cosine > 0.0 else greatest) * cosine
    across = greatest * math.sin(min(angle, 0.5 * math.pi))
    return 0.5 * (nearest + greatest), 0.5 * (greatest - nearest), across


def add_burn(
    state: StateSet,
    burn: Burn,
    k: int,
    least: float,
    greatest: float,
    angle: float,
    after: Floats | None = None,
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
