"""The checker of proofs in space: the thrust history flown, or the multipliers summed, in ball arithmetic."""

from __future__ import annotations

from typing import Any

from flint import arb, arb_mat, arb_poly, fmpq

from safestart.proofs.single import Verified
from safestart.proofs.space.attitude import Course, Piece
from safestart.proofs.space.motion import Held, Motion, Stretch
from safestart.proofs.space.orbit import Orbit
from safestart.proofs.space.series import Series, between, fresh_budget, pieces_of, require_positive
from safestart.proofs.space.statement import SpaceStated, read
from safestart.proofs.space.wording import lines
from safestart.proofs.strict import ProofRejected
from safestart.runtime.precision import precise

_PRECISION = 240


def check(document: Any) -> Verified:
    """Check a proof; raise :class:`ProofRejected` with the reason when it is malformed or an inequality fails."""
    stated = read(document)
    with precise(_PRECISION):
        orbit = Orbit(stated.mean_motion, stated.eccentricity, stated.true_anomaly)
        course, motion = Course(stated, orbit), Motion(orbit, stated.dt)
        if stated.verdict == "GO":
            pieces = _fly(stated, course, motion)
        else:
            pieces = 0
            _refute(stated, course, motion)
    return Verified(stated.verdict, float(document["margin_m"]), pieces, lines(stated))


def _fly(stated: SpaceStated, course: Course, motion: Motion) -> int:
    """Every thrust can be had and every distance is >= the claim > 0 at all times; the number of pieces it took."""
    state, budget = [arb(e) for e in stated.start], fresh_budget()
    for k, entry in enumerate(stated.history):
        push = _push(stated, course, k, entry)
        stretches = motion.over(k, [state], [push])
        for piece in course.pieces[k]:
            _keeps(stated, piece, stretches, stated.dt * k, budget)
        state = [p(arb(1)) for p in stretches[-1].flown[0]]
    return pieces_of(budget)


def _push(stated: SpaceStated, course: Course, k: int, entry: list[fmpq]) -> list[arb]:
    """Thrust k in LVLH axes; raises where it is not in the set, exactly."""
    limit = stated.thrust
    if limit.kind == "ball":
        square = sum((e * e for e in entry), fmpq(0))
        if square > limit.bounds[0] ** 2:
            raise ProofRejected(f"|u_{k}| <= a_max: |u|^2 is {float(arb(square)):.17g} m^2/s^4")
        return [arb(e) for e in entry]
    if limit.kind == "box":
        if any(abs(e) > 1 for e in entry):
            raise ProofRejected(f"throttle {k}: required shares in [-1, 1]")
        own = [arb(e * bound) for e, bound in zip(entry, limit.bounds, strict=True)]
    else:
        if any(e < 0 for e in entry) or sum(entry, fmpq(0)) > 1:
            raise ProofRejected(f"throttle {k}: required shares >= 0, together at most 1")
        own = [arb(0)] * 3
        for share, (direction, bound) in zip(
            entry, zip(limit.directions, limit.bounds, strict=True), strict=True
        ):
            size = arb(sum((e * e for e in direction), fmpq(0))).sqrt()
            own = [o + arb(share * bound * e) / size for o, e in zip(own, direction, strict=True)]
    if limit.frame == "lvlh":
        return own
    turned = course.at(stated.dt * k).transpose() * arb_mat(3, 1, own)
    return [turned[i, 0] for i in range(3)]


def _keeps(
    stated: SpaceStated, piece: Piece, stretches: list[Stretch], begin: fmpq, budget: list[int]
) -> None:
    """Every distance is at least the claim over the piece."""
    claim = arb(stated.claim)
    for stretch in stretches:
        first = max(piece.begin, begin + stretch.begin)
        last = min(piece.begin + piece.length, begin + stretch.begin + stretch.length)
        if first >= last:
            continue
        position = [
            between(
                p, arb((first - begin - stretch.begin) / stretch.length), arb((last - first) / stretch.length)
            )
            for p in stretch.flown[0][:3]
        ]
        body = _in_body(piece, position, first, last)
        for name, face in stated.faces.items():
            at = body if face.frame == "body" else position
            length = arb(sum((e * e for e in face.normal), fmpq(0))).sqrt()
            used = sum((arb(e) * p for e, p in zip(face.normal, at, strict=True)), arb_poly([0]))
            room = (arb(face.offset) - used) * (1 / length) - claim
            require_positive(room, name, first, last - first, budget)


def _in_body(piece: Piece, position: Series, first: fmpq, last: fmpq) -> Series:
    whole = first == piece.begin and last == piece.begin + piece.length
    out = []
    for row in piece.turn:
        if not whole:
            begin, width = arb((first - piece.begin) / piece.length), arb((last - first) / piece.length)
            row = [between(p, begin, width) for p in row]
        out.append(sum((c * p for c, p in zip(row, position, strict=True)), arb_poly([0])))
    return out


def _refute(stated: SpaceStated, course: Course, motion: Motion) -> None:
    """Weighted distances whose sum no thrust history brings above the claim < 0."""
    total = bound = arb(0)
    sorted_in: dict[int, list[tuple[fmpq, arb_mat]]] = {}
    for time, name, value in stated.weights:
        face = stated.faces[name]
        share = arb(value) / arb(sum((e * e for e in face.normal), fmpq(0))).sqrt()
        normal = arb_mat(1, 3, [share * arb(e) for e in face.normal])
        if face.frame == "body":
            normal = normal * course.at(time)
        k = min(int((time / stated.dt).floor()), stated.steps - 1)
        covector = arb_mat(1, 6, [-normal[0, i] for i in range(3)] + [arb(0)] * 3)
        sorted_in.setdefault(k, []).append((time - stated.dt * k, covector))
        total, bound = total + arb(value), bound + share * arb(face.offset)
    carried = arb_mat(1, 6)
    for k in reversed(range(max(sorted_in) + 1)):
        held = Held(motion, k)
        phi, push = held.at(stated.dt)
        pull, carried = carried * push, carried * phi
        for s, covector in sorted_in.get(k, []):
            phi, push = held.at(s)
            pull, carried = pull + covector * push, carried + covector * phi
        bound += _most(stated, course, k, pull)
    bound += (carried * arb_mat(6, 1, [arb(e) for e in stated.start]))[0, 0]
    claim = arb(stated.claim)
    if not (total > 0 and bound < 0 and bound <= claim * total and claim < 0):
        raise ProofRejected(
            "sum of weighted distances <= margin_m < 0 for every thrust: the bound is "
            f"{float(bound):.9g} m over weights {float(total):.9g}, the claim {float(claim):.9g} m"
        )


def _most(stated: SpaceStated, course: Course, k: int, pull: arb_mat) -> arb:
    """Largest pull . u over the thrusts of interval k."""
    limit = stated.thrust
    bounds = [arb(e) for e in limit.bounds]
    if limit.frame == "body":
        pull = pull * course.at(stated.dt * k).transpose()
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
