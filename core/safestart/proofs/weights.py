"""Norm limits and multipliers of a proof document; part of the checker."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any

from flint import fmpq

from safestart.proofs.strict import ProofRejected, fields, number, part, shown, vector

_MOST_MULTIPLIERS = 20_000
AT_END = ("hold", "rest")


@dataclass(frozen=True, slots=True)
class Weight:
    """One multiplier; ``pull``, |pull| <= value, for norm limits and cones; ``time`` None means the end."""

    time: fmpq | None
    face: str
    value: fmpq
    pull: list[fmpq]


@dataclass(frozen=True, slots=True)
class Limits:
    """Norm limits: the ball of ``radius`` around ``hold`` and the speed ``rest`` in it; the speed ``most``.

    ``rest_scale`` and ``scale`` (s) convert speeds into metres. Limits that the question lacks are None. ``keep_out``
    (m) is at most the hold radius.
    """

    hold: list[fmpq] | None
    radius: fmpq
    rest: fmpq
    most: fmpq | None
    scale: fmpq
    keep_out: fmpq | None

    @property
    def at_end(self) -> tuple[str, ...]:
        """Names of those limits of the question that hold at the end alone. Elsewhere faces may have such names."""
        return AT_END if self.hold is not None else ()

    @property
    def norms(self) -> tuple[str, ...]:
        """Names of the limits that the question has."""
        return self.at_end + (("speed",) if self.most is not None else ())

    @property
    def rest_scale(self) -> fmpq:
        """Seconds that convert the speed at the end into metres."""
        return self.radius / self.rest


def limits_of(question: Any, d: int, free: bool) -> Limits:
    """The norm limits of a question in ``d`` dimensions; ``free``: it has a goal, and T is free."""
    keep_out = number(question, "keep_out_m", 0.0) if "keep_out_m" in question else None
    if keep_out is not None and keep_out > number(question["corridor"], "hold_radius_m", 0.0):
        raise ProofRejected("keep_out_m: required at most hold_radius_m, where the hold plane implies it")
    hold, radius, rest, most, scale = None, fmpq(1), fmpq(1), None, fmpq(1)
    if free:
        goal = part(question, "goal", dict)
        fields(goal, "goal", ("hold_m", "radius_m", "rest_m_s"))
        hold = vector(goal.get("hold_m"), "hold_m", d)
        radius, rest = number(goal, "radius_m", 1e-6), number(goal, "rest_m_s", 1e-6)
    if "speed_limit" in question:
        speed = part(question, "speed_limit", dict)
        fields(speed, "speed_limit", ("most_m_s", "scale_s"))
        most, scale = number(speed, "most_m_s", 1e-6), number(speed, "scale_s", 1e-6)
    return Limits(hold, radius, rest, most, scale, keep_out)


def parts_of(
    rows: list[Any],
    ends: tuple[int, int],
    faces: Collection[str],
    limits: Limits,
    horizon: fmpq,
    d: int,
    cones: Collection[str] = (),
) -> list[tuple[int, int, list[Weight]]]:
    """The parts, which together must cover the ends (first, last) without a gap; ``faces`` by name, d dimensions.

    ``cones`` have a ``pull`` like the limits, the normal of one of their planes, at a time.
    """
    out, covered = [], ends[0]
    for row in rows:
        fields(row, "parts", ("first_step", "last_step", "multipliers"))
        first, last = part(row, "first_step", int), part(row, "last_step", int)
        if first != covered or not first <= last <= ends[1]:
            raise ProofRejected(
                f"parts: required the steps {ends[0]}..{ends[1]} in turn, received {first}..{last}"
            )
        made = part(row, "multipliers", list)
        out.append((first, last, _weights(made, faces, (*limits.norms, *cones), limits.at_end, horizon, d)))
        covered = last + 1
    if covered != ends[1] + 1:
        raise ProofRejected(f"parts: required all steps {ends[0]}..{ends[1]}, received up to {covered - 1}")
    return out


def _weights(
    rows: list[Any],
    faces: Collection[str],
    norms: Collection[str],
    at_end: Collection[str],
    horizon: fmpq,
    d: int,
) -> list[Weight]:
    if not 1 <= len(rows) <= _MOST_MULTIPLIERS:
        raise ProofRejected(f"multipliers: required 1..{_MOST_MULTIPLIERS}, received {len(rows)}")
    out = []
    for row in rows:
        face, value = row.get("face") if isinstance(row, Mapping) else None, number(row, "value", 0.0)
        if not isinstance(face, str) or (face not in faces and face not in norms):
            raise ProofRejected(f"multipliers: required a face of the question, received {shown(row, 90)}")
        at, with_pull = () if face in at_end else ("time_s",), ("pull",) if face in norms else ()
        fields(row, "multipliers", (*at, "face", "value", *with_pull))
        time = None if face in at_end else number(row, "time_s", 0.0)
        if time is not None and time > horizon:
            raise ProofRejected(f"multipliers: required a time in [0, T], received {shown(row, 90)}")
        pull = vector(row.get("pull"), "pull", d) if face in norms else []
        if sum((e * e for e in pull), fmpq(0)) > value**2:
            raise ProofRejected(f"|pull| <= value: received {shown(row, 120)}")
        out.append(Weight(time, face, value, pull))
    return out
