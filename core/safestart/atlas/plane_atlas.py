"""The starts of a plane in space that can stay, between a proved inner polygon and proved half-planes.

The margin is concave in the start: every distance is affine in start and thrust. So

- the starts between starts that stay do stay, with the same mixture of their thrusts: corners with witnesses span the
  inner polygon;
- the multipliers of one answer bound the margin of every start by an affine function, and where that is negative no
  start stays: the outer polygon.

From the deepest start found, rays are shot at the corner of the outer polygon that is furthest from the inner one. Each
answer on a ray either is a new corner or cuts the outer polygon, until the two are close enough.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog
from scipy.spatial import ConvexHull, QhullError

from safestart.atlas.plane_polygons import area, clipped, furthest
from safestart.errors import invalid
from safestart.exact.answer import GUARD, Answer, Multiplier, Verdict
from safestart.exact.search import Search, rounding_of
from safestart.exact.space.plane import Plane
from safestart.exact.space.question import SpaceQuestion
from safestart.exact.space.watch import space_watch_of
from safestart.model.scenario import Bools, Floats

TOLERANCE = 1e-3
"""Bracket (m) of the answers: their multipliers are that close to the best."""
_FIRST_ROUNDS, _ON_RAY = 30, 14


@dataclass(frozen=True, slots=True)
class Corner:
    """A start (2,) of the plane that stays by ``margin`` m with ``thrust``."""

    point: Floats
    margin: float
    thrust: Floats


@dataclass(frozen=True, slots=True)
class Bound:
    """No start p of the plane keeps more than ``level`` + ``slope`` . p m, proved by ``multipliers``."""

    level: float
    slope: Floats
    multipliers: tuple[Multiplier, ...]


@dataclass(frozen=True, slots=True)
class PlaneAtlas:
    """``corners`` of the inner polygon counter-clockwise, ``bounds``, the ``outer`` polygon (K, 2), what it took."""

    question: SpaceQuestion
    plane: Plane
    corners: tuple[Corner, ...]
    bounds: tuple[Bound, ...]
    outer: Floats
    deepest: Corner | None
    asked: int
    message: str

    @property
    def inner(self) -> Floats:
        """Corners (K, 2) of the inner polygon; empty if no start stays."""
        return np.array([corner.point for corner in self.corners]).reshape(-1, 2)

    @property
    def inner_area(self) -> float:
        """In the units of the two coordinates."""
        return area(self.inner)

    @property
    def outer_area(self) -> float:
        """In the units of the two coordinates."""
        return max(self.inner_area, area(self.outer))

    @property
    def relative_gap(self) -> float:
        """(outer - inner) / outer area; 0 where both are empty."""
        outer = self.outer_area
        return (outer - self.inner_area) / outer if outer > 0.0 else 0.0

    def verdicts(self, points: Floats) -> tuple[Bools, Bools]:
        """Proved GO and proved NO_GO (...,) of points (..., 2)."""
        levels = np.array([bound.level for bound in self.bounds])
        slopes = np.array([bound.slope for bound in self.bounds]).reshape(-1, 2)
        no_go = np.asarray(((points @ slopes.T + levels) < 0.0).any(axis=-1))
        if len(self.corners) < 3:
            return np.zeros(points.shape[:-1], dtype=bool), no_go
        a = self.inner
        edge = np.roll(a, -1, axis=0) - a
        away = points[..., None, :] - a
        return np.asarray((edge[:, 0] * away[..., 1] - edge[:, 1] * away[..., 0] >= 0.0).all(axis=-1)), no_go

    def answer_at(self, corner: Corner) -> tuple[Floats, Answer]:
        """LVLH start (6,) of a corner and its GO, for a proof."""
        answer = Answer(Verdict.GO, corner.margin, corner.margin, math.inf, corner.thrust, (), 0)
        return self.plane.states(corner.point), answer

    def answer_beyond(self, bound: Bound, point: Floats, least: float = 1e-4) -> tuple[Floats, Answer]:
        """LVLH start (6,) next to ``point``, where the bound is ``-least`` m, and its NO_GO, for a proof."""
        value = bound.level + float(bound.slope @ point)
        beyond = point - bound.slope * (value + least) / float(bound.slope @ bound.slope)
        upper = bound.level + float(bound.slope @ beyond)
        answer = Answer(Verdict.NO_GO, upper, -math.inf, upper, None, bound.multipliers, 0)
        return self.plane.states(beyond), answer


class _Survey:
    """What is known of one plane: coordinates u in the unit square, its corners and bounds."""

    def __init__(self, question: SpaceQuestion, plane: Plane, step: Callable[[], None]) -> None:
        self.question, self.plane, self._step = question, plane, step
        self.watch = space_watch_of(question)
        self.span = plane.high - plane.low
        self.corners: list[Corner] = []
        self.bounds: list[Bound] = []
        self.asked, self.failed = 0, ""
        square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
        self.outer = square
        # What floats may lose of a margin anywhere on the plane.
        self._lost = max(rounding_of(self.watch, plane.states(self.at(u))) for u in square)

    def at(self, u: Floats) -> Floats:
        return np.asarray(self.plane.low + u * self.span)

    def ask(self, u: Floats) -> Corner | None:
        """The answer at ``u``: a corner if it is a GO; its bound is noted either way."""
        self.asked += 1
        self._step()
        point = self.at(u)
        search = Search(self.watch, self.plane.states(point))
        if search.distance_now < -GUARD:
            face = self.watch.names.index(search.now.face)
            gradient = np.zeros(6)
            gradient[:3] = -self.watch.normals[face]
            self._note(search.distance_now + self._lost, gradient, point, (search.now,))
            return None
        reason = search.narrow(TOLERANCE)
        if search.evidence is not None:
            evidence = search.evidence.until(self.question.latest)
            weights = evidence.weights[: len(evidence.times)]
            gradient = weights @ self.watch.cuts(evidence.times, evidence.faces).start
            value = search.upper - search.rounding + self._lost
            self._note(value, gradient, point, evidence.multipliers(self.watch.names))
        else:
            self.failed = reason
        if search.lower <= GUARD or search.thrust is None:
            return None
        corner = Corner(point, search.lower, search.thrust)
        self.corners.append(corner)
        return corner

    def _note(
        self, value: float, gradient: Floats, point: Floats, multipliers: tuple[Multiplier, ...]
    ) -> None:
        slope = gradient @ self.plane.columns
        bound = Bound(value - float(slope @ point), slope, multipliers)
        self.bounds.append(bound)
        level, normal = self.unit(bound)
        self.outer = clipped(self.outer, level, normal)

    def unit(self, bound: Bound) -> tuple[float, Floats]:
        """Level and slope over u."""
        return bound.level + float(bound.slope @ self.plane.low), bound.slope * self.span

    def hopeful(self) -> tuple[float, Floats]:
        """The largest margin that the bounds leave, m, and where."""
        rows = [self.unit(bound) for bound in self.bounds]
        matrix = np.array([[-n[0], -n[1], 1.0] for _, n in rows])
        found = linprog(
            [0.0, 0.0, -1.0],
            matrix,
            np.array([level for level, _ in rows]),
            bounds=[(0.0, 1.0), (0.0, 1.0), (None, None)],
        )
        if found.x is None:
            return math.inf, np.full(2, 0.5)
        return float(found.x[2]), np.asarray(found.x[:2])

    def shoot(self, centre: Floats, target: Floats, fine: float) -> None:
        """Ask along the ray from ``centre`` through ``target`` (u) until corner and bound are ``fine`` apart."""
        ray = target - centre
        if not ray.any():
            return
        inside = 0.0
        with np.errstate(divide="ignore", invalid="ignore"):
            walls = np.where(ray > 0.0, (1.0 - centre) / ray, np.where(ray < 0.0, -centre / ray, np.inf))
        most, back, before = float(walls.min()), 0.0, math.inf
        for _ in range(_ON_RAY):
            limit = most
            for bound in self.bounds:
                level, normal = self.unit(bound)
                drop = float(normal @ ray)
                if drop < 0.0:
                    limit = min(limit, -(level + float(normal @ centre)) / drop)
            if limit - inside <= max(fine, back):
                return
            # The edge of the plane itself first. On the edge of the set an answer decides nothing: from there back.
            if limit < most or before < math.inf:
                back = max(0.5 * fine, 2.0 * back if before - limit < 0.5 * fine else 0.0)
            before = limit
            share = max(inside, limit - back)
            if self.ask(centre + share * ray) is not None:
                inside = share


def _hull(corners: list[Corner]) -> list[Corner]:
    points = np.array([corner.point for corner in corners])
    try:
        return [corners[k] for k in ConvexHull(points).vertices]
    except (QhullError, ValueError):
        return corners[:1]


def build_on_plane(
    question: SpaceQuestion, plane: Plane, gap: float, most: int, step: Callable[[], None] = lambda: None
) -> PlaneAtlas:
    """Survey a plane until the share ``gap`` of the outer area is left between the polygons, or ``most`` questions.

    ``step`` is called before every question. Raises ``InvalidInput`` for another question than `stay` without a limit.
    """
    if not question.plain:
        raise invalid("question", "stay without a speed limit or demands", question.kind)
    survey = _Survey(question, plane, step)
    survey.ask(np.full(2, 0.5))
    hope = math.inf
    for _ in range(_FIRST_ROUNDS):
        hope, where = survey.hopeful()
        best = max((corner.margin for corner in survey.corners), default=-math.inf)
        if hope < 0.0 or survey.failed or best >= 0.8 * hope:
            break
        survey.ask(where)
    deepest = max(survey.corners, key=lambda corner: corner.margin, default=None)
    message = survey.failed
    if deepest is None:
        message = message or (
            "no start of the plane stays" if hope < 0.0 else "no start that stays was found"
        )
        outer = plane.low + survey.outer * survey.span if hope >= 0.0 else np.empty((0, 2))
        return PlaneAtlas(question, plane, (), tuple(survey.bounds), outer, None, survey.asked, message)
    centre = (deepest.point - plane.low) / survey.span
    fine = 0.1 * gap
    for target in np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]):
        survey.shoot(centre, target, fine)
    areas = (0.0, math.inf)
    while survey.asked < most:
        hull = _hull(survey.corners)
        inner = (np.array([corner.point for corner in hull]) - plane.low) / survey.span
        before, areas = areas, (area(inner), area(survey.outer))
        if areas[1] - areas[0] <= gap * areas[1]:
            break
        if areas == before:
            # The corner lies as near as a ray can tell: a finer one.
            fine *= 0.5
            if fine < 1e-7:
                break
        survey.shoot(centre, furthest(survey.outer, inner), fine)
    kept = _hull(survey.corners)
    if survey.asked >= most:
        message = f"stopped after {most} questions"
    outer = plane.low + survey.outer * survey.span
    return PlaneAtlas(
        question, plane, tuple(kept), tuple(survey.bounds), outer, deepest, survey.asked, message
    )
