"""The checker of proofs in space: the thrust history flown in ball arithmetic; ``refute.py`` sums multipliers."""

from __future__ import annotations

from typing import Any

from flint import arb, arb_mat, arb_poly, fmpq

from safestart.proofs.single import Verified
from safestart.proofs.space.attitude import Course, Piece
from safestart.proofs.space.motion import Motion, Stretch
from safestart.proofs.space.orbit import Orbit
from safestart.proofs.space.refute import Refutation
from safestart.proofs.space.series import Series, between, fresh_budget, pieces_of, require_positive
from safestart.proofs.space.spread import Spread
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
        pieces = 0
        if stated.verdict == "GO":
            spread = Spread(stated, course, orbit) if stated.unknowns is not None else None
            pieces = _fly(stated, course, motion, spread)
        elif stated.violated:
            _is_outside(stated, course)
        else:
            Refutation(stated, course, motion).check()
    return Verified(stated.verdict, float(document["margin_m"]), pieces, lines(stated))


def _fly(stated: SpaceStated, course: Course, motion: Motion, spread: Spread | None) -> int:
    """Check that every thrust is in its set, and that every margin keeps the claimed one, which is > 0, at all times.

    For a box of starts it flies the middle, and with it the change of the state with each number of the start.
    ``spread`` says how much the other unknowns take off the distances. Returns the number of pieces that it took.
    """
    wide = [i for i in range(6) if stated.half[i] > 0]
    columns = [[arb(e) for e in stated.start]]
    columns += [[arb(stated.half[i]) if i == j else arb(0) for j in range(6)] for i in wide]
    still, budget = [[arb(0)] * 3] * len(wide), fresh_budget()
    for k, entry in enumerate(stated.history):
        push = _push(stated, course, k, entry)
        stretches = motion.over(k, columns, [push, *still])
        for piece in course.pieces[k]:
            _keeps(stated, piece, stretches, stated.dt * k, budget, push, spread)
        if stated.limits.most is not None:
            _holds_back(stated, stretches, stated.dt * k, budget)
        columns = [[p(arb(1)) for p in each] for each in stretches[-1].flown]
    if stated.limits.hold is not None:
        _ends(stated, course, columns[0])
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
    stated: SpaceStated,
    piece: Piece,
    stretches: list[Stretch],
    begin: fmpq,
    budget: list[int],
    push: list[arb],
    spread: Spread | None,
) -> None:
    """Every distance is at least the claim over the piece, and every demand is kept under the thrust ``push``."""
    claim, marks = arb(stated.claim), [(begin + s.begin, begin + s.begin + s.length, s) for s in stretches]
    for stretch_first, stretch_last, stretch in marks:
        first, last = max(piece.begin, stretch_first), min(piece.begin + piece.length, stretch_last)
        if first >= last:
            continue
        for a, b in spread.spans(piece, stretch, stretch_first, first, last) if spread else [(first, last)]:
            start, width = arb((a - stretch_first) / stretch.length), arb((b - a) / stretch.length)
            flown = [[between(p, start, width) for p in each[:3]] for each in stretch.flown]
            body = [_in_body(piece, position, a, b) for position in flown]
            taken = spread.taken(piece, flown, a, b) if spread else None
            for name, face in stated.faces.items():
                length = arb(sum((e * e for e in face.normal), fmpq(0))).sqrt()
                along = [
                    sum((arb(e) * p for e, p in zip(face.normal, at, strict=True)), arb_poly([0]))
                    * (1 / length)
                    for at in (body if face.frame == "body" else flown)
                ]
                room, less = arb(face.offset) / length - along[0] - claim, along[1:]
                if taken is not None:
                    room, less = taken.from_face(room, less, in_body=face.frame == "body")
                require_positive(room, f"distance to {name}", a, b - a, budget, less)
            if stated.demands:
                held = [arb_poly([e]) for e in push]
                pushes = {"lvlh": held, "body": _in_body(piece, held, a, b)}
                stated.demands.keep({"lvlh": flown[0], "body": body[0]}, pushes, claim, (a, b - a), budget)


def _in_body(piece: Piece, position: Series, first: fmpq, last: fmpq) -> Series:
    whole = first == piece.begin and last == piece.begin + piece.length
    out = []
    for row in piece.turn:
        if not whole:
            begin, width = arb((first - piece.begin) / piece.length), arb((last - first) / piece.length)
            row = [between(p, begin, width) for p in row]
        out.append(sum((c * p for c, p in zip(row, position, strict=True)), arb_poly([0])))
    return out


def _is_outside(stated: SpaceStated, course: Course) -> None:
    """The start does not keep the demand that the document names."""
    lvlh, turn = [arb(e) for e in stated.start[:3]], course.at(fmpq(0))
    body = [sum((turn[i, j] * lvlh[j] for j in range(3)), arb(0)) for i in range(3)]
    at = {"lvlh": [arb_poly([e]) for e in lvlh], "body": [arb_poly([e]) for e in body]}
    stated.demands.require_violated(stated.violated, at, arb(stated.claim))


def _holds_back(stated: SpaceStated, stretches: list[Stretch], begin: fmpq, budget: list[int]) -> None:
    """|v| <= most - claim / scale at all times, squared."""
    limit = arb(stated.limits.most or 0) - arb(stated.claim) / arb(stated.limits.scale)
    if not limit >= 0:
        raise ProofRejected("margin_m: required at most scale_s times the speed limit")
    for stretch in stretches:
        square = sum((p * p for p in stretch.flown[0][3:]), arb_poly([0]))
        require_positive(
            limit * limit - square, "margin of speed", begin + stretch.begin, stretch.length, budget
        )


def _ends(stated: SpaceStated, course: Course, state: list[arb]) -> None:
    """At the end the margin of the ball around the hold point and of the rest against the body is >= the claim."""
    limits, claim, last = stated.limits, arb(stated.claim), len(stated.history)
    turn, w = course.end(last - 1)
    body = [sum((turn[i, j] * state[j] for j in range(3)), arb(0)) for i in range(3)]
    speed = [sum((turn[i, j] * state[3 + j] for j in range(3)), arb(0)) for i in range(3)]
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        speed[i] = speed[i] - (w[j] * body[k] - w[k] * body[j])
    away = [e - arb(h) for e, h in zip(body, limits.hold or [], strict=True)]
    for name, used in (("hold", _size(away)), ("rest", arb(limits.rest_scale) * _size(speed))):
        room = arb(limits.radius) - used
        if not room >= claim:
            raise ProofRejected(
                f"margin of {name} >= margin_m at the end, t = {float(arb(stated.dt * last)):.9g} s: it is "
                f"{float(room):.9g} m, the claim {float(claim):.9g} m"
            )


def _size(vector: list[arb]) -> arb:
    return sum((e * e for e in vector), arb(0)).sqrt()
