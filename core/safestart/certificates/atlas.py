"""Proof atlas of one operating point: every start at rest answered in microseconds, with its proof.

The starts that can stay form a convex set: convex combinations of witnesses are witnesses, and every dual bounds the
margin of every start. So a few dozen cone programs give an inner polygon of proved GO and ceilings that prove NO_GO;
what lies between is UNDECIDED and at most ``relative_gap`` of the outer area.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from safestart.certificates.exact import GUARD, Answer, Multiplier, Verdict
from safestart.certificates.extent import Ceiling, Extent, NotSolved, Witness
from safestart.certificates.question import Question
from safestart.certificates.sandwich import Sandwich, Support, refine
from safestart.certificates.watch import watch_of
from safestart.errors import invalid
from safestart.scenario import MAX_RANGE, Floats, number

TOLERANCE = 0.005
MOST_DIRECTIONS = 200

Ints = np.ndarray[tuple[Any, ...], np.dtype[np.signedinteger[Any]]]
Evidence = tuple[Witness, Ceiling | None]


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
        """Proved lower and upper bound (m) on the margin of starts (..., 2); -inf below, +inf above where unknown."""
        points = np.asarray(points, dtype=np.float64)
        if points.ndim == 0 or points.shape[-1] != 2 or not np.isfinite(points).all():
            raise invalid("points", "finite, last axis of length 2 (metres)", points.shape)
        flat = points.reshape(-1, 2)
        upper = (
            (flat @ self.slopes.T + self.levels).min(axis=1)
            if len(self.levels)
            else np.full(len(flat), np.inf)
        )
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
        beyond = flat[:, 1] > self.y_max
        upper = np.where(beyond, np.inf, upper)
        return lower.reshape(points.shape[:-1]), upper.reshape(points.shape[:-1])

    def answer(self, point: Floats) -> Answer:
        """The proved answer for one start (2,), with its thrust or multipliers; UNDECIDED between the polygons."""
        point = np.asarray(point, dtype=np.float64)
        if point.shape != (2,):
            raise invalid("point", "shape (2,): x, y in metres", point.shape)
        low, high = (float(value) for value in self.bounds(point))
        if low > GUARD:
            return Answer(Verdict.GO, low, low, high, self._thrust(point), (), 0)
        if high < -GUARD:
            best = self.ceilings[int(np.argmin(self.slopes @ point + self.levels))]
            proof = tuple(
                Multiplier(float(time), self.names[int(face)], float(value))
                for time, face, value in zip(best.times, best.faces, best.weights, strict=True)
            )
            return Answer(Verdict.NO_GO, high, low, high, None, proof, 0)
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

    def _thrust(self, point: Floats) -> Floats:
        sector, weights = self._fan(point[None])
        k = int(sector[0])
        parts = (self.centre, self.rim[k], self.rim[(k + 1) % len(self.rim)])
        mixed: Floats = np.sum([w * part.thrust for w, part in zip(weights[0], parts, strict=True)], axis=0)
        return mixed


def build(question: Question, y_max: float = 150.0, tolerance: float = TOLERANCE) -> Atlas:
    """Build the atlas: directions are asked until the relative area gap is at most ``tolerance``.

    Raises ``InvalidInput`` for a question in 3-D, for a tolerance outside (1e-4, 1] and a cut below the hold plane.
    """
    if question.dimensions != 2:
        raise invalid("dimensions", "2: an atlas is planar", question.dimensions)
    number("tolerance", tolerance, 1e-4, 1.0)
    number("y_max", y_max, question.scenario.corridor.hold_radius, MAX_RANGE, open_low=True)
    watch = watch_of(question)
    extent = Extent(watch, y_max)
    deepest, ceiling = extent.deepest()
    found: list[Support[Evidence]] = []
    message, sandwich = "", None

    def oracle(direction: Floats) -> Support[Evidence]:
        witness, above, reach = extent.farthest(direction)
        bound = max(reach, float(direction @ witness.start))
        support = Support(direction, witness.start, bound, (witness, above))
        found.append(support)
        return support

    if deepest.margin > 2.0 * GUARD:
        try:
            sandwich = refine(oracle, tolerance, MOST_DIRECTIONS)
        except NotSolved as error:
            message = str(error)
    return _assemble(question, y_max, deepest, ceiling, found, sandwich, watch.names, message)


def _assemble(
    question: Question,
    y_max: float,
    deepest: Witness,
    ceiling: Ceiling | None,
    found: list[Support[Evidence]],
    sandwich: Sandwich[Evidence] | None,
    names: tuple[str, ...],
    message: str,
) -> Atlas:
    # Directions that end in one corner find it again, up to rounding: one witness of it is enough.
    rim = {tuple(np.round(s.point, 4)): s.evidence[0] for s in found if s.evidence[0].margin > GUARD}
    centre = _mean(deepest, tuple(rim.values()))
    ahead = [(math.atan2(*(w.start - centre.start)[::-1]), w) for w in rim.values()]
    ordered = sorted(ahead, key=lambda pair: pair[0])
    ceilings = tuple(c for c in (ceiling, *(s.evidence[1] for s in found)) if c is not None)
    return Atlas(
        question,
        y_max,
        deepest,
        centre,
        tuple(witness for _, witness in ordered),
        np.array([witness.start - centre.start for _, witness in ordered]).reshape(-1, 2),
        np.array([witness.margin for _, witness in ordered]),
        np.array([angle for angle, _ in ordered]),
        ceilings,
        np.array([c.slope for c in ceilings]).reshape(-1, 2),
        np.array([c.level for c in ceilings]),
        sandwich.inner_area if sandwich else 0.0,
        sandwich.outer_area if sandwich else 0.0,
        names,
        message,
    )


def _mean(deepest: Witness, rim: tuple[Witness, ...]) -> Witness:
    """Half the deepest start, half the mean of the rim: inside the polygon, and by convexity a witness itself.

    The deepest start alone may lie on the polygon's edge (on the cut), where a fan of triangles degenerates.
    """
    if not rim:
        return deepest
    share = 0.5 / len(rim)
    start = 0.5 * deepest.start + share * np.sum([w.start for w in rim], axis=0)
    thrust = 0.5 * deepest.thrust + share * np.sum([w.thrust for w in rim], axis=0)
    return Witness(start, thrust, 0.5 * deepest.margin + share * sum(w.margin for w in rim))
