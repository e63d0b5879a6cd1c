"""Proof atlas of one operating point: every start at rest answered in microseconds, with its proof.

The starts that can stay form a convex set: convex combinations of witnesses are witnesses, and every dual bounds the
margin of every start. So a few dozen cone programs give an inner polygon of proved GO and ceilings that prove NO_GO;
starts between are UNDECIDED and cover at most ``relative_gap`` of the outer area.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from safestart.atlas.extent import Ceiling, Witness
from safestart.errors import invalid
from safestart.exact.answer import GUARD, Answer, Multiplier, Verdict
from safestart.exact.question import Question
from safestart.model.scenario import Floats

Ints = np.ndarray[tuple[Any, ...], np.dtype[np.signedinteger[Any]]]


@dataclass(frozen=True, slots=True)
class Atlas:
    """Proved answers for starts at rest in LVLH with y at most ``y_max`` metres.

    ``deepest`` is the start with the largest margin; ``rim`` the witnesses of the inner polygon, counter-clockwise as
    seen from ``centre``, a witness well inside it; ``corners`` (R, 2), ``margins`` (R,) and ``angles`` (R,) hold their
    starts as seen from there, their margins and directions. ``slopes`` (C, 2) and ``levels`` (C,) are the ceilings in
    metres. ``message`` is empty unless the construction stopped early; the proofs hold all the same.
    """

    question: Question
    y_max: float
    deepest: Witness
    centre: Witness
    rim: tuple[Witness, ...]
    corners: Floats
    margins: Floats
    angles: Floats
    ceilings: tuple[Ceiling, ...]
    slopes: Floats
    levels: Floats
    inner_area: float
    outer_area: float
    names: tuple[str, ...]
    message: str

    @property
    def relative_gap(self) -> float:
        """(outer - inner) / outer area; 0 for an empty set."""
        return (self.outer_area - self.inner_area) / self.outer_area if self.outer_area > 0.0 else 0.0

    def bounds(self, points: Floats) -> tuple[Floats, Floats]:
        """Proved lower and upper bound (m) on the margin of starts (..., 2); -inf or +inf when unknown."""
        points = np.asarray(points, dtype=np.float64)
        if points.ndim == 0 or points.shape[-1] != 2 or not np.isfinite(points).all():
            raise invalid("points", "finite, last axis of length 2 (metres)", points.shape)
        flat = points.reshape(-1, 2)
        x, y = np.ascontiguousarray(flat[:, 0]), np.ascontiguousarray(flat[:, 1])
        upper = np.full(len(flat), np.inf)
        for (across, along), level in zip(self.slopes.tolist(), self.levels.tolist(), strict=True):
            ceiling = across * x
            ceiling += along * y
            ceiling += level
            np.minimum(upper, ceiling, out=upper)
        lower = np.full(len(flat), -np.inf)
        if len(self.rim) >= 3:
            sector, weights = self._fan(flat)
            inside = (weights >= 0.0).all(axis=1)
            after = (sector + 1) % len(self.rim)
            mixed = (
                weights[:, 0] * self.centre.margin
                + weights[:, 1] * self.margins[sector]
                + weights[:, 2] * self.margins[after]
            )
            lower = np.where(inside, mixed, lower)
        upper[y > self.y_max] = np.inf
        return lower.reshape(points.shape[:-1]), upper.reshape(points.shape[:-1])

    def answer(self, point: Floats) -> Answer:
        """The proved answer for one start (2,), with its thrust or multipliers; UNDECIDED between the polygons."""
        point = np.asarray(point, dtype=np.float64)
        if point.shape != (2,):
            raise invalid("point", "shape (2,): x, y in metres", point.shape)
        if not np.isfinite(point).all():
            raise invalid("point", "finite coordinates in metres", "NaN or infinity")
        x, y = point.tolist()
        within = y <= self.y_max
        least = int(np.argmin(self.slopes @ point + self.levels)) if within and len(self.levels) else -1
        high = math.inf if least < 0 else float(self.slopes[least] @ point + self.levels[least])
        if high < -GUARD:
            best = self.ceilings[least]
            proof = tuple(
                Multiplier(time, self.names[face], value)
                for time, face, value in zip(
                    best.times.tolist(), best.faces.tolist(), best.weights.tolist(), strict=True
                )
            )
            return Answer(Verdict.NO_GO, high, -math.inf, high, None, proof, 0)
        low, thrust = self._mix(x, y)
        if low > GUARD:
            return Answer(Verdict.GO, low, low, high, thrust, (), 0)
        where = "beyond the atlas" if point[1] > self.y_max else "between the proved polygons"
        return Answer(Verdict.UNDECIDED, math.nan, low, high, None, (), 0, where)

    def _fan(self, flat: Floats) -> tuple[Ints, Floats]:
        """Sector (P,) of the fan around the centre, and weights (P, 3) of the centre and its two rim points."""
        rim = self.corners
        ahead = flat - self.centre.start
        turn = np.arctan2(ahead[:, 1], ahead[:, 0])
        sector = (np.searchsorted(self.angles, turn, side="right") - 1) % len(rim)
        a, b = rim[sector], rim[(sector + 1) % len(rim)]
        cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            first = (ahead[:, 0] * b[:, 1] - ahead[:, 1] * b[:, 0]) / cross
            second = (a[:, 0] * ahead[:, 1] - a[:, 1] * ahead[:, 0]) / cross
        weights = np.stack([1.0 - first - second, first, second], axis=1)
        return sector, np.where(np.isfinite(weights), weights, -1.0)

    def _mix(self, x: float, y: float) -> tuple[float, Floats | None]:
        """Margin and thrust of the mix of witnesses at one start, (-inf, None) outside; :meth:`_fan` singly."""
        count = len(self.rim)
        if count < 3:
            return -math.inf, None
        origin = self.centre.start
        dx, dy = x - float(origin[0]), y - float(origin[1])
        k = (int(np.searchsorted(self.angles, math.atan2(dy, dx), side="right")) - 1) % count
        after = (k + 1) % count
        (ax, ay), (bx, by) = self.corners[k].tolist(), self.corners[after].tolist()
        cross = ax * by - ay * bx
        if cross <= 0.0:
            return -math.inf, None
        first, second = (dx * by - dy * bx) / cross, (ax * dy - ay * dx) / cross
        rest = 1.0 - first - second
        if min(first, second, rest) < 0.0:
            return -math.inf, None
        one, two = self.rim[k], self.rim[after]
        margin = rest * self.centre.margin + first * one.margin + second * two.margin
        return margin, rest * self.centre.thrust + first * one.thrust + second * two.thrust
