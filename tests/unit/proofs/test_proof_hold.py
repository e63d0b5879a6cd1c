"""The hold after the end of `synchronize`: proved for many ends, and every claim beyond its evidence is rejected."""

from __future__ import annotations

import copy
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from safestart.exact.answer import Answer, Verdict
from safestart.exact.decide import decide
from safestart.exact.hold_after import held_after, with_hold
from safestart.exact.prove import proof_of
from safestart.exact.question import Goal, Question
from safestart.model.scenario import Chaser, CorridorShape, Floats, Scenario, Target
from safestart.proofs.checker import check
from safestart.proofs.strict import ProofRejected
from tests.unit.proofs.forgery import Document, assert_all_is_read, changed, places, sealed
from tests.unit.proofs.holding import QUESTION, SHAPE, START, made, steps


@pytest.fixture(scope="module")
def document() -> Document:
    return made(QUESTION, START)


def test_the_checker_proves_it_and_says_all_of_it(document: Document) -> None:
    claim = document["hold_after"]
    said = " ".join(line for line in check(document).statement if "x_ref" in line)
    rows = claim["gain"] + claim["cost"]
    for number in [claim["level"], claim["margin_m"], *claim["point_m"], *(e for row in rows for e in row)]:
        assert repr(number) in said
    assert "for ever" in said
    assert "the limits of thrust and speed" in said


def test_without_it_nothing_is_said_for_ever(document: Document) -> None:
    bare = {key: value for key, value in document.items() if key not in ("hold_after", "arrival")}
    assert not any("for ever" in line for line in check(sealed(bare)).statement)
    stay = replace(QUESTION, goal=None)
    assert not any("for ever" in line for line in check(proof_of(stay, START, decide(stay, START))).statement)


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("level", lambda v: 4.0 * v, "margin_m|a_max|speed"),
        ("level", lambda v: 1e-6 * v, "error's cost at the end"),
        ("level", lambda v: 0.0, "level"),
        ("level", lambda v: -v, "level"),
        ("margin_m", lambda v: v + 0.02, "the distance to"),
        ("margin_m", lambda v: 0.0, "margin_m"),
        ("gain", lambda v: [[0.0] * 4] * 2, "falls with every step"),
        ("gain", lambda v: [[-e for e in row] for row in v], "falls with every step"),
        ("gain", lambda v: [[5.0 * e for e in row] for row in v], "falls with every step|a_max"),
        ("gain", lambda v: v[::-1], "falls with every step"),
        ("gain", lambda v: v[:1], "2 rows"),
        ("gain", lambda v: [row[:3] for row in v], "rows of 4"),
        ("cost", lambda v: [[0.05 * e for e in row] for row in v], "margin_m|a_max|speed"),
        ("cost", lambda v: [[1e6 * e for e in row] for row in v], "error's cost at the end"),
        ("cost", lambda v: [[-e for e in row] for row in v], "positive definite"),
        ("cost", lambda v: np.eye(4).tolist(), "falls with every step"),
        ("cost", lambda v: [[0.0] * 4] * 4, "positive definite"),
        ("cost", lambda v: [[v[0][0], v[0][1] + 1e-3, *v[0][2:]], *v[1:]], "symmetric"),
        ("point_m", lambda v: [v[0] + 1.0, v[1]], "error's cost at the end"),
        ("point_m", lambda v: [v[0], v[1] - 0.5], "hold_plane"),
        ("point_m", lambda v: [*v, 0.0], "list of 2"),
        ("note", lambda v: 1.0, "'note' unknown"),
    ],
)  # fmt: skip
def test_what_claims_more_is_rejected(document: Document, key: str, value: Any, said: str) -> None:
    forged = changed(document, f"hold_after.{key}", value(document["hold_after"].get(key)))
    with pytest.raises(ProofRejected, match=said):
        check(forged)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("question.max_acceleration_m_s2", 0.012),
        ("question.tumble_rate_rad_s", 0.1),
        ("question.speed_limit.most_m_s", 0.15),
        ("question.corridor.x0_m", 0.2),
        ("question.dt_s", 20.0),
        ("start.velocity_m_s", [-0.075, 0.4]),
    ],
)
def test_it_is_about_its_own_question(document: Document, key: str, value: Any) -> None:
    with pytest.raises(ProofRejected):
        check(changed(document, key, value))


def test_every_field_is_read_and_none_is_left_out(document: Document) -> None:
    assert_all_is_read(check, document, without=("arrival", "hold_after", "speed_limit", "keep_out_m"))
    fields = {path[1] for path, _ in places(document) if path[:1] == ("hold_after",) and len(path) > 1}
    assert fields == {"point_m", "gain", "cost", "level", "margin_m"}


@pytest.mark.parametrize("kind", ["stay", "space", "no-go"])
def test_only_a_go_of_synchronize_in_the_plane_may_have_it(document: Document, kind: str) -> None:
    if kind == "stay":
        question, start = replace(QUESTION, goal=None), START
    elif kind == "space":
        question = replace(QUESTION, dimensions=3, goal=Goal(0.5, 0.05, (0.0, 1.5, 0.0)))
        start = np.array([0.1, 1.5, 0.0, -0.075, 0.065, 0.0])
    else:
        question, start = QUESTION, np.array([0.3, 20.0, 0.0, -0.1])
    other = proof_of(question, start, decide(question, start))
    assert (other["verdict"] == "NO_GO") is (kind == "no-go")
    forged = copy.deepcopy(other) | {"hold_after": document["hold_after"]}
    with pytest.raises(ProofRejected, match="hold_after"):
        check(sealed(forged))


def drawn(seed: int) -> tuple[Question, Floats] | None:
    """A question of one step in which thrust can do next to nothing, and an end near its reference."""
    rng = np.random.default_rng(seed)
    rate, n = float(rng.choice([0.0, 0.01, 0.05, 0.2])), float(rng.choice([0.0, 1.1e-3]))
    a_max, dt = float(10.0 ** rng.uniform(-3.0, 0.0)), float(rng.choice([0.5, 2.0, 3.0]))
    shape = CorridorShape(float(rng.uniform(0.2, 2.0)), 1.0, float(rng.uniform(0.3, 3.0)), 1.0, 0.5)
    speed = float(rng.choice([0.0, 0.5])) or None
    most = min(20.0, 0.5 * a_max / max((rate + n) ** 2, 1e-9))
    place = np.array([0.0, 0.5 + rng.uniform(0.3, 1.0) * most])
    question = Question(
        Scenario(Target(rate, n), Chaser(a_max), shape), dt, 1, 2, Goal(50.0, 5.0, (0.0, place[1])), speed
    )
    velocity = rng.normal(size=2) * 0.02 + rate * np.array([-place[1], place[0]])
    start = np.r_[place + rng.normal(size=2) * 0.02, velocity]
    answer = decide(question, start)
    return (question, start) if answer.verdict is Verdict.GO else None


def test_what_the_prover_says_the_checker_proves() -> None:
    proved = 0
    for seed in range(80):
        case = drawn(seed)
        if case is None:
            continue
        answer = with_hold(*case, decide(*case))
        if answer.held is not None:
            check(proof_of(*case, answer))
            proved += 1
    assert proved > 30


def test_the_thrust_alone_refuses_a_level(document: Document) -> None:
    """Ten metres from every face and without a speed limit."""
    question = replace(
        QUESTION,
        speed_limit=None,
        goal=Goal(1.0, 0.5, (0.0, 12.0)),
        scenario=Scenario(Target(0.02, 1.1e-3), Chaser(0.02), replace(SHAPE, c_x=2.0)),
    )
    made_far = made(question, np.array([0.0, 12.0, -0.24, 0.0]))
    level = made_far["hold_after"]["level"]
    check(changed(made_far, "hold_after.level", 0.9 * level))
    with pytest.raises(ProofRejected, match="the feedback may take"):
        check(changed(made_far, "hold_after.level", 1.1 * level))


def test_its_cost_is_that_of_scipys_riccati_equation(document: Document) -> None:
    """P - F' P F = Q + K' R K with the weights of the scales, F by a matrix exponential."""
    claim = document["hold_after"]
    a, b = steps(1.1e-3, 2.0)
    gain, cost = np.array(claim["gain"]), np.array(claim["cost"])
    closed = a + b @ gain
    weights = np.diag([1.0, 1.0, 100.0, 100.0]) + gain.T @ gain / 0.02**2
    assert cost - closed.T @ cost @ closed == pytest.approx(weights, rel=1e-6, abs=1e-6)
    assert np.abs(np.linalg.eigvals(closed)).max() < 1.0


def test_where_no_set_holds_the_end_there_is_none() -> None:
    # Standing there takes more than the thrust; the speed at the end takes the chaser over the plane.
    far = replace(QUESTION, scenario=Scenario(Target(0.2, 1.1e-3), Chaser(0.02), SHAPE))
    assert held_after(far, np.array([0.0, 3.0, -0.6, 0.0]), 0.0) is None
    assert held_after(QUESTION, np.array([0.0, 0.8, -0.04, -0.1]), 0.0) is None
    # One radian in a step is the most that the reference is made for.
    fast = replace(QUESTION, scenario=Scenario(Target(0.6, 0.0), Chaser(5.0), SHAPE))
    assert held_after(fast, np.array([0.0, 1.5, -0.9, 0.0]), 0.0) is None
    undecided = Answer(Verdict.UNDECIDED, math.nan, -1.0, 1.0, None, (), 0)
    assert with_hold(QUESTION, START, undecided) is undecided
