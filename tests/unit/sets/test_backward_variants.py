"""Backward reachable sets: against programs, against flights, and how the variants lie in one another."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

from safestart.dynamics.cwh import planar_input, planar_transition
from safestart.errors import InvalidInput
from safestart.model.scenario import Floats
from safestart.sets.backward import chance, planar, policy, polygon, program
from safestart.sets.backward.cloud import empirical, succeeded
from safestart.sets.backward.question import Question
from safestart.sets.backward.variants import Plane, variants

DOUBLE = Question(
    a=np.array([[1.0, 1.0], [0.0, 1.0]]),
    b=np.array([[0.0], [1.0]]),
    inputs=np.array([1.0]),
    centre=np.zeros(2),
    half_widths=np.array([1.0, 1.0]),
    steps=5,
    limits=np.array([5.0, 5.0]),
    disturbance=0.05 * np.eye(2),
    noise=0.05 * np.eye(2),
)
UNITS = Plane((0, 1), 48, {}).units()


def cwh(mean_motion: float, steps: int = 20, thrust_error: float = 0.003) -> Question:
    """The planar CWH question of Fig. 2, with a box as target."""
    b = planar_input(mean_motion, 2.0)
    return Question(
        a=planar_transition(mean_motion, 2.0),
        b=b,
        inputs=np.array([0.1, 0.1]),
        centre=np.array([0.0, 30.0, 0.0, 0.0]),
        half_widths=np.array([3.0, 3.0, 0.2, 0.2]),
        steps=steps,
        limits=np.full(4, np.inf),
        disturbance=thrust_error * b,
        noise=0.002 * b,
    )


def reach(points: Floats | None, units: Floats = UNITS) -> Floats:
    assert points is not None
    return np.asarray((units @ points.T).max(axis=1))


def by_program(question: Question, shrunk: Floats) -> Floats:
    one = program.open_loop(question, shrunk)
    assert one is not None
    found = [one.furthest(unit) for unit in UNITS]
    return np.array([unit @ each[0] for unit, each in zip(UNITS, found, strict=True) if each is not None])


def zeros(question: Question) -> Floats:
    return np.zeros((question.steps + 1, len(question.a)))


def test_polygons_are_the_linear_programs() -> None:
    for shrunk in (zeros(DOUBLE), DOUBLE.disturbed(), chance.joint(DOUBLE, 0.05)):
        assert reach(planar.open_loop(DOUBLE, shrunk)[0]) == pytest.approx(
            by_program(DOUBLE, shrunk), abs=1e-6
        )


def test_nominal_double_integrator_by_hand() -> None:
    # From the point 0, unlimited states: |v| <= N, and x = -sum (k + 1) u_k has the extent 1 + 2 + .. + 5.
    free = replace(DOUBLE, half_widths=np.zeros(2), limits=np.full(2, np.inf))
    outline = planar.open_loop(free, zeros(free))[0]
    assert outline is not None
    assert outline.max(axis=0) == pytest.approx([15.0, 5.0])
    assert len(outline) == 10


def test_programs_without_limits_are_zonotopes() -> None:
    question = cwh(1.1e-3)
    inverse = np.linalg.inv(question.a)
    for shrunk in (zeros(question), question.disturbed()):
        one = program.open_loop(question, shrunk)
        assert one is not None
        for unit in UNITS[::6]:
            direction = np.array([*unit, 3.0, -7.0])
            row, expected = direction, 0.0
            for _ in range(question.steps):
                row = row @ inverse
                expected += 0.1 * float(np.abs(row @ question.b).sum())
            expected += float(row @ question.centre + np.abs(row) @ (question.half_widths - shrunk[-1]))
            found = one.furthest(direction)
            assert found is not None
            assert direction @ found[0] == pytest.approx(expected, abs=1e-5)


def test_each_variant_lies_in_the_next() -> None:
    nominal = planar.open_loop(DOUBLE, zeros(DOUBLE))[0]
    open_loop = planar.open_loop(DOUBLE, DOUBLE.disturbed())[0]
    feedback = planar.feedback(DOUBLE, DOUBLE.disturbance)[0]
    inner = planar.open_loop(DOUBLE, chance.joint(DOUBLE, 0.05))[0]
    outer = planar.open_loop(DOUBLE, chance.single(DOUBLE, 0.05))[0]
    for small, large in ((open_loop, feedback), (feedback, nominal), (inner, outer), (outer, nominal)):
        assert polygon.excess(small, large) <= 1e-12
        assert polygon.area(small) < 0.995 * polygon.area(large)
    # Against four times the disturbance only feedback has an answer.
    strong = replace(DOUBLE, disturbance=0.2 * np.eye(2))
    assert planar.open_loop(strong, strong.disturbed())[0] is None
    assert polygon.area(planar.feedback(strong, strong.disturbance)[0]) > 25.0
    # A point cannot be hit against a disturbance of any size.
    point = replace(DOUBLE, half_widths=np.zeros(2))
    assert planar.feedback(point, point.disturbance)[0] is None


@pytest.mark.parametrize("noise", [1e-2, 1e-4, 1e-6])
def test_stochastic_tends_to_nominal_with_the_noise(noise: float) -> None:
    quiet = replace(DOUBLE, noise=noise * np.eye(2))
    nominal = reach(planar.open_loop(quiet, zeros(quiet))[0])
    for sets in (
        planar.open_loop(quiet, chance.joint(quiet, 0.05)),
        planar.open_loop(quiet, chance.single(quiet, 0.05)),
        planar.feedback(quiet, chance.confidence_box(quiet, 0.05)),
    ):
        less = nominal - reach(sets[0])
        assert less.min() >= -1e-9
        assert less.max() <= 60.0 * noise
    cloud = empirical(quiet, 2000, (0, 1), 1)
    normals, offsets = polygon.faces(planar.open_loop(quiet, zeros(quiet))[0])  # type: ignore[arg-type]
    assert (cloud @ normals.T - offsets).max() <= 30.0 * noise


def test_noise_carries_the_empirical_set_beyond_the_nominal_one() -> None:
    loud = replace(DOUBLE, noise=0.3 * np.eye(2), limits=np.full(2, np.inf))
    quiet = replace(loud, noise=np.zeros((2, 0)))
    normals, offsets = polygon.faces(planar.open_loop(loud, zeros(loud))[0])  # type: ignore[arg-type]
    beyond = [(empirical(q, 4000, (0, 1), 2) @ normals.T - offsets).max() for q in (quiet, loud)]
    assert beyond[0] <= 1e-9
    assert beyond[1] > 0.5


def test_feedback_set_is_flown_against_the_worst_corners() -> None:
    """From its vertices one input keeps all disturbed successors in the next set; from just outside none does."""
    sets = planar.feedback(DOUBLE, DOUBLE.disturbance)
    corners = 0.05 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    tried = np.linspace(-1.0, 1.0, 4001)

    def worst(state: Floats, after: Floats) -> float:
        normals, offsets = polygon.faces(after)
        mean = DOUBLE.a @ state + tried[:, None] * DOUBLE.b[:, 0]
        room = offsets - (mean[:, None] + corners) @ normals.T
        return float(room.min(axis=(1, 2)).max())

    for now, after in itertools.pairwise(sets):
        assert now is not None
        assert after is not None
        for vertex in now:
            assert worst(vertex, after) >= -6e-4
            inside_limits = (np.abs(1.01 * vertex) <= 5.0).all()
            assert not inside_limits or worst(1.01 * vertex, after) < 0.0


def test_affine_policies_reach_the_planar_feedback_set() -> None:
    one = policy.affine(DOUBLE, DOUBLE.disturbance)
    exact = reach(planar.feedback(DOUBLE, DOUBLE.disturbance)[0])
    for unit, most in zip(UNITS[::4], exact[::4], strict=True):
        found = one.furthest(unit)
        assert found is not None
        assert most - 0.02 <= unit @ found[0] <= most + 1e-6


def test_chance_constrained_starts_succeed_as_often_as_required() -> None:
    one = program.open_loop(DOUBLE, chance.joint(DOUBLE, 0.05))
    assert one is not None
    found = one.furthest(np.array([0.3, 1.0]))
    assert found is not None
    count = succeeded(DOUBLE, found[0], found[1].reshape(5, 1), 20_000, 3)
    assert chance.bounds(count, 20_000, 0.9999)[0] >= 0.95
    # Start in the nominal set only: it fails far more often than allowed.
    bold = program.open_loop(DOUBLE, zeros(DOUBLE))
    assert bold is not None
    found = bold.furthest(np.array([0.3, 1.0]))
    assert found is not None
    count = succeeded(DOUBLE, found[0], found[1].reshape(5, 1), 20_000, 3)
    assert chance.bounds(count, 20_000, 0.9999)[1] < 0.95


def test_planar_cwh_variants_nest() -> None:
    found = {
        one.name: one for one in variants(cwh(1.1e-3, steps=8, thrust_error=0.01), 0.05, Plane((0, 1), 8, {}))
    }
    order = ("robust_open_loop", "robust_feedback", "robust_feedback_outer", "nominal")
    for small, large in itertools.pairwise(order):
        inside, around = found[small].reach, found[large].reach
        assert inside is not None
        assert around is not None
        assert (inside <= around + 1e-6).all()
    for name in ("chance_open_loop", "chance_open_loop_outer", "chance_feedback"):
        less = found[name].reach
        assert less is not None
        assert (less < found["nominal"].reach).all()


def test_bad_questions_are_named() -> None:
    with pytest.raises(InvalidInput, match="a"):
        replace(DOUBLE, a=np.array([[1.0, 1.0], [1.0, 1.0]]))
    with pytest.raises(InvalidInput, match="limits"):
        replace(DOUBLE, limits=np.array([1.0, np.nan]))
    with pytest.raises(InvalidInput, match="b"):
        replace(DOUBLE, b=np.zeros((3, 1)))
    with pytest.raises(InvalidInput, match="risk"):
        chance.joint(DOUBLE, 0.7)
