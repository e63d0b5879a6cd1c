"""All possible failures of a plan, as sets of states from which the chaser drifts.

The interval [0, tau] of a late or stuck burn is cut into short pieces. On each piece the curve of equivalent states at
the time of the burn is replaced by its tangent in the middle plus a box for its bend (Taylor's remainder).
"""

from __future__ import annotations

import math

import numpy as np

from safestart.dynamics.burn import frame
from safestart.dynamics.cwh import input_matrix, transition_matrix
from safestart.missed_burn.earth.cases import late_and_stuck
from safestart.missed_burn.earth.motion import lift_of, target_before
from safestart.missed_burn.finite_cases import finite_cases
from safestart.missed_burn.plan import Burn, Question, duration_of
from safestart.missed_burn.sets import Case, StateSet, add_burn, pieces, shell
from safestart.model.scenario import Floats


def cases_of(question: Question) -> list[Case]:
    """Every case of a plan, in the order of its burns; in inertial axes where the question is about the true Earth."""
    plan, errors, failures = question.plan, question.errors, question.failures
    n, times = plan.mean_motion, [burn.time for burn in plan.burns]
    planned = question.before()
    out: list[Case] = []
    state = StateSet(planned[0])
    state.navigation(errors)
    still, share, angle = (0.0, 0.0), errors.thrust_share, errors.thrust_angle
    begun = state.copy()
    if question.earth is not None:
        begun.moved(lift_of(target_before(question, 0)))
    out.append(begun.case("start", -1, times[0], duration_of(question, "start", -1, 0.0), still))
    for k, burn in enumerate(plan.burns):
        if k:
            state.moved(transition_matrix(n, times[k] - times[k - 1]))
        if errors.at_each_burn:
            state = StateSet(planned[k])
            state.navigation(errors)
        if burn.duration > 0.0:
            if question.earth is not None:
                state.moved(lift_of(target_before(question, k)))
            state, found = finite_cases(question, k, state)
            out += found
            continue
        before = state.copy()
        add_burn(state, burn, k, 1.0 - share, 1.0 + share, angle)
        made = [("made", state.copy())]
        if failures.partial:
            made.append(("partial", before.copy()))
            add_burn(made[-1][1], burn, k, 0.0, 1.0 + share, angle)
        if failures.misdirected > 0.0:
            made.append(("misdirected", before.copy()))
            wide = min(angle + failures.misdirected, math.pi)
            add_burn(made[-1][1], burn, k, 1.0 - share, 1.0 + share, wide)
        if question.earth is not None:
            lift = lift_of(target_before(question, k))
            for reached in (before, *(reached for _, reached in made)):
                reached.moved(lift)
        for kind, reached in made:
            out.append(reached.case(kind, k, times[k], duration_of(question, kind, k, 0.0), still))
        if question.earth is not None:
            out += late_and_stuck(question, k, before, made[0][1])
            continue
        for first, last in pieces(failures.late, 2.0 * n * burn.size):
            late = before.copy()
            _late(late, burn, k, n, (first, last), errors.thrust_share, errors.thrust_angle)
            out.append(late.case("late", k, times[k], duration_of(question, "late", k, last), (first, last)))
        for first, last in pieces(failures.stuck, failures.acceleration):
            stuck = state.copy()
            _stuck(stuck, burn, k, n, (first, last), question)
            out.append(
                stuck.case("stuck", k, times[k], duration_of(question, "stuck", k, last), (first, last))
            )
    return out


def drifted(size: float, seconds: float, n: float, longest: float) -> Floats:
    """Half-widths (6,) of the change of the equivalent state by a velocity of ``size`` m/s within ``seconds``.

    For phases up to p = n ``longest`` <= 0.5: |d/dt Phi(-t) (0, v)| is at most (1 + 2 p) |v| in each position and
    (2 + 4 p) n |v| in each velocity.
    """
    p = n * longest
    return size * seconds * np.repeat([1.0 + 2.0 * p, n * (2.0 + 4.0 * p)], 3)


def _late(
    state: StateSet, burn: Burn, k: int, n: float, piece: tuple[float, float], share: float, angle: float
) -> None:
    """The burn comes ``piece`` s late: Phi(-t) (0, v) at the time that was planned, tangent and bend."""
    middle, half = 0.5 * (piece[0] + piece[1]), 0.5 * (piece[1] - piece[0])
    back = transition_matrix(n, -middle)
    add_burn(state, burn, k, 1.0 - share, 1.0 + share, angle, back)
    v = np.array(burn.impulse) * shell(1.0 - share, 1.0 + share, angle)[0]
    first, second, third = _derivatives(n, v)
    state.block([half * (back @ first)], "piece", k)
    # The second derivative has no secular part: P cos n t + Q sin n t.
    bend = np.hypot(second, third / n) * 0.5 * half * half
    loose = burn.size * float(np.hypot(*shell(1.0 - share, 1.0 + share, angle)[1:]))
    state.box(bend + drifted(loose, half, n, piece[1]), "bend")


def _derivatives(n: float, v: Floats) -> tuple[Floats, Floats, Floats]:
    """First to third derivative of Phi(-t) (0, v) at t = 0: (-A)^m (0, v)."""
    a = -np.array(
        [
            [0, 0, 0, 1, 0, 0],
            [0, 0, 0, 0, 1, 0],
            [0, 0, 0, 0, 0, 1],
            [3 * n * n, 0, 0, 0, 2 * n, 0],
            [0, 0, 0, -2 * n, 0, 0],
            [0, 0, -n * n, 0, 0, 0],
        ]
    )
    first = a @ np.concatenate([np.zeros(3), v])
    second = a @ first
    return first, second, a @ second


def _stuck(
    state: StateSet, burn: Burn, k: int, n: float, piece: tuple[float, float], question: Question
) -> None:
    """After the burn the thrust goes on for ``piece`` s: int_0^s Phi(-t) (0, a) dt, tangent, bend, errors of thrust."""
    acceleration, errors = question.failures.acceleration, question.errors
    share, angle = errors.thrust_share, errors.thrust_angle
    middle, half = 0.5 * (piece[0] + piece[1]), 0.5 * (piece[1] - piece[0])
    along, _, _ = frame(np.array(burn.impulse))
    centre, within, across = shell(1.0 - share, 1.0 + share, angle)
    push = centre * acceleration * along
    state.centre = state.centre - input_matrix(n, -middle) @ push
    state.block([half * (transition_matrix(n, -middle)[:, 3:] @ push)], "piece", k)
    state.box(drifted(centre * acceleration, 0.5 * half * half, n, piece[1]), "bend")
    # The continuing thrust has the burn's errors; here they are taken as independent.
    loose = acceleration * float(np.hypot(within, across))
    state.box(
        np.concatenate([np.zeros(3), np.full(3, loose * piece[1])])
        + drifted(loose, piece[1] ** 2, n, piece[1]),
        "loose",
    )
