"""All variants of one question, each as an outline in a plane of the state space.

Planar systems by polygons, others by one linear program per variant and direction. ``side`` says what the outline is:
the set itself, an inner or an outer bound. Outlines from programs have a vertex per direction: hulls of found points
for what is exact or inner, meeting half-planes for outer bounds.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from safestart.model.scenario import Floats
from safestart.sets.backward import chance, planar, policy, program
from safestart.sets.backward.polygon import box, cut, hull
from safestart.sets.backward.program import Program
from safestart.sets.backward.question import Question

Side = Literal["exact", "inner", "outer"]
Code = Literal["ok", "empty", "numerical_failure"]

NAMES = (
    "nominal",
    "robust_open_loop",
    "robust_feedback",
    "robust_feedback_outer",
    "chance_open_loop",
    "chance_open_loop_outer",
    "chance_feedback",
)


@dataclass(frozen=True, slots=True)
class Plane:
    """Which two components are drawn, along how many directions; ``fixed`` holds others at values (a section)."""

    axes: tuple[int, int]
    directions: int
    fixed: dict[int, float]

    def units(self) -> Floats:
        """Unit directions (D, 2), the four axes among them if D is a multiple of 4."""
        angle = 2.0 * np.pi * np.arange(self.directions) / self.directions
        return np.stack([np.cos(angle), np.sin(angle)], axis=1)


@dataclass(frozen=True, slots=True)
class Variant:
    """``outline`` (V, 2), counter-clockwise, None unless ``code`` is ok; ``reach`` (D,) its extent per direction."""

    name: str
    side: Side
    code: Code
    outline: Floats | None
    reach: Floats | None


def variants(question: Question, risk: float, plane: Plane) -> Iterator[Variant]:
    """All of ``NAMES`` that apply, nominal first; ``risk`` is that of the chance constraints."""
    if len(question.a) == 2:
        yield from _polygons(question, risk, plane)
    else:
        yield from _programs(question, risk, plane)


def _polygons(question: Question, risk: float, plane: Plane) -> Iterator[Variant]:
    none = np.zeros((question.steps + 1, 2))
    noise = chance.confidence_box(question, risk)
    found: tuple[tuple[str, Side, list[Floats | None]], ...] = (
        ("nominal", "exact", planar.open_loop(question, none)),
        ("robust_open_loop", "exact", planar.open_loop(question, question.disturbed())),
        ("robust_feedback", "exact", planar.feedback(question, question.disturbance)),
        ("chance_open_loop", "inner", planar.open_loop(question, chance.joint(question, risk))),
        ("chance_open_loop_outer", "outer", planar.open_loop(question, chance.single(question, risk))),
        ("chance_feedback", "inner", planar.feedback(question, noise)),
    )
    axes = list(plane.axes)
    for name, side, sets in found:
        outline = None if sets[0] is None else hull(sets[0][:, axes])
        if outline is None:
            yield Variant(name, side, "empty", None, None)
        else:
            yield Variant(name, side, "ok", outline, (plane.units() @ outline.T).max(axis=1))


def _programs(question: Question, risk: float, plane: Plane) -> Iterator[Variant]:
    none = np.zeros((question.steps + 1, len(question.a)))
    nominal: Variant | None = None
    narrowed: tuple[tuple[str, Side, Floats], ...] = (
        ("nominal", "exact", none),
        ("robust_open_loop", "exact", question.disturbed()),
        ("chance_open_loop", "inner", chance.joint(question, risk)),
        ("chance_open_loop_outer", "outer", chance.single(question, risk)),
    )
    for name, side, shrunk in narrowed:
        found = _outlined(name, side, [program.open_loop(question, shrunk)] * plane.directions, plane)
        nominal = nominal or found
        yield found
    assert nominal is not None
    yield _outlined("robust_feedback_outer", "outer", _foreseen(question, plane), plane, nominal.reach)
    for name, disturbance in (
        ("robust_feedback", question.disturbance),
        ("chance_feedback", chance.confidence_box(question, risk)),
    ):
        yield _outlined(name, "inner", [policy.affine(question, disturbance)] * plane.directions, plane)


def _foreseen(question: Question, plane: Plane) -> list[Program | None]:
    """For each direction d the program in which the worst disturbance for d is known in advance.

    v pushes x(0) = A^-N x(N) - sum of A^-(k+1) (B u(k) + E v(k)) back along d the most where v_i(k) has the sign of
    (d A^-(k+1) E)_i.
    """
    none = np.zeros((question.steps + 1, len(question.a)))
    inverse = np.linalg.inv(question.a)
    out: list[Program | None] = []
    for unit in plane.units():
        row = np.zeros(len(question.a))
        row[list(plane.axes)] = unit
        known = np.zeros((question.steps, question.disturbance.shape[1]))
        for k in range(question.steps):
            row = row @ inverse
            known[k] = np.sign(row @ question.disturbance)
        out.append(program.open_loop(question, none, known))
    return out


def _outlined(
    name: str, side: Side, programs: list[Program | None], plane: Plane, most: Floats | None = None
) -> Variant:
    """Solve the program of each direction; ``most`` (D,) bounds an outer bound's reach from elsewhere."""
    axes, units = list(plane.axes), plane.units()
    points, reach = [], np.empty(len(units))
    for k, (unit, one) in enumerate(zip(units, programs, strict=True)):
        if one is None:
            return Variant(name, side, "empty", None, None)
        direction = np.zeros(one.size)
        direction[axes] = unit
        try:
            found = one.furthest(direction, plane.fixed)
        except ArithmeticError:
            return Variant(name, side, "numerical_failure", None, None)
        if found is None:
            return Variant(name, side, "empty", None, None)
        points.append(found[0][axes])
        reach[k] = unit @ points[-1]
    outline = hull(np.array(points))
    if side == "outer":
        if most is not None:
            reach = np.minimum(reach, most)
        wide = 4.0 * float(np.abs(reach).max()) + 1.0
        around = box(np.zeros(2), np.full(2, wide))
        assert around is not None
        met = cut(around, units, reach)
        # Half-planes that meet in a point or less are an empty set only up to rounding.
        outline = outline if met is None else met
    return Variant(name, side, "ok", outline, reach)
