"""The exact question's cone program: its matrices written out by hand, its dual bound, and a solver that fails."""

from fractions import Fraction
from typing import Any

import clarabel
import numpy as np
import pytest
from scipy.sparse import csc_array

from safestart.optim import ball_margin, cone_program
from safestart.optim.largest_margin import SOLVED_BY, _into_cone, solve, solve_by_cones
from safestart.optim.thrust_shapes import BALL, CUBE


def drawn(d: int, blocks: int) -> tuple[np.ndarray, np.ndarray]:
    """Rows of a flight of 6 intervals, zeros for thrusts after their time; the ninth is far from binding."""
    rng = np.random.default_rng(10 * d + blocks)
    rows = 9 + blocks * (d + 1)
    thrust = rng.normal(size=(rows, 6 * d))
    thrust[:4, 3 * d :] = 0.0
    thrust[9 :: d + 1] = 0.0
    constant = rng.uniform(1.0, 3.0, rows)
    constant[8] = 90.0
    return constant, thrust


def by_hand(constant: np.ndarray, thrust: np.ndarray, a_max: float, d: int, blocks: int) -> Any:
    """The same program as dense matrices: w, then m; faces, norm limits, then the balls."""
    rows, columns = thrust.shape
    count = columns // d
    a, b = np.zeros((rows + count * (d + 1), columns + 1)), np.zeros(rows + count * (d + 1))
    a[:rows, :columns], b[:rows] = -(a_max * thrust), constant
    plain = rows - blocks * (d + 1)
    for row in [*range(plain), *range(plain, rows, d + 1)]:
        a[row, columns] = 1.0
    for k in range(count):
        b[rows + k * (d + 1)] = 1.0
        for axis in range(d):
            a[rows + k * (d + 1) + 1 + axis, d * k + axis] = -1.0
    cost = np.zeros(columns + 1)
    cost[columns] = -1.0
    cones = [clarabel.NonnegativeConeT(plain)] + [clarabel.SecondOrderConeT(d + 1)] * (blocks + count)
    none = csc_array((columns + 1, columns + 1))
    return none, cost, csc_array(a), b, cones


@pytest.mark.parametrize(("d", "blocks"), [(2, 0), (2, 3), (3, 0), (3, 2)])
@pytest.mark.parametrize("fine", [True, False])
def test_the_matrices_are_those_written_by_hand(
    d: int, blocks: int, fine: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Bit for bit, cones and order included: the solver's iterates depend on all of it, and proofs on the iterates."""
    constant, thrust = drawn(d, blocks)
    seen: list[Any] = []
    solver = clarabel.DefaultSolver

    def spy(*given: Any) -> Any:
        seen.append(given)
        return solver(*given)

    monkeypatch.setattr(clarabel, "DefaultSolver", spy)
    answer = solve_by_cones(constant, thrust, 0.1, d, blocks, fine=fine)
    ((none, cost, a, b, cones, settings),) = seen
    _, cost_, a_, b_, cones_ = by_hand(constant, thrust, 0.1, d, blocks)
    assert (none.data, none.indices, none.shape) == ([], [], (len(cost), len(cost)))
    assert (cost, b) == (cost_.tolist(), b_.tolist())
    assert (a.data, a.indices, a.indptr) == (a_.data.tolist(), a_.indices.tolist(), a_.indptr.tolist())
    assert repr(cones) == repr(cones_)
    found = solver(*by_hand(constant, thrust, 0.1, d, blocks), settings).solve()
    assert answer.status == str(found.status) == "Solved"
    assert answer.thrust is not None
    np.testing.assert_array_equal(answer.thrust, 0.1 * inside_balls(np.array(found.x[:-1]).reshape(-1, d)))


def inside_balls(w: np.ndarray) -> np.ndarray:
    """Each thrust on its own, scaled back where it is outside."""
    inside = 1.0 - 1e-14
    return np.array([t * (inside / max(inside, np.sqrt((t * t).sum()))) for t in w])


@pytest.mark.parametrize(("d", "blocks"), [(2, 0), (2, 3), (3, 0), (3, 2)])
def test_thrust_and_weights_close_the_gap(d: int, blocks: int) -> None:
    constant, thrust = drawn(d, blocks)
    answer = solve(constant, thrust, 0.1, d, blocks)
    assert answer.thrust is not None
    assert answer.weights is not None
    values = constant + thrust @ answer.thrust.ravel()
    limits = values[9:].reshape(blocks, d + 1)
    margins = np.r_[values[:9], limits[:, 0] - np.linalg.norm(limits[:, 1:], axis=1)]
    assert margins.min() == pytest.approx(answer.bound, abs=1e-6)
    weights = answer.weights[9:].reshape(blocks, d + 1)
    assert (np.linalg.norm(weights[:, 1:], axis=1) <= weights[:, 0]).all()
    assert (answer.weights[:9] >= 0.0).all()
    # The interior point's small weight on an irrelevant row does not belong in a proof.
    assert answer.weights[8] == 0.0
    assert answer.weights[:9].sum() + weights[:, 0].sum() == pytest.approx(1.0, abs=1e-12)


def test_weights_of_norm_limits_are_in_the_cone_in_exact_arithmetic() -> None:
    pulls = np.random.default_rng(4).normal(size=(100, 3))
    heads = np.linalg.norm(pulls, axis=1) * np.random.default_rng(5).choice([0.9, 1.0 - 1e-15, 1.0, 1.1], 100)
    weights = np.column_stack([heads, pulls])
    weights[:3] *= 1e-12
    _into_cone(weights, 1e-10)
    assert not weights[:3].any()
    for head, *pull in weights.tolist():
        assert sum(Fraction(e) ** 2 for e in pull) <= Fraction(head) ** 2
    np.testing.assert_array_equal(weights[3:, 1:], pulls[3:])
    np.testing.assert_allclose(
        weights[3:, 0], np.maximum(heads, np.linalg.norm(pulls, axis=1))[3:], rtol=1e-13
    )


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_what_the_solver_cannot_do_gives_no_thrust(value: float) -> None:
    constant, thrust = drawn(2, 0)
    constant[3] = value
    answer = solve(constant, thrust, 0.1, 2)
    assert (answer.thrust, answer.weights, answer.bound) == (None, None, np.inf)
    assert answer.status not in ("Solved", "AlmostSolved")


@pytest.mark.parametrize("part", ["value", "weights"])
@pytest.mark.parametrize("number", [np.nan, np.inf])
def test_numbers_that_are_not_finite_give_no_thrust(
    part: str, number: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    constant, thrust = drawn(2, 0)
    given = getattr(cone_program.Found, part)

    def broken(found: cone_program.Found, name: str) -> np.ndarray:
        out: np.ndarray = given(found, name)
        out[0] = number
        return out

    monkeypatch.setattr(cone_program.Found, part, broken)
    answer = solve_by_cones(constant, thrust, 0.1, 2)
    assert (answer.thrust, answer.weights, answer.bound) == (None, None, np.inf)


@pytest.mark.parametrize("d", [2, 3])
def test_rows_over_balls_are_solved_by_the_compiled_method(d: int) -> None:
    constant, thrust = drawn(d, 0)
    before = SOLVED_BY.copy()
    answer, cones = solve(constant, thrust, 0.1, d), solve_by_cones(constant, thrust, 0.1, d)
    assert SOLVED_BY - before == {"compiled": 1}
    assert answer.bound == pytest.approx(cones.bound, abs=1e-7)
    # The bound is what the weights prove, whoever found them.
    assert answer.weights is not None
    assert answer.bound == BALL.bound(constant, thrust, answer.weights, 0.1, d)


def test_what_the_compiled_method_leaves_open_is_solved_by_cones_and_counted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    constant, thrust = drawn(2, 0)
    method, before = ball_margin.largest_margin, SOLVED_BY.copy()

    def slow(*given: Any) -> Any:
        w, weights, _, rounds = method(*given)
        return 0.0 * w, weights, ball_margin.SLOW, rounds

    monkeypatch.setattr(ball_margin, "largest_margin", slow)
    answer, cones = solve(constant, thrust, 0.1, 2), solve_by_cones(constant, thrust, 0.1, 2)
    assert SOLVED_BY - before == {"open": 1}
    assert answer.bound == cones.bound
    np.testing.assert_array_equal(answer.thrust, cones.thrust)


def test_norms_and_other_thrusters_are_solved_by_cones() -> None:
    before = SOLVED_BY.copy()
    solve(*drawn(2, 3), 0.1, 2, 3)
    solve(*drawn(2, 0), 0.1, 2, within=CUBE)
    assert SOLVED_BY - before == {"cones": 2}
