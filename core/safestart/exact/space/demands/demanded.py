"""Answers with demands that are not convex: GO by a convex part of them, NO_GO only where that is certain.

The question without demands is answered first: its NO_GO stands. Else convex parts (:mod:`.restriction`) are tried,
along the flight of that answer, past the start, on the way to the hold point, and along the flights found in turn. The
first flight that keeps all demands is a GO. If there is none, planes that hold the cone of the field of view may still
prove a NO_GO (:mod:`.relaxed`); otherwise the verdict is UNDECIDED.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from safestart.exact.answer import GUARD, Answer, Multiplier, Verdict
from safestart.exact.space.demands.relaxed import refuted
from safestart.exact.space.demands.restricted_watch import RestrictedWatch
from safestart.exact.space.demands.restriction import Course, course_of, cuts_of, plume_kept, walls_of
from safestart.exact.space.demands.rules import NONE, VIEW, Demands
from safestart.exact.space.question import SpaceQuestion
from safestart.exact.space.watch import SpaceWatch, space_watch_of
from safestart.model.scenario import Floats

Solve = Callable[[SpaceWatch], tuple[Answer, Floats | None]]
_AGAIN = 4


def decide_demanded(question: SpaceQuestion, state: Floats, solve: Solve) -> Answer:
    """Answer a question with demands for a start (6,); ``solve`` answers the watch of one without them.

    Beside the answer it gives the best flight's thrust, whatever the verdict.
    """
    demands, plain = question.demands, replace(question, demands=NONE)
    watch = space_watch_of(plain)
    body = question.attitude.rotation(np.zeros(1))[0] @ state[:3]
    name, room = min(demands.rooms(state[:3], body), key=lambda one: one[1], default=("", math.inf))
    if room < -GUARD:
        return Answer(Verdict.NO_GO, room, -math.inf, room, None, (Multiplier(0.0, name, 1.0),), 0)
    free, _ = solve(watch)
    if free.verdict is not Verdict.GO or free.thrust is None:
        return free
    turn = question.attitude.rotation(watch.sample_times)
    best, rounds = -math.inf, free.iterations
    latest = course_of(watch, turn, state, free.thrust)
    tries: Iterator[tuple[str, Course]] = _courses(question, watch, turn, state, latest)
    again, left = 0, ""
    while True:
        said, course = next(tries, ("along the flight found before", latest))
        again += said.endswith("before")
        if again > _AGAIN:
            break
        walls = walls_of(demands, watch, course)
        cuts = None if demands.plume is None else cuts_of(demands.plume, watch, turn, latest)
        found, thrust = solve(RestrictedWatch(watch, walls, cuts))
        rounds += found.iterations
        if thrust is None:
            continue
        latest = course_of(watch, turn, state, thrust)
        kept = demands.plume is None or bool(
            plume_kept(demands.plume, watch, turn, latest)[: len(thrust)].all()
        )
        if found.verdict is Verdict.GO and kept:
            return replace(
                found, upper=free.upper, iterations=rounds, restriction=restrictions(demands, said)
            )
        best = max(best, found.lower)
        left = "" if kept else ", or leaves the directions for which the plume's cut holds"
    if demands.view is not None:
        lost, more = refuted(watch, demands.view, state, solve)
        rounds += more
        if lost is not None:
            return replace(lost, iterations=rounds)
    reason = (
        f"stays without {', '.join(demands.names)} ({free.lower:.3g} m to spare), but no flight is found in the convex "
        f"parts tried of them{left}: whether there is another one is open"
    )
    return Answer(Verdict.UNDECIDED, math.nan, best, free.upper, None, (), rounds, reason)


def lost_at_start(demands: Demands, answer: Answer) -> str:
    """The demand that the start itself breaks, where that is the reason of a NO_GO; else empty."""
    first = answer.multipliers[0] if answer.multipliers else None
    return first.face if first is not None and first.face in demands.names and not first.pull else ""


def _courses(
    question: SpaceQuestion, watch: SpaceWatch, turn: Floats, state: Floats, flown: Course
) -> Iterator[tuple[str, Course]]:
    yield "along the best flight without the demands", flown
    lvlh = np.tile(state[:3], (len(turn), 1))
    body = np.tile(turn[0] @ state[:3], (len(turn), 1))
    if question.demands.keep_outs:
        yield "across the line from its centre to the start", Course(lvlh, body, flown.thrust)
    hold = question.goal and question.goal.hold
    if hold is not None and question.demands.keep_outs:
        share = (watch.sample_times / question.horizon)[:, None]
        there = body + share * (np.array(hold) - body)
        seen = (there[:, None] @ turn)[:, 0]
        yield "along the line from the start to the hold point", Course(seen, there, flown.thrust)


def restrictions(demands: Demands, course: str) -> tuple[str, ...]:
    """The convex parts in words, one for each demand."""
    out = []
    for one in demands.keep_outs:
        where = (
            f"half-space per step, {course}" if len(one.size) == 1 else f"a face's side per step, {course}"
        )
        out.append(f"{one.name}: {where}")
    if demands.view is not None:
        out.append(f"{VIEW}: pyramid of 16 faces in the cone")
    if demands.plume is not None:
        out.append(
            "plume: thrust on one side of a plane per step that leans by what the half-angle leaves, along the flight "
            "found before"
        )
    return tuple(out)
