"""Predictions against flights that are integrated step by step, for steady, varying and tilted motions."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from safestart.dynamics.cwh import Cwh
from safestart.dynamics.motion import RelativeMotion
from safestart.errors import InvalidInput
from safestart.optim.prediction import held_through, prediction_of, responses
from tests.unit.optim.motions import Tilted, TwoOrbits, integrate

DT, STEPS, BEGIN = 7.0, 5, 3.0
"""The orbit of :class:`TwoOrbits` changes within the last interval."""

CASES = [
    (Cwh(0.0), 2),
    (Cwh(1.1e-3), 2),
    (Cwh(1.1e-3), 3),
    (TwoOrbits(), 2),
    (TwoOrbits(), 3),
    (Tilted(), 3),
]
cases = pytest.mark.parametrize(("motion", "d"), CASES)


def flown(d: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(d)
    return np.r_[30.0 * rng.normal(size=d), rng.normal(size=d)], 0.1 * rng.normal(size=(STEPS, d))


@cases
def test_states_at_nodes_and_between(motion: RelativeMotion, d: int) -> None:
    state, thrust = flown(d)
    prediction = prediction_of(motion, DT, STEPS, d, 3, BEGIN)
    states = prediction.flight(state, thrust)
    assert states.shape == (STEPS, 4, 2 * d)
    times = DT * (np.arange(STEPS)[:, None] + np.arange(4) / 3)
    expected = integrate(motion, DT, BEGIN, state, thrust, times.ravel())
    np.testing.assert_allclose(states.reshape(-1, 2 * d), expected, rtol=1e-10, atol=1e-10)
    # One interval's last state is the next one's first.
    np.testing.assert_allclose(states[:-1, -1], states[1:, 0], rtol=1e-12, atol=1e-12)


@cases
def test_rows_at_any_time(motion: RelativeMotion, d: int) -> None:
    state, thrust = flown(d)
    prediction = prediction_of(motion, DT, STEPS, d, 1, BEGIN)
    rng = np.random.default_rng(9)
    times = np.r_[0.0, DT, 2.5 * DT, STEPS * DT, rng.uniform(0.0, STEPS * DT, 6)]
    states = integrate(motion, DT, BEGIN, state, thrust, times)
    directions = rng.normal(size=(len(times), d))
    start, push = prediction.position_rows(times, directions)
    assert push.shape == (len(times), STEPS * d)
    wanted = (directions * states[:, :d]).sum(axis=1)
    np.testing.assert_allclose(start @ state + push @ thrust.ravel(), wanted, rtol=1e-10, atol=1e-10)
    for time, x in zip(times.tolist(), states, strict=True):
        matrix = rng.normal(size=(3, 2 * d))
        start, push = prediction.state_rows(time, matrix)
        np.testing.assert_allclose(start @ state + push @ thrust.ravel(), matrix @ x, rtol=1e-9, atol=1e-9)
        # Nothing that is held later counts.
        after = d * (int(time / DT) + 1)
        assert not push[:, after:].any()


@cases
def test_no_rows(motion: RelativeMotion, d: int) -> None:
    start, push = prediction_of(motion, DT, STEPS, d, 1).position_rows(np.empty(0), np.empty((0, d)))
    assert (start.shape, push.shape) == ((0, 2 * d), (0, STEPS * d))


def test_any_polyhedron_that_turns_with_any_attitude() -> None:
    """Distances to six faces of a box that tumbles about a moving axis: the rows need its turned normals alone."""
    state, thrust = flown(3)
    times = np.linspace(0.0, STEPS * DT, 8)
    axes = np.stack([np.sin(0.1 * times), np.cos(0.1 * times), 0.3 + 0.0 * times], axis=1)
    turns = Rotation.from_rotvec(0.05 * times[:, None] * axes)
    normals, offsets = np.concatenate([np.eye(3), -np.eye(3)]), np.full(6, 200.0)
    prediction = prediction_of(Tilted(), DT, STEPS, 3, 1, BEGIN)
    body = turns.apply(integrate(Tilted(), DT, BEGIN, state, thrust, times)[:, :3])
    for normal, offset in zip(normals, offsets, strict=True):
        # The body sees R p, so the face's normal in the motion's axes is R^T n.
        outward = turns.inv().apply(np.tile(normal, (len(times), 1)))
        start, push = prediction.position_rows(times, -outward)
        distance = offset + start @ state + push @ thrust.ravel()
        np.testing.assert_allclose(distance, offset - body @ normal, rtol=1e-10, atol=1e-9)


@cases
def test_fewer_intervals_are_the_first_ones(motion: RelativeMotion, d: int) -> None:
    state, thrust = flown(d)
    whole = prediction_of(motion, DT, STEPS, d, 2, BEGIN)
    first, made = whole.until(3), prediction_of(motion, DT, 3, d, 2, BEGIN)
    assert (first.steps, first.dimensions) == (3, d)
    np.testing.assert_array_equal(first.flight(state, thrust[:3]), made.flight(state, thrust[:3]))
    np.testing.assert_allclose(
        first.flight(state, thrust[:3]), whole.flight(state, thrust)[:3], rtol=1e-13, atol=1e-13
    )


def test_only_a_varying_motion_knows_when_it_begins() -> None:
    state, thrust = flown(2)
    early, late = (prediction_of(Cwh(1.1e-3), DT, STEPS, 2, 1, begin) for begin in (0.0, 1000.0))
    assert early.driven is late.driven
    early, late = (prediction_of(TwoOrbits(), DT, STEPS, 2, 1, begin) for begin in (0.0, BEGIN))
    apart = early.flight(state, thrust) - late.flight(state, thrust)
    assert np.abs(apart).max() > 1e-3


def test_a_plane_that_does_not_keep_to_itself_is_refused() -> None:
    with pytest.raises(InvalidInput, match="couples the plane"):
        prediction_of(Tilted(), DT, STEPS, 2, 1)


@pytest.mark.parametrize("motion", [Cwh(1.1e-3), TwoOrbits(), Tilted()])
def test_one_thrust_held_all_the_way(motion: RelativeMotion) -> None:
    state, thrust = flown(3)
    ends = np.array([4.0, 17.0, 40.0])
    phi, push = held_through(motion, BEGIN, BEGIN + ends)
    for k, end in enumerate(ends.tolist()):
        (expected,) = integrate(motion, end, BEGIN, state, thrust[:1], ends[k : k + 1])
        np.testing.assert_allclose(phi[k] @ state + push[k] @ thrust[0], expected, rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize("steps", [1, 2, 5, 6, 33])
@pytest.mark.parametrize("d", [2, 3])
def test_responses_are_powers_taken_one_by_one(steps: int, d: int) -> None:
    motion = Cwh(1.1e-3)
    starts = np.concatenate([np.eye(d), 0.1 * np.eye(d)])
    free, pushed = responses(motion, DT, steps, starts)
    assert (free.shape, pushed.shape) == ((steps + 1, 2 * d, d), (steps + 1, 2 * d, d))
    keep = np.r_[0:d, 3 : 3 + d]
    step = motion.transition(0.0, DT)[np.ix_(keep, keep)]
    left, right = starts, motion.held(0.0, DT)[keep, :d]
    for k in range(steps + 1):
        np.testing.assert_allclose(free[k], left, rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(pushed[k], right, rtol=1e-12, atol=1e-12)
        left, right = step @ left, step @ right


@pytest.mark.parametrize("steps", [3, 8])
def test_responses_sum_to_the_flight(steps: int) -> None:
    rng = np.random.default_rng(2)
    thrust, position = 0.1 * rng.normal(size=(steps, 2)), rng.normal(size=2)
    free, pushed = responses(Cwh(1.1e-3), DT, steps, np.concatenate([np.eye(2), np.zeros((2, 2))]))
    expected = integrate(Cwh(1.1e-3), DT, 0.0, np.r_[position, 0.0, 0.0], thrust, np.array([steps * DT]))[0]
    state = free[steps] @ position + sum(pushed[steps - 1 - j] @ thrust[j] for j in range(steps))
    np.testing.assert_allclose(state, expected, rtol=1e-10, atol=1e-10)
