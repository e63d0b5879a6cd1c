"""The hold after the end of `synchronize`: proved for many ends, and every claim beyond its evidence is rejected."""

from __future__ import annotations

import copy
import json
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from flint import arb, arb_mat, fmpq
from scipy.linalg import expm

from safestart.exact.answer import Answer, Held, Verdict
from safestart.exact.decide import decide
from safestart.exact.hold_after import held_after, with_hold
from safestart.exact.prove import proof_of
from safestart.exact.question import Goal, Question
from safestart.model.scenario import Chaser, CorridorShape, Floats, Scenario, Target
from safestart.proofs.balls import Motion
from safestart.proofs.checker import check
from safestart.proofs.hold.check import Hold, _At, _require_positive
from safestart.proofs.single import Witness
from safestart.proofs.statement import read
from safestart.proofs.strict import ProofRejected
from tests.unit.proofs.forgery import Document, assert_all_is_read, changed, places, sealed

SHAPE = CorridorShape(1.2, 0.7, 3.0, 2.0, 0.75)
QUESTION = Question(
    Scenario(Target(0.05, 1.1e-3), Chaser(0.02), SHAPE), 2.0, 1, 2, Goal(0.5, 0.05, (0.0, 1.5)), 1.5, 0.5
)
START = np.array([0.1, 1.5, -0.075, 0.065])


def made(question: Question, start: Floats) -> Document:
    answer = with_hold(question, start, decide(question, start))
    assert answer.held is not None
    out: Document = json.loads(json.dumps(proof_of(question, start, answer)))
    return out


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


def turned(point: Floats, angle: float) -> Floats:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([c * point[0] - s * point[1], s * point[0] + c * point[1]])


def steps(n: float, dt: float) -> tuple[Floats, Floats]:
    """Transition and held input by one matrix exponential."""
    system = np.zeros((6, 6))
    system[0, 2] = system[1, 3] = system[2, 4] = system[3, 5] = 1.0
    system[2, 0], system[2, 3], system[3, 2] = 3.0 * n * n, 2.0 * n, -2.0 * n
    whole = expm(system * dt)
    return whole[:4, :4], whole[:4, 4:]


def loop_of(question: Question, held: Held) -> tuple[Any, Any]:
    """The reference at a step as a function of the body's angle, solved for as a wave C cos + S sin."""
    target, dt = question.scenario.target, question.dt
    rate, (a, b) = target.tumble_rate, steps(target.mean_motion, dt)
    rows, right = [], []
    for angle in (0.2, 1.9):
        now, then = (np.kron([math.cos(t), math.sin(t)], np.eye(2)) for t in (angle, angle + rate * dt))
        left = np.hstack([a[:, 2:] @ now, b @ now])
        left[2:, :4] -= then
        rows.append(left)
        place = turned(held.point, angle)
        right.append(np.r_[turned(held.point, angle + rate * dt), 0.0, 0.0] - a[:, :2] @ place)
    wave = np.linalg.solve(np.vstack(rows), np.concatenate(right))

    def state(angle: float) -> Floats:
        now = np.kron([math.cos(angle), math.sin(angle)], np.eye(2))
        return np.r_[turned(held.point, angle), now @ wave[:4]]

    def thrust(angle: float) -> Floats:
        return np.asarray(np.kron([math.cos(angle), math.sin(angle)], np.eye(2)) @ wave[4:])

    return state, thrust


@pytest.mark.parametrize("seed", range(4))
def test_a_thousand_flights_from_the_boundary_stay(seed: int) -> None:
    """250 flights each, by matrix exponentials, from the boundary at any angle of the body, worst directions among
    them; each step watched at 20 instants until the error is a hundredth."""
    question = replace(QUESTION, speed_limit=(None, 0.4, None, 1.5)[seed])
    rate = (0.05, 0.05, 0.0, 0.02)[seed]
    question = replace(question, scenario=Scenario(Target(rate, 1.1e-3), Chaser(0.02), SHAPE))
    end = np.r_[0.1, 1.5, 0.002, -0.003] + np.r_[0.0, 0.0, -rate * 1.5, rate * 0.1]
    held = held_after(question, end, 0.0)
    assert held is not None
    state_at, thrust_at = loop_of(question, held)
    assert (end - state_at(0.0)) @ held.cost @ (end - state_at(0.0)) <= held.level
    n, dt = question.scenario.target.mean_motion, question.dt
    parts = [steps(n, dt * j / 20) for j in range(21)]
    rng = np.random.default_rng(seed)
    root = math.sqrt(held.level) * np.linalg.inv(np.linalg.cholesky(held.cost)).T
    shell = rng.normal(size=(250, 4))
    # Half of them go farthest in some direction at some instant of the first step.
    for k in range(125):
        phi, b = parts[int(rng.integers(21))]
        shell[k] = root.T @ (phi + b @ held.gain)[:2].T @ rng.normal(size=2)
    errors = (shell / np.linalg.norm(shell, axis=1)[:, None]) @ root.T
    angle = rng.uniform(0.0, 2.0 * math.pi, 250)
    states = np.array([state_at(t) for t in angle]) + errors
    least, most, fast = math.inf, 0.0, 0.0
    for _ in range(60):
        wanted, given = (np.array([f(t) for t in angle]) for f in (state_at, thrust_at))
        given = given + (states - wanted) @ held.gain.T
        most = max(most, float(np.linalg.norm(given, axis=1).max()))
        for j, (phi, b) in enumerate(parts):
            seen = states @ phi.T + given @ b.T
            fast = max(fast, float(np.linalg.norm(seen[:, 2:], axis=1).max()))
            body = np.array(
                [turned(p, -(t + rate * dt * j / 20)) for p, t in zip(seen[:, :2], angle, strict=True)]
            )
            sides = 3.0 + 1.2 * (body[:, 1] - 0.75) - np.abs(body[:, 0])
            least = min(least, float((body[:, 1] - 0.75).min()), float(sides.min()) / math.hypot(1.0, 1.2))
        states, angle = seen, angle + rate * dt
    assert least >= held.margin
    assert most <= question.scenario.chaser.max_acceleration
    assert question.speed_limit is None or fast <= question.speed_limit
    # The set is no smaller than it need be: some flight comes near the margin, or a limit.
    near = least < held.margin + 0.1 * (held.point[1] - 0.75)
    assert near or most > 0.9 * 0.02 or fast > 0.9 * (question.speed_limit or math.inf)
    assert float(np.linalg.norm(states - np.array([state_at(t) for t in angle]), axis=1).max()) < 1e-3


def loop(document: Document, **change: Any) -> Hold:
    """The checker's own loop of a document, at its precision."""
    stated = read(document)
    assert stated.held is not None
    faces = Witness(stated).faces
    return Hold(
        replace(stated.held, **change), Motion(stated), arb(stated.dt), faces, arb(stated.a_max), arb("1.5")
    )


def test_the_bounds_are_those_of_the_ellipsoid(document: Document) -> None:
    """Distances, distance from the target and speed at instants of a step, against thousands of errors and angles."""
    question = replace(QUESTION, scenario=replace(QUESTION.scenario, target=Target(0.2, 1.3e-3)))
    claim = document["hold_after"]
    held = Held(np.array([0.6, 1.9]), np.array(claim["gain"]), np.array(claim["cost"]), 1.2, 0.1)
    made = changed(document, "question.tumble_rate_rad_s", 0.2)
    made = changed(made, "question.mean_motion_rad_s", 1.3e-3)
    hold = loop(made, point=[fmpq(3, 5), fmpq(19, 10)], level=fmpq(6, 5))
    state_at, thrust_at = loop_of(question, held)
    root = math.sqrt(held.level) * np.linalg.inv(np.linalg.cholesky(held.cost)).T
    angles = np.linspace(0.0, 2.0 * math.pi, 90, endpoint=False)
    wanted, given = (np.array([f(t) for t in angles]) for f in (state_at, thrust_at))
    for share in (0.0, 0.3, 0.5, 1.0):
        phi, b = steps(1.3e-3, 2.0 * share)
        image = (phi + b @ held.gain) @ root
        seen = wanted @ phi.T + given @ b.T
        place, fast = (np.linalg.svd(image[k : k + 2], compute_uv=False)[0] for k in (0, 2))
        body = np.array([turned(p, -(t + 0.4 * share)) for p, t in zip(seen[:, :2], angles, strict=True)])
        found = hold._bounds(arb(2.0 * share))
        for name, normal, offset in (
            ("hold_plane", [0.0, -1.0], -0.75),
            ("right", [1.0, -1.2], 3.0 - 1.2 * 0.75),
            ("left", [-1.0, -1.2], 3.0 - 1.2 * 0.75),
        ):
            length = math.hypot(*normal)
            least = float(((offset - body @ normal) / length).min()) - place
            assert float(found.left[name]) == pytest.approx(least, abs=2e-8)
        farthest = float(np.linalg.norm(seen[:, :2], axis=1).max()) + place
        assert farthest - 1e-9 <= float(found.far) <= farthest + 1e-2
        assert float(found.fast) == pytest.approx(
            float(np.linalg.norm(seen[:, 2:], axis=1).max()) + fast, abs=1e-4
        )
        over = hold._bounds(arb(2.0 * share) + arb(1, 1) / 100)
        assert float(over.far.abs_upper()) >= float(found.far)
        assert float(over.fast.abs_upper()) >= float(found.fast)


@pytest.mark.parametrize("more", [-1e-9, 1e-9])
def test_between_two_instants_it_may_fall_by_so_much(document: Document, more: float) -> None:
    """h^2 / 8 of a_max + 3 n^2 r + 2 n v + 2 w v + w^2 r; the speed rises by h / 2 of the first three."""
    hold = loop(document)
    n, w, far, fast, h = 1.1e-3, 0.05, 900.0, 40.0, 0.5
    push = 0.02 + 3.0 * n * n * far + 2.0 * n * fast
    sag = h * h / 8.0 * (push + 2.0 * w * fast + w * w * far)
    calm = _At(dict.fromkeys(hold.faces, arb(1)), arb(0), arb(0))
    over = _At(calm.left, arb(far), arb(fast))
    hold.margin, hold.speed = arb(1.0 - sag + more), None
    for before, after in ((calm, replace(calm, left=calm.left | {"left": arb(2)})),):
        for pair in ((before, after), (after, before)):
            if more > 0.0:
                with pytest.raises(ProofRejected, match="the distance to"):
                    hold._require(*pair, over, arb(h))
            else:
                hold._require(*pair, over, arb(h))
    hold.margin = arb("0.1")
    for pair in ((calm, replace(calm, fast=arb(3))), (replace(calm, fast=arb(3)), calm)):
        hold.speed = arb(3.0 + h / 2.0 * push - more)
        if more > 0.0:
            with pytest.raises(ProofRejected, match="the speed"):
                hold._require(*pair, over, arb(h))
        else:
            hold._require(*pair, over, arb(h))


def test_pivots_tell_a_positive_matrix() -> None:
    rng = np.random.default_rng(4)
    for _ in range(20):
        half = rng.normal(size=(4, 4))
        _require_positive(arb_mat((half @ half.T + 0.01 * np.eye(4)).tolist()), "")
    for i in range(4):
        for j in range(i):
            # Its diagonal is positive, its least eigenvalue -0.1.
            bent = np.eye(4)
            bent[i, j] = bent[j, i] = 1.1
            with pytest.raises(ProofRejected, match="bent"):
                _require_positive(arb_mat(bent.tolist()), "bent")


def test_its_pieces_tile_the_step(document: Document, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each span between two neighbouring instants is enclosed whole, from the first to the last of the step."""
    hold, whole, asked = loop(document), Hold._bounds, []

    def noted(self: Hold, s: arb) -> _At:
        asked.append((float(s.mid() - s.rad()), float(s.mid() + s.rad())))
        return whole(self, s)

    monkeypatch.setattr(Hold, "_bounds", noted)
    answer = with_hold(QUESTION, START, decide(QUESTION, START))
    assert answer.thrust is not None
    phi, held = Motion(read(document)).over(arb(2))
    state = phi * arb_mat(4, 1, START.tolist()) + held * arb_mat(2, 1, answer.thrust[0].tolist())
    hold.check(state, arb(2))
    instants = sorted(low for low, high in asked if high - low < 1e-6)
    spans = sorted((low, high) for low, high in asked if high - low > 1e-6)
    assert (instants[0], instants[-1]) == (0.0, 2.0)
    assert len(spans) == len(instants) - 1 >= 8
    for (low, high), before, after in zip(spans, instants, instants[1:], strict=False):
        assert low <= before + 1e-9
        assert high >= after - 1e-9
        assert high - low < 1.01 * (after - before)


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
