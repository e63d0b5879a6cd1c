"""The tube against brute force: invariance, tightness, and thousands of disturbed flights in closed loop."""

import math
from itertools import pairwise

import numpy as np
import pytest

from safestart.constraints.corridor import corridor_of
from safestart.disturbance.ancillary import _push, reach_of
from safestart.disturbance.tube import Disturbance, decide_disturbed, tube_of
from safestart.dynamics.cwh import input_matrix, planar_input, planar_transition, transition_matrix
from safestart.errors import InvalidInput
from safestart.exact.answer import Verdict
from safestart.exact.decide import decide
from safestart.exact.question import Goal, Question
from safestart.model.scenario import Chaser, CorridorShape, Floats, Scenario, Target
from safestart.sets.invariant import Invariant, Push

N, DT, SUB = 1.1e-3, 2.0, 8
W = 4e-3
KEEP = {2: [0, 1, 3, 4], 3: list(range(6))}


def _closed_loop(dt: float = DT, settle: float = 5.0) -> Floats:
    reach = reach_of(N, dt, settle, "plane")
    assert reach is not None
    out: Floats = planar_transition(N, dt) + planar_input(N, dt) @ reach.gain
    return out


def _invariant(dt: float = DT) -> Invariant:
    found = Invariant.of(_closed_loop(dt, 2.5 * dt), _push(N, dt, "plane"))
    assert found is not None
    return found


def _directions(count: int) -> Floats:
    return np.random.default_rng(3).normal(size=(count, 4)) * [1.0, 1.0, 3.0, 3.0]


def test_the_scalar_set_is_known() -> None:
    """e+ = e / 2 + w with |w| <= 1: the minimal invariant set is [-2, 2]."""
    push = Push(np.ones((2, 1, 1)), 1.0, np.zeros(1))
    found = Invariant.of(np.array([[0.5]]), push)
    assert found is not None
    assert 2.0 <= found.support(np.ones((1, 1)))[0] <= 2.0 + 1e-5
    assert Invariant.of(np.array([[1.0]]), push) is None


@pytest.mark.parametrize("dt", [0.5, 2.0, 30.0])
def test_the_outer_set_is_invariant(dt: float) -> None:
    """F S + W is inside S: sigma_S(F' d) + sigma_W(d) <= sigma_S(d) in every direction."""
    found, directions = _invariant(dt), _directions(500)
    after = found.support(directions @ found.closed_loop) + found.push.support(directions)
    assert (after <= found.support(directions) * (1.0 + 1e-9)).all()


def test_it_exceeds_the_minimal_set_by_epsilon_only() -> None:
    found, directions = _invariant(), _directions(50)
    # A sum of finitely many terms is inside the minimal set; its supports by the midpoint rule, far finer.
    times = DT * (np.arange(400) + 0.5) / 400
    columns = np.array([planar_transition(N, t)[:, 2:] for t in times])
    least, moved = np.zeros(len(directions)), directions
    for _ in range(200):
        least += np.linalg.norm(np.einsum("kn,qnm->kqm", moved, columns), axis=-1).sum(axis=1) * DT / 400
        moved = moved @ found.closed_loop
    room = found.support(directions) - least
    assert (room >= -1e-7 * least).all()
    # The trapezoid rule's excess is the larger part; epsilon alone is microns.
    assert found.epsilon < 1e-4
    assert (room <= 4e-3 * least + found.epsilon * np.linalg.norm(directions, axis=1)).all()


def _fly(question: Question, gain: Floats, start: Floats, w: Floats) -> tuple[Floats, Floats]:
    """Errors (N, SUB + 1, F, 2 d) and feedback (N, F, d) of F flights, w (N, SUB, F, d) held over sub-steps."""
    d = question.dimensions
    rate = question.scenario.target.mean_motion
    step = question.dt / SUB
    keep = KEEP[d]
    phi = transition_matrix(rate, step)[np.ix_(keep, keep)].T
    held = input_matrix(rate, step)[keep, :d].T
    error, path, feedback = start, [], []
    for k in range(question.steps):
        u = error @ gain.T
        feedback.append(u)
        inside = [error]
        for s in range(SUB):
            inside.append(inside[-1] @ phi + (u + w[k, s]) @ held)
        path.append(inside)
        error = inside[-1]
    return np.array(path), np.array(feedback)


def _disturbances(question: Question, gain: Floats, flights: int) -> Floats:
    """Random, constant, bang-bang and worst-direction histories of the unit ball, (N, SUB, F, d)."""
    rng = np.random.default_rng(11)
    d, steps = question.dimensions, question.steps
    shape = (steps, SUB, flights, d)
    w = rng.normal(size=shape)
    w /= np.linalg.norm(w, axis=-1, keepdims=True)
    third = flights // 3
    # Bang-bang: one axis, switching at random sub-steps.
    switch = np.cumprod(np.where(rng.random((steps * SUB, third)) < 0.04, -1.0, 1.0), axis=0)
    axis = rng.normal(size=(third, d))
    axis /= np.linalg.norm(axis, axis=1, keepdims=True)
    w[:, :, :third] = (switch[:, :, None] * axis).reshape(steps, SUB, third, d)
    # Worst direction: drives the last node's error farthest along a random functional of the state.
    keep, rate = KEEP[d], question.scenario.target.mean_motion
    motion = transition_matrix(rate, question.dt)[np.ix_(keep, keep)]
    closed = motion + input_matrix(rate, question.dt)[keep, :d] @ gain
    pull = np.zeros((third, 2 * d))
    pull[:, :d] = rng.normal(size=(third, d))
    pull[::2] = rng.normal(size=(len(pull[::2]), d)) @ gain
    for k in reversed(range(steps)):
        for s in range(SUB):
            late = transition_matrix(rate, question.dt * (1.0 - (s + 0.5) / SUB))[np.ix_(keep, keep)]
            aim = pull @ late[:, d:]
            w[k, s, third : 2 * third] = aim / np.linalg.norm(aim, axis=1, keepdims=True)
        pull = pull @ closed
    return w


def _ball(count: int, d: int, radius: float) -> Floats:
    found = np.random.default_rng(5).normal(size=(count, d))
    return radius * found / np.linalg.norm(found, axis=1, keepdims=True)


@pytest.mark.parametrize("dimensions", [2, 3])
@pytest.mark.parametrize("dispersed", [False, True])
def test_no_disturbance_leaves_the_tube(dimensions: int, dispersed: bool) -> None:
    question = Question(Scenario.of(3.0, 0.1), DT, 30, dimensions)
    bound = Disturbance(W, 0.4, 0.03) if dispersed else Disturbance(W)
    tube = tube_of(question, bound)
    flights = 1500
    start = np.hstack([_ball(flights, dimensions, r) for r in (bound.position, bound.velocity)])
    w = W * _disturbances(question, tube.gain, flights)
    path, feedback = _fly(question, tube.gain, start, w)
    furthest = np.linalg.norm(path[..., :2], axis=-1).max()
    assert furthest <= tube.radius
    strongest = np.linalg.norm(feedback, axis=-1).max()
    assert strongest <= tube.thrust
    if dimensions == 3:
        assert np.abs(path[..., 2]).max() <= tube.height
    if not dispersed and dimensions == 2:
        # The bounds are not idle: the worst flights come within 3 %.
        assert furthest >= 0.97 * tube.radius
        assert strongest >= 0.97 * tube.thrust


@pytest.mark.parametrize(
    ("rate", "thrust", "position"),
    [(3.0, 0.1, (5.0, 40.0)), (1.0, 0.05, (-30.0, 60.0)), (2.0, 0.05, (14.0, 55.0))],
)
def test_a_go_holds_against_every_disturbance_tried(
    rate: float, thrust: float, position: tuple[float, float]
) -> None:
    """Thousands of disturbed flights of the plan: in the corridor at every sub-step, never more than full thrust."""
    question = Question(Scenario.of(rate, thrust))
    state = np.array([*position, 0.0, 0.0])
    answer = decide_disturbed(question, state, Disturbance(W))
    assert answer.verdict is Verdict.GO
    assert answer.thrust is not None
    tube = tube_of(question, Disturbance(W))
    flights = 1500
    w = W * _disturbances(question, tube.gain, flights)
    errors, feedback = _fly(question, tube.gain, np.zeros((flights, 4)), w)
    commanded = np.linalg.norm(answer.thrust[:, None, :] + feedback, axis=-1)
    assert commanded.max() <= thrust
    step = DT / SUB
    state_now, least = state, math.inf
    corridor = corridor_of(question.scenario.corridor)
    for k in range(question.steps):
        for s in range(SUB + 1):
            planned = (
                planar_transition(N, s * step) @ state_now + planar_input(N, s * step) @ answer.thrust[k]
            )
            at = planned[:2] + errors[k, s, :, :2]
            angle = math.radians(rate) * (k * DT + s * step)
            body = at @ np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
            least = min(least, float((corridor.slack(body) / corridor.lengths).min()))
        state_now = planar_transition(N, DT) @ state_now + planar_input(N, DT) @ answer.thrust[k]
    assert least >= answer.lower


def test_without_disturbance_it_is_the_exact_answer() -> None:
    question, state = Question(Scenario.of(3.0, 0.1)), np.array([5.0, 40.0, 0.0, 0.0])
    exact, disturbed = decide(question, state), decide_disturbed(question, state, Disturbance(0.0))
    assert disturbed.verdict is exact.verdict is Verdict.GO
    assert disturbed.lower == pytest.approx(exact.lower, abs=1e-4)


def test_more_disturbance_never_helps() -> None:
    question, state = Question(Scenario.of(3.0, 0.1)), np.array([5.0, 40.0, 0.0, 0.0])
    margins = [decide_disturbed(question, state, Disturbance(w)).lower for w in (0.0, 1e-3, 5e-3, 2e-2)]
    assert all(a > b for a, b in pairwise(margins))


@pytest.mark.parametrize("w", [0.07, 0.1, 1.0])
def test_nothing_left_is_never_a_go(w: float) -> None:
    question = Question(Scenario.of(3.0, 0.1))
    tube = tube_of(question, Disturbance(w))
    assert tube.question is None
    assert "m/s^2" in tube.reason
    answer = decide_disturbed(question, np.array([5.0, 40.0, 0.0, 0.0]), Disturbance(w))
    assert answer.verdict is Verdict.UNDECIDED
    assert answer.thrust is None
    assert answer.reason == tube.reason


def test_a_no_go_without_disturbance_is_proved_with_it() -> None:
    answer = decide_disturbed(
        Question(Scenario.of(2.0, 0.05)), np.array([9.364, 81.044, 0.0, 0.0]), Disturbance(W)
    )
    assert answer.verdict is Verdict.NO_GO
    assert answer.upper == pytest.approx(-1.194, abs=1e-3)
    assert answer.multipliers


@pytest.mark.parametrize("dimensions", [2, 3])
@pytest.mark.parametrize(
    "shape", [CorridorShape(), CorridorShape(1.5, 0.7, 0.0, 2.0, 0.5), CorridorShape(0.2, 3.0, 0.3, 0.1, 0.0)]
)
def test_every_face_moves_in_by_the_tube(dimensions: int, shape: CorridorShape) -> None:
    """A point of the tightened corridor keeps its place in the real one when moved by any error of the tube."""
    scenario = Scenario(Target(0.05, N), Chaser(0.1), shape)
    tube = tube_of(Question(scenario, dimensions=dimensions), Disturbance(0.01))
    assert tube.question is not None
    rng = np.random.default_rng(1)
    tight, real = (corridor_of(s.corridor, dimensions) for s in (tube.question.scenario, scenario))
    points = rng.uniform([-20.0, 0.0, -20.0], [20.0, 30.0, 20.0], (200_000, 3))[:, :dimensions]
    inside = points[tight.contains(points)]
    assert len(inside) > 1000
    moved = inside.copy()
    angle = rng.uniform(0.0, 2.0 * np.pi, len(inside))
    moved[:, :2] += tube.radius * np.column_stack([np.cos(angle), np.sin(angle)])
    if dimensions == 3:
        moved[:, 2] += tube.height * rng.choice([-1.0, 1.0], len(inside))
    assert (real.slack(moved) >= -1e-9).all()
    # And not by more: somewhere a face is touched.
    assert real.slack(moved).min() <= 0.3


def test_bad_tubes() -> None:
    question = Question(Scenario.of(3.0, 0.1))
    for values in ((-1.0, 0.0, 0.0), (math.nan, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, math.inf)):
        with pytest.raises(InvalidInput):
            Disturbance(*values)
    with pytest.raises(InvalidInput):
        tube_of(question, Disturbance(W), settle=1.0)
    for other in (Question(question.scenario, goal=Goal()), Question(question.scenario, speed_limit=1.0)):
        with pytest.raises(InvalidInput, match="stay"):
            tube_of(other, Disturbance(W))
    with pytest.raises(InvalidInput):
        tube_of(Question(Scenario.of(3.0, 0.1), 100.0, 3), Disturbance(W))
