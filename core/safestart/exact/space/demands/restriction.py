"""Convex parts of demands along a course: walls for keep-outs and the view, cuts of the thrusts for the plume.

A flight that keeps the walls keeps the demand, at least as many metres from it. The plume's depends on flight and
thrust together: its cuts hold for the directions in which the course sees the target, and :func:`plume_kept` tells
whether a flight has stayed within them.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from safestart.exact.space.demands.restricted_watch import Wall
from safestart.exact.space.demands.rules import VIEW, Demands, Plume
from safestart.exact.space.watch import SpaceWatch
from safestart.model.scenario import Bools, Floats

_VIEW_FACES = 16
# What the directions of another flight may differ by from those of the course; and what a kept flight has to spare, so
# that the checker finds it.
_OTHER, _SPARE = math.radians(3.0), math.radians(0.1)
_NEAR_SHARE, _NEAR_M = 0.05, 1.0


class Course(NamedTuple):
    """Positions (P, 3) at the samples of a watch in LVLH and in the body, and thrusts (N, 3) in LVLH, m and m/s^2."""

    lvlh: Floats
    body: Floats
    thrust: Floats


def course_of(watch: SpaceWatch, turn: Floats, state: Floats, thrust: Floats) -> Course:
    """The flight from ``state`` (6,) under ``thrust`` (k, channels), which may end early: then it stays in the body.

    ``turn`` (P, 3, 3) is the attitude at the samples.
    """
    part = watch.until(len(thrust))
    lvlh = part.flown(state, thrust)[:, :3]
    body = (turn[: len(lvlh)] @ lvlh[:, :, None])[..., 0]
    missing = len(turn) - len(lvlh)
    if missing:
        body = np.concatenate([body, np.repeat(body[-1:], missing, axis=0)])
        lvlh = np.concatenate([lvlh, (body[-missing:, None] @ turn[-missing:])[:, 0]])
    pushed = np.zeros((watch.question.steps, 3))
    pushed[: len(thrust)] = part.accelerations(thrust)
    return Course(lvlh, body, pushed)


def walls_of(demands: Demands, watch: SpaceWatch, course: Course) -> tuple[Wall, ...]:
    """Walls (one for each keep-out, 16 for the view) next to the course; one per interval."""
    steps, interval = watch.question.steps, watch.intervals
    count = np.bincount(interval, minlength=steps)[:, None]
    out = []
    for one in demands.keep_outs:
        points = course.body if one.frame == "body" else course.lvlh
        middle = np.stack([np.bincount(interval, points[:, i], steps) for i in range(3)], axis=1) / count
        normals, offsets = one.walls(middle)
        out.append(Wall(one.name, one.frame, normals, offsets))
    if demands.view is not None:
        normals, offsets = demands.view.walls(_VIEW_FACES)
        out += [
            Wall(VIEW, demands.view.frame, np.tile(normals[k], (steps, 1)), np.full(steps, offsets[k]))
            for k in range(_VIEW_FACES)
        ]
    return tuple(out)


def cuts_of(plume: Plume, watch: SpaceWatch, turn: Floats, course: Course) -> Floats:
    """Cuts g (N, 3) of the thrusts in LVLH, g_k . u_k <= 0; 0 for intervals away from the target.

    g_k leans from the line of sight by what the half-angle leaves, away from the side to which the course's thrust
    leans: so that thrust is kept where it keeps the rule.
    """
    away = _away(plume, turn, course)
    distance = np.sqrt(np.square(away).sum(axis=1))
    near = distance < plume.reach * (1.0 + _NEAR_SHARE) + _NEAR_M
    out = np.zeros((watch.question.steps, 3))
    for k in np.unique(watch.intervals[near]).tolist():
        own = away[watch.intervals == k] / np.maximum(distance[watch.intervals == k], 1e-9)[:, None]
        middle = own.sum(axis=0)
        middle /= max(math.hypot(*middle.tolist()), 1e-12)
        spread = float(np.arccos(np.clip((own @ middle).min(), -1.0, 1.0)))
        lean = max(0.0, 0.5 * math.pi - plume.half_angle - spread - _OTHER)
        push = course.thrust[k]
        side = push - (push @ middle) * middle
        if math.hypot(*side.tolist()) < 1e-3 * watch.question.largest_thrust:
            # No side is better: take turns.
            side = (-1.0) ** k * np.cross(middle, np.eye(3)[int(np.argmin(np.abs(middle)))])
        out[k] = math.cos(lean) * middle - math.sin(lean) * side / math.hypot(*side.tolist())
    return out


def plume_kept(plume: Plume, watch: SpaceWatch, turn: Floats, course: Course) -> Bools:
    """Whether each interval (N,) of a flight keeps the rule at its samples, with something to spare."""
    away = _away(plume, turn, course)
    distance = np.sqrt(np.square(away).sum(axis=1))
    push = course.thrust[watch.intervals]
    size = np.sqrt(np.square(push).sum(axis=1))
    along = (push * away).sum(axis=1) / np.maximum(size * distance, 1e-300)
    kept = (size == 0.0) | (along <= math.cos(plume.half_angle + _SPARE)) & (distance > 0.0)
    far = distance > plume.reach * (1.0 + 1e-6)
    steps = watch.question.steps
    wrong = np.bincount(watch.intervals, ~kept, steps), np.bincount(watch.intervals, ~far, steps)
    return np.asarray((wrong[0] == 0.0) | (wrong[1] == 0.0))


def _away(plume: Plume, turn: Floats, course: Course) -> Floats:
    """From the rule's point to the chaser at the samples (P, 3), LVLH."""
    point = np.array(plume.point)
    return course.lvlh - (point if plume.frame == "lvlh" else point @ turn)
