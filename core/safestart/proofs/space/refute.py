"""The checker's NO_GO in space: weighted margins that no thrust history brings above the claim, for every end."""

from __future__ import annotations

from typing import NamedTuple

from flint import arb, arb_mat, fmpq

from safestart.proofs.space.attitude import Course
from safestart.proofs.space.demands import View
from safestart.proofs.space.motion import Held, Motion
from safestart.proofs.space.statement import SpaceStated
from safestart.proofs.strict import ProofRejected
from safestart.proofs.weights import Weight


class _Row(NamedTuple):
    """At ``time`` the weight's margin, times its value, is at most ``level`` + ``covector`` . state."""

    time: fmpq
    value: fmpq
    level: arb
    covector: arb_mat


class Refutation:
    """The multipliers of one statement; what an interval does is computed once for all ends."""

    def __init__(self, stated: SpaceStated, course: Course, motion: Motion) -> None:
        self.stated, self.course, self.motion = stated, course, motion
        self._held: dict[int, Held] = {}
        self._whole: dict[int, tuple[arb_mat, arb_mat]] = {}
        self._turns: dict[int, arb_mat] = {}

    def check(self) -> None:
        """Every end is refuted; without a row at the end only the part's first end needs to be."""
        for first, last, weights in self.stated.parts:
            path = [self._face_or_speed(w, w.time) for w in weights if w.time is not None]
            at_end = [w for w in weights if w.time is None]
            for k in range(first, (last if at_end else first) + 1):
                rows = [row for row in path if row.time <= self.stated.dt * k]
                self._end(k, rows + [self._at_end(w, k) for w in at_end])

    def _end(self, last: int, rows: list[_Row]) -> None:
        """Weights >= 0 of margins up to step ``last`` whose sum no thrust and no start brings above the claim < 0."""
        stated = self.stated
        total = bound = arb(0)
        sorted_in: dict[int, list[_Row]] = {}
        for row in rows:
            k = min(int((row.time / stated.dt).floor()), last - 1)
            sorted_in.setdefault(k, []).append(row)
            total, bound = total + arb(row.value), bound + row.level
        carried = arb_mat(1, 6)
        for k in reversed(range(max(sorted_in, default=-1) + 1)):
            phi, push = self._over(k)
            pull, carried = carried * push, carried * phi
            for row in sorted_in.get(k, []):
                phi, push = self._interval(k).at(row.time - stated.dt * k)
                pull, carried = pull + row.covector * push, carried + row.covector * phi
            bound += self._most(k, pull)
        for i in range(6):
            bound += carried[0, i] * arb(stated.start[i]) + carried[0, i].abs_upper() * arb(stated.half[i])
        claim = arb(stated.claim)
        if not (total > 0 and bound < 0 and bound <= claim * total and claim < 0):
            raise ProofRejected(
                f"sum of weighted margins <= margin_m < 0 for every thrust until {float(arb(stated.dt * last)):.9g} "
                f"s: the bound is {float(bound):.9g} m over weights {float(total):.9g}, the claim {float(claim):.9g} m"
            )

    def _interval(self, k: int) -> Held:
        if k not in self._held:
            self._held[k] = Held(self.motion, k)
        return self._held[k]

    def _over(self, k: int) -> tuple[arb_mat, arb_mat]:
        if k not in self._whole:
            self._whole[k] = self._interval(k).at(self.stated.dt)
        return self._whole[k]

    def _face_or_speed(self, weight: Weight, time: fmpq) -> _Row:
        value, limits = arb(weight.value), self.stated.limits
        zero = [arb(0)] * 3
        if weight.face == "speed" and weight.face not in self.stated.faces:
            scale = arb(limits.scale)
            covector = arb_mat(1, 6, zero + [-scale * arb(e) for e in weight.pull])
            return _Row(time, weight.value, value * scale * arb(limits.most or 0), covector)
        region = self.stated.demands.regions.get(weight.face)
        if isinstance(region, View):
            return self._plane(weight, time, region)
        face = self.stated.faces[weight.face]
        share = value / arb(sum((e * e for e in face.normal), fmpq(0))).sqrt()
        normal = arb_mat(1, 3, [share * arb(e) for e in face.normal])
        if face.frame == "body":
            normal = normal * self.course.at(time)
        covector = arb_mat(1, 6, [-normal[0, i] for i in range(3)] + zero)
        return _Row(time, weight.value, share * arb(face.offset), covector)

    def _plane(self, weight: Weight, time: fmpq, view: View) -> _Row:
        """Value times the margin of the cone is at most pull . (point - position), the claim being below 0."""
        pull = view.plane(weight.pull)
        level = sum((e * arb(q) for e, q in zip(pull, view.point, strict=True)), arb(0))
        normal = arb_mat(1, 3, pull)
        if view.frame == "body":
            normal = normal * self.course.at(time)
        covector = arb_mat(1, 6, [-normal[0, i] for i in range(3)] + [arb(0)] * 3)
        return _Row(time, weight.value, level, covector)

    def _at_end(self, weight: Weight, k: int) -> _Row:
        """``hold``: value (radius - |C r - h|); ``rest``: value (radius - s |C v - w x C r|); pull . y <= value |y|."""
        limits, value = self.stated.limits, arb(weight.value)
        turn, w = self.course.end(k - 1)
        p = [arb(e) for e in weight.pull]
        level, along = value * arb(limits.radius), arb_mat(1, 3, p) * turn
        time, zero = self.stated.dt * k, [arb(0)] * 3
        if weight.face == "hold":
            level += sum((e * arb(h) for e, h in zip(p, limits.hold or [], strict=True)), arb(0))
            covector = [-along[0, i] for i in range(3)] + zero
            return _Row(time, weight.value, level, arb_mat(1, 6, covector))
        scale = arb(limits.rest_scale)
        # p . (w x C r) = (p x w) . C r.
        crossed = [p[1] * w[2] - p[2] * w[1], p[2] * w[0] - p[0] * w[2], p[0] * w[1] - p[1] * w[0]]
        turned = arb_mat(1, 3, crossed) * turn
        covector = [scale * turned[0, i] for i in range(3)] + [-scale * along[0, i] for i in range(3)]
        return _Row(time, weight.value, level, arb_mat(1, 6, covector))

    def _most(self, k: int, pull: arb_mat) -> arb:
        """Largest pull . u over the thrusts of interval k."""
        limit = self.stated.thrust
        bounds = [arb(e) for e in limit.bounds]
        if limit.frame == "body":
            if k not in self._turns:
                self._turns[k] = self.course.at(self.stated.dt * k).transpose()
            pull = pull * self._turns[k]
        along = [pull[0, i] for i in range(3)]
        if limit.kind == "ball":
            return bounds[0] * sum((e.abs_upper() ** 2 for e in along), arb(0)).sqrt()
        if limit.kind == "box":
            return sum((bound * e.abs_upper() for bound, e in zip(bounds, along, strict=True)), arb(0))
        most = arb(0)
        for bound, direction in zip(bounds, limit.directions, strict=True):
            size = arb(sum((e * e for e in direction), fmpq(0))).sqrt()
            push = bound * sum((arb(e) * p for e, p in zip(direction, along, strict=True)), arb(0)) / size
            most = most.max(push)
        return most
