"""The exact question in space against dense linear programs, an integrator, symmetries and the old answers."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from benchmarks.peers.space_cases import dense_margin, drawn
from safestart.attitude.spin import Spin
from safestart.attitude.table import Table
from safestart.constraints.thrust_limit import ThrustLimit, ball
from safestart.errors import InvalidInput
from safestart.exact.answer import Answer, Verdict
from safestart.exact.decide import decide
from safestart.exact.question import Question
from safestart.exact.space.decide import decide_in_space
from safestart.exact.space.question import Face, SpaceQuestion, five_faces
from safestart.exact.space.watch import space_watch_of
from safestart.model.orbit import KeplerOrbit
from safestart.model.scenario import CorridorShape, Scenario

CORRIDOR = five_faces(CorridorShape())
PARTS = {"orbit": KeplerOrbit(1.1e-3), "attitude": Spin(0.04), "faces": CORRIDOR, "thrust": ball(0.05)}


def assert_refused(changes: dict[str, object], field: str) -> None:
    """A question with these changes is refused under the name of the field."""
    with pytest.raises(InvalidInput) as refused:
        SpaceQuestion(**(PARTS | changes))
    assert refused.value.field == field


@pytest.mark.parametrize("seed", range(24))
def test_agrees_with_a_dense_linear_program(seed: int) -> None:
    """Checked at some times only, the program's margin is a bit above ours; by what fits between two checks."""
    question, state = drawn(seed)
    answer = decide_in_space(question, state)
    inside, *more = dense_margin(question, state)
    outside = more[0] if more else inside
    assert answer.verdict is not Verdict.UNDECIDED
    assert answer.lower <= outside + 1e-6
    assert answer.upper >= inside - 5e-3
    if abs(inside) > 0.05 and abs(outside) > 0.05:
        assert (answer.verdict is Verdict.GO) == (inside > 0.0)


def flown(question: SpaceQuestion, state: np.ndarray, answer: Answer, times: np.ndarray) -> np.ndarray:
    """Positions (T, 3) at times within the first steps, by an integrator of thrust and motion."""
    orbit = question.orbit
    watch = space_watch_of(question)
    u = watch.accelerations(answer.thrust)
    e, n = orbit.eccentricity, orbit.mean_motion
    pace = n / (1.0 - e * e) ** 1.5
    out = []
    y = np.concatenate([[orbit.true_anomaly], state])
    for k in range(question.steps):
        begin, end = k * question.dt, (k + 1) * question.dt

        def rates(_: float, y: np.ndarray, push: np.ndarray = u[k]) -> np.ndarray:
            rho = 1.0 + e * math.cos(y[0])
            w, g = pace * rho * rho, pace**2 * rho**3
            change = -2.0 * pace * e * math.sin(y[0]) * rho * w
            r, v = y[1:4], y[4:]
            a = np.array(
                [
                    2.0 * w * v[1] + change * r[1] + (w * w + 2.0 * g) * r[0],
                    -2.0 * w * v[0] - change * r[0] + (w * w - g) * r[1],
                    -g * r[2],
                ]
            )
            return np.concatenate([[w], v, a + push])

        inside = times[(times >= begin) & (times < end)]
        found = solve_ivp(rates, (begin, end), y, "DOP853", np.append(inside, end), rtol=1e-12, atol=1e-12)
        out.append(found.y[1:4, :-1].T)
        y = found.y[:, -1]
    return np.concatenate(out)


@pytest.mark.parametrize("seed", [3, 5, 6, 7, 8, 9, 10, 11, 12, 13])
def test_witnesses_keep_their_margin_at_all_times(seed: int) -> None:
    question, state = drawn(seed)
    answer = decide_in_space(question, state)
    if answer.verdict is not Verdict.GO:
        pytest.skip("no witness")
    times = np.linspace(0.0, question.horizon, 40 * question.steps, endpoint=False)
    path, turn = flown(question, state, answer, times), question.attitude.rotation(times)
    body = np.einsum("tij,tj->ti", turn, path)
    for face in question.faces:
        seen = body if face.frame == "body" else path
        normal = np.array(face.normal)
        distance = (face.offset - seen @ normal) / np.linalg.norm(normal)
        assert distance.min() >= answer.lower - 1e-5


@pytest.mark.parametrize(("rate", "y"), [(1.5, 30.0), (3.0, 60.0), (3.0, 25.0), (0.0, 10.0)])
def test_a_spin_about_the_normal_is_the_old_question(rate: float, y: float) -> None:
    scenario = Scenario.of(rate, 0.05)
    state = np.array([1.0, y, 0.5, 0.0, 0.0, 0.0])
    old = decide(Question(scenario, dimensions=3), state)
    new = SpaceQuestion(KeplerOrbit(1.1e-3), Spin(math.radians(rate)), CORRIDOR, ball(0.05))
    found = decide_in_space(new, state)
    assert found.verdict is old.verdict
    assert found.lower <= old.upper + 1e-9
    assert old.lower <= found.upper + 1e-9
    elliptic = decide_in_space(
        SpaceQuestion(KeplerOrbit(1.1e-3, 1e-12), Spin(math.radians(rate)), CORRIDOR, ball(0.05)), state
    )
    assert elliptic.lower <= old.upper + 1e-6
    assert old.lower <= elliptic.upper + 1e-6


def margins(question: SpaceQuestion, state: np.ndarray) -> Answer:
    return decide_in_space(question, state, tolerance=1e-6)


def test_reversed_spin_mirrors_without_an_orbit() -> None:
    mirror = np.array([-1.0, 1.0, 1.0])
    state = np.array([3.0, 25.0, 1.0, 0.1, -0.05, 0.02])
    for n, same in ((0.0, True), (1.1e-3, False)):
        there = margins(SpaceQuestion(KeplerOrbit(n), Spin(0.04), CORRIDOR, ball(0.05)), state)
        back = margins(
            SpaceQuestion(KeplerOrbit(n), Spin(-0.04), CORRIDOR, ball(0.05)), state * np.tile(mirror, 2)
        )
        assert (abs(there.lower - back.lower) < 2e-6) is same


def test_a_scenario_turned_about_z_keeps_its_margin_without_an_orbit() -> None:
    angle = 0.7
    turn = np.array(
        [[math.cos(angle), -math.sin(angle), 0.0], [math.sin(angle), math.cos(angle), 0.0], [0, 0, 1.0]]
    )
    state = np.array([3.0, 25.0, 1.0, 0.1, -0.05, 0.02])
    axis = np.array([0.2, 0.1, 0.9])
    found = []
    for m in (np.eye(3), turn):
        faces = tuple(
            Face(f.name, tuple((m @ np.array(f.normal)).tolist()), f.offset, f.frame) for f in CORRIDOR
        )
        question = SpaceQuestion(KeplerOrbit(0.0), Spin(0.04, tuple((m @ axis).tolist())), faces, ball(0.05))
        found.append(margins(question, np.concatenate([m @ state[:3], m @ state[3:]])))
    assert abs(found[0].lower - found[1].lower) < 2e-6
    assert abs(found[0].upper - found[1].upper) < 2e-6


def test_a_box_holds_its_ball_and_lies_in_another() -> None:
    state = np.array([3.0, 25.0, 1.0, 0.1, -0.25, 0.02])
    attitude = Spin(0.04, (0.3, 0.1, 0.9))
    limits = [ball(0.04), ThrustLimit("box", (0.04,) * 3), ball(0.04 * math.sqrt(3.0))]
    found = [margins(SpaceQuestion(KeplerOrbit(1.1e-3), attitude, CORRIDOR, e), state) for e in limits]
    assert found[0].lower < found[1].upper
    assert found[1].lower < found[2].upper
    arms = np.concatenate([np.eye(3), -np.eye(3)])
    hull = ThrustLimit("thrusters", (0.04,) * 6, tuple(map(tuple, arms.tolist())))
    assert margins(SpaceQuestion(KeplerOrbit(1.1e-3), attitude, CORRIDOR, hull), state).lower < found[0].upper


def test_a_start_outside_is_refused_a_go_at_once() -> None:
    question = SpaceQuestion(KeplerOrbit(1.1e-3), Spin(0.04, (0.3, 0.1, 0.9), 0.5), CORRIDOR, ball(0.05))
    answer = decide_in_space(question, np.array([0.0, -5.0, 0.0, 0.0, 0.0, 0.0]))
    assert answer.verdict is Verdict.NO_GO
    assert answer.iterations == 0


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"faces": ()}, "faces"),
        ({"faces": (*CORRIDOR, CORRIDOR[0])}, "faces"),
        ({"faces": (*CORRIDOR, Face("back", (0.0, 1.0, 0.0), -1.0))}, "faces"),
        ({"faces": (Face("none", (0.0, 0.0, 0.0), 1.0),)}, "faces.0.normal"),
        ({"faces": tuple(Face(str(k), (1.0, 0.0, 0.0), 1.0) for k in range(33))}, "faces"),
        ({"attitude": Table((0.0, 30.0), ((1, 0, 0, 0), (1, 0, 0, 0)))}, "times"),
        ({"steps": 0}, "steps"),
    ],
)
def test_what_is_no_question_is_refused(changes: dict, field: str) -> None:
    assert_refused(changes, field)


@pytest.mark.parametrize(
    ("limit", "field"),
    [
        (("thrusters", (0.1, 0.1, 0.1), ((1, 0, 0), (0, 1, 0), (1, 1, 0))), "directions"),
        (("thrusters", (0.1,), ((1, 0, 0), (0, 1, 0))), "a_max"),
        (("thrusters", (0.1, 0.1, 0.1), ((1, 0, 0), (0, 1, 0), (0, 0, 0))), "directions"),
        (("box", (0.0, 0.0, 0.0)), "a_max"),
        (("ball", (11.0,)), "a_max"),
    ],
)
def test_what_is_no_set_of_thrusts_is_refused(limit: tuple, field: str) -> None:
    with pytest.raises(InvalidInput) as refused:
        ThrustLimit(*limit)
    assert refused.value.field == field
