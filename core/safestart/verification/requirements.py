"""Requirements on the powered flight: thrust, line of sight, speed (octagon and disc), and staying in mode 2."""

from __future__ import annotations

import math

import numpy as np

from safestart.scenario import Floats
from safestart.verification.model import (
    FACE_LIMITS,
    FACE_NAMES,
    FACES,
    GAP_GUARD,
    LOS_SLOPE,
    MAX_SPEED,
    MAX_THRUST,
    Mode,
    gain,
    matrix,
    octagon,
)
from safestart.verification.question import Finding, Verdict
from safestart.verification.reach import Branch, Reach
from safestart.verification.rounding import UP

_DIRECTIONS = 64
_SPEED_ROWS, _SPEED_LIMITS = octagon(MAX_SPEED, MAX_SPEED * math.sqrt(2.0))


def thrust(reach: Reach) -> Finding:
    """Largest thrust per axis in modes 1 and 2, kg m/min^2."""
    worst = _worst(reach.far.upper(_both(gain(Mode.FAR))))
    rows = _both(gain(Mode.NEAR))
    for branch in reach.branches:
        worst = max([worst, *(_worst(tube.upper(rows)) for tube in branch.tubes())])
    return _below(worst, MAX_THRUST)


def speed_octagon(reach: Reach) -> Finding:
    """Octagon of paper 003 around the disc of 3 m/min: largest value relative to its faces, times 3 m/min."""
    rows = np.hstack([np.zeros((8, 2)), _SPEED_ROWS]) * (MAX_SPEED / _SPEED_LIMITS)[:, None]
    return _below(_in_mode_2(reach, rows), MAX_SPEED)


def speed_disc(reach: Reach) -> Finding:
    """Largest speed in mode 2, m/min: 64 directions, divided by the cosine of half the angle between them."""
    angle = 2.0 * math.pi / _DIRECTIONS * np.arange(_DIRECTIONS)
    rows = np.zeros((_DIRECTIONS, 4))
    rows[:, 2], rows[:, 3] = np.cos(angle), np.sin(angle)
    return _below(UP * _in_mode_2(reach, rows) / math.cos(math.pi / _DIRECTIONS), MAX_SPEED)


def line_of_sight(reach: Reach) -> Finding:
    """Least room (m) inside |y| <= -x tan 30 degrees, x >= -100 in mode 2, as written (rows not normalised).

    A branch that starts on the face x = -100 has no room there at first; that it only moves inwards is proved, and
    the margin is then that of the other faces.
    """
    rows = np.array([[LOS_SLOPE, 1.0, 0.0, 0.0], [LOS_SLOPE, -1.0, 0.0, 0.0]])
    worst = max((_worst(tube.upper(rows)) for b in reach.branches for tube in b.tubes()), default=-math.inf)
    base = np.array([-1.0, 0.0, 0.0, 0.0])
    return _below(max([worst, *(-_room_inside(branch, base, GAP_GUARD) for branch in reach.branches)]), 0.0)


def stays_in_mode_2(reach: Reach) -> str:
    """Empty where every branch is proved to stay inside the guard octagon; a reason otherwise."""
    for branch in reach.branches:
        for face, row in enumerate(FACES):
            if _room_inside(branch, np.array([*row, 0.0, 0.0]), float(FACE_LIMITS[face])) < 0.0:
                name = branch.crossing.name
                return f"after crossing {name} mode 2 is not proved to stay behind face {FACE_NAMES[face]}"
    return ""


def _room_inside(branch: Branch, row: Floats, limit: float) -> float:
    """Least proved room (m) of row . z <= limit in mode 2; negative: not proved.

    On the crossed face the value starts at the limit exactly: while it is proved to fall it stays below, and those
    segments are left out of the minimum.
    """
    falling = (
        bool((FACES[branch.crossing.face] == row[:2]).all()) and limit == FACE_LIMITS[branch.crossing.face]
    )
    room = math.inf
    for tube in branch.tubes():
        value = tube.upper(row[None, :])[:, 0]
        rate = tube.upper((row @ matrix(tube.mode))[None, :])[:, 0]
        falls = np.logical_and.accumulate(np.concatenate([[falling], rate < 0.0]))[1:]
        room = min(room, float((limit - value[~falls]).min(initial=math.inf)))
        falling = falling and bool(falls.all())
    return room


def _in_mode_2(reach: Reach, rows: Floats) -> float:
    return max((_worst(tube.upper(rows)) for b in reach.branches for tube in b.tubes()), default=0.0)


def _both(rows: Floats) -> Floats:
    return np.vstack([rows, -rows])


def _worst(values: Floats) -> float:
    return float(values.max(initial=-math.inf))


def _below(bound: float, limit: float) -> Finding:
    margin = limit - bound
    verdict = Verdict.SAFE if margin >= 0.0 else Verdict.UNKNOWN
    shown = bound if math.isfinite(bound) else None
    return Finding(verdict, shown, margin if math.isfinite(margin) else None, limit)
