"""Requirements on the powered flight: thrust, line of sight, speed (octagon and disc), and staying in mode 2."""

from __future__ import annotations

import math

import numpy as np

from safestart.model.scenario import Floats
from safestart.passive_safety.model import LOS_SLOPE, MAX_SPEED, MAX_THRUST, gain, matrix
from safestart.passive_safety.question import Finding, Verdict
from safestart.passive_safety.reach.entry import rows_of
from safestart.passive_safety.reach.reach_set import Branch, Reach
from safestart.passive_safety.reach.rounding import SLACK, UP
from safestart.passive_safety.reach.tube import Tube
from safestart.passive_safety.switching_guard import (
    COMPASS,
    COMPASS_STRETCH,
    FACE_LIMITS,
    FACE_NAMES,
    FACES,
    GAP_GUARD,
    Guard,
    octagon,
)

SPEED_FACES, SPEED_LIMITS = octagon(MAX_SPEED, MAX_SPEED * math.sqrt(2.0))
"""Velocity octagon of paper 003 around the disc: rows (8, 2) on the velocity, limits (8,) in m/min."""

_SPEED_STATE_ROWS = np.hstack([np.zeros((8, 2)), SPEED_FACES]) * (MAX_SPEED / SPEED_LIMITS)[:, None]
_CONE = np.array([[LOS_SLOPE, 1.0, 0.0, 0.0], [LOS_SLOPE, -1.0, 0.0, 0.0]])


def thrust(reach: Reach) -> Finding:
    """Largest thrust per axis in modes 1 and 2, kg m/min^2."""
    tubes = [reach.far, *(tube for branch in reach.branches for tube in branch.tubes)]
    return _below(max(_worst(tube.upper(_both(gain(tube.motion)))) for tube in tubes), MAX_THRUST)


def speed_octagon(reach: Reach) -> Finding:
    """Octagon of paper 003 around the disc of 3 m/min: largest value relative to its faces, times 3 m/min."""
    return _below(_in_mode_2(reach, _SPEED_STATE_ROWS), MAX_SPEED)


def speed_disc(reach: Reach) -> Finding:
    """Largest speed in mode 2, m/min: 64 directions, divided by the cosine of half the angle between them."""
    rows = np.hstack([np.zeros_like(COMPASS), COMPASS])
    return _below(UP * _in_mode_2(reach, rows) * COMPASS_STRETCH, MAX_SPEED)


def line_of_sight(reach: Reach) -> Finding:
    """Least room (m) inside |y| <= -x tan 30 degrees, x >= -100 in mode 2, as written (rows not normalised).

    A branch that starts on the face x = -100 has no room there at first; if it provably moves inwards, the margin is
    that of the other faces.
    """
    worst = max((_worst(tube.upper(_CONE)) for b in reach.branches for tube in b.tubes), default=-math.inf)
    base = np.array([-1.0, 0.0])
    return _below(max([worst, *(-_room_inside(branch, base, GAP_GUARD) for branch in reach.branches)]), 0.0)


def stays_in_mode_2(reach: Reach, guard: Guard) -> str:
    """ "" if every branch is proved to stay inside the guard; otherwise the reason."""
    if guard is Guard.CIRCLE:
        stays = all(_stays_in_circle(branch) for branch in reach.branches)
        return "" if stays else "mode 2 is not proved to stay inside the guard circle"
    for branch in reach.branches:
        for face, row in enumerate(FACES):
            if _room_inside(branch, row, float(FACE_LIMITS[face])) < 0.0:
                name = branch.crossing.name
                return f"after crossing {name} mode 2 is not proved to stay behind face {FACE_NAMES[face]}"
    return ""


def first_doubt(reach: Reach) -> tuple[float, str]:
    """Earliest time (min) at which thrust, line of sight or speed octagon is not proved, and its name; inf: never.

    Assumes that mode 2 is proved to stay inside the guard (:func:`stays_in_mode_2`), and so x >= -100 m.
    """
    doubts = [_first_above(reach.far, 0.0, "thrust", _both(gain(reach.far.motion)), MAX_THRUST)]
    for branch in reach.branches:
        for tube in branch.tubes:
            doubts += [
                _first_above(tube, branch.crossing.first, "thrust", _both(gain(tube.motion)), MAX_THRUST),
                _first_above(tube, branch.crossing.first, "los", _CONE, 0.0),
                _first_above(tube, branch.crossing.first, "velocity", _SPEED_STATE_ROWS, MAX_SPEED),
            ]
    return min(doubts)


def _first_above(tube: Tube, since: float, name: str, rows: Floats, limit: float) -> tuple[float, str]:
    above = np.flatnonzero((tube.upper(rows) > limit).any(axis=1))
    return (since + tube.time(int(above[0])), name) if len(above) else (math.inf, "")


def _stays_in_circle(branch: Branch) -> bool:
    """Whether the distance never exceeds the circle again: it falls after the crossing until it is proved inside.

    Half the rate of its square is p.v = (h.p)(h.v) + (k.p)(k.v), h the normal at the nominal crossing, k across it.
    """
    normal = branch.crossing.normal
    frame = np.stack([normal, [-normal[1], normal[0]]])
    rows = np.vstack([np.hstack([frame, np.zeros((2, 2))]), np.hstack([np.zeros((2, 2)), frame])])
    falling = True
    for tube in branch.tubes:
        upper, lower = tube.upper(rows), -tube.upper(-rows)
        ends = np.stack([a[:, :2] * b[:, 2:] for a in (upper, lower) for b in (upper, lower)])
        rate = ends.max(axis=0).sum(axis=1) + SLACK * np.abs(ends).max(axis=0).sum(axis=1)
        inside = UP * COMPASS_STRETCH * tube.upper(rows_of(COMPASS)).max(axis=1) < GAP_GUARD
        falls = np.logical_and.accumulate(np.concatenate([[falling], rate < 0.0]))[1:]
        if not (falls | inside).all():
            return False
        falling = bool(falls.all())
    return True


def _room_inside(branch: Branch, row: Floats, limit: float) -> float:
    """Least proved room (m) of ``row`` . (x, y) <= limit in mode 2; negative: not proved.

    The limit must hold throughout the guard: then it holds at the first entry, a point of the guard, and as long as the
    value is proved to fall; those segments are left out of the minimum. (The crossing set of one face of the octagon
    may reach beyond its corners, but no flight does.)
    """
    falling = True
    whole = rows_of(row[None, :])
    room = math.inf
    for tube in branch.tubes:
        value = tube.upper(whole)[:, 0]
        rate = tube.upper(whole @ matrix(tube.motion))[:, 0]
        falls = np.logical_and.accumulate(np.concatenate([[falling], rate < 0.0]))[1:]
        room = min(room, float((limit - value[~falls]).min(initial=math.inf)))
        falling = falling and bool(falls.all())
    return room


def _in_mode_2(reach: Reach, rows: Floats) -> float:
    return max((_worst(tube.upper(rows)) for b in reach.branches for tube in b.tubes), default=0.0)


def _both(rows: Floats) -> Floats:
    return np.vstack([rows, -rows])


def _worst(values: Floats) -> float:
    return float(values.max(initial=-math.inf))


def _below(bound: float, limit: float) -> Finding:
    margin = limit - bound
    verdict = Verdict.SAFE if margin >= 0.0 else Verdict.UNKNOWN
    shown = bound if math.isfinite(bound) else None
    return Finding(verdict, shown, margin if math.isfinite(margin) else None, limit)
