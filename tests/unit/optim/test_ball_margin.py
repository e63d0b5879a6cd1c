"""The compiled interior-point method: the cone solver's optimum, its own bracket, and programs it cannot do."""

from __future__ import annotations

import numpy as np
import pytest

from safestart.exact.answer import Verdict
from safestart.exact.decide import decide
from safestart.exact.question import Question
from safestart.model.scenario import Scenario
from safestart.optim.ball_margin import SOLVED, largest_margin
from safestart.optim.dense_kernel import MANY, factor, gram
from safestart.optim.largest_margin import SOLVED_BY, solve_by_cones


def drawn(rng: np.random.Generator, d: int) -> tuple[np.ndarray, np.ndarray]:
    """Up to 25 rows over up to 40 thrusts, each 0 after its time; some far from binding, some equal, some constant."""
    count, intervals = int(rng.integers(1, 26)), int(rng.integers(1, 41))
    rows = rng.normal(size=(count, intervals * d)) * 10.0 ** rng.uniform(-2.0, 2.0)
    for row in rows:
        row[d * int(rng.integers(0, intervals + 1)) :] = 0.0
    constant = rng.uniform(-50.0, 50.0, count) * 10.0 ** rng.uniform(-2.0, 2.0)
    if count > 3:
        rows[1], constant[1] = rows[0], constant[0]
        constant[2] += 1e4
    return constant, rows


@pytest.mark.parametrize("d", [2, 3])
def test_the_bracket_closes_and_holds_the_cone_solvers_optimum(d: int) -> None:
    rng, open_ = np.random.default_rng(d), 0
    for _ in range(150):
        constant, rows = drawn(rng, d)
        w, z, status, _ = largest_margin(constant, rows, d, 1e-7)
        if status != SOLVED:
            open_ += 1
            continue
        assert (np.linalg.norm(w.reshape(-1, d), axis=1) < 1.0).all()
        assert (z >= 0.0).all()
        assert z.sum() == pytest.approx(1.0, abs=1e-12)
        margin = float((constant + rows @ w).min())
        pull = (z @ rows).reshape(-1, d)
        bound = float(z @ constant + np.linalg.norm(pull, axis=1).sum())
        assert margin - 1e-12 * abs(bound) <= bound <= margin + 1.001e-7 + 1e-12 * abs(bound)
        cones = solve_by_cones(constant, rows, 1.0, d)
        if cones.status == "Solved":
            assert margin <= cones.bound + 1e-9 * max(1.0, abs(cones.bound))
            assert cones.bound <= bound + 1e-5 * max(1.0, abs(bound))
    assert open_ <= 3, "lengths that differ by six orders of magnitude may be left to the cone solver"


def test_two_rows_by_hand() -> None:
    """Thrust along +-x moves two rows against each other: the best is their mean, whatever the thrust's size."""
    w, z, status, _ = largest_margin(np.array([1.0, 3.0]), np.array([[4.0, 0.0], [-4.0, 0.0]]), 2, 1e-10)
    assert status == SOLVED
    np.testing.assert_allclose(w, [0.25, 0.0], atol=1e-9)
    np.testing.assert_allclose(z, [0.5, 0.5], atol=1e-9)


def test_a_single_row_takes_all_thrust() -> None:
    w, z, status, _ = largest_margin(np.array([-2.0]), np.array([[3.0, 4.0, 0.0, 0.0]]), 2, 1e-9)
    assert status == SOLVED
    np.testing.assert_allclose(w[:2], [0.6, 0.8], atol=1e-8)
    assert z.tolist() == [1.0]


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_what_is_not_finite_does_not_settle(value: float) -> None:
    constant, rows = drawn(np.random.default_rng(9), 2)
    for place in (constant, rows[0]):
        kept = place[0]
        place[0] = value
        assert largest_margin(constant, rows, 2, 1e-7)[2] != SOLVED
        place[0] = kept


@pytest.mark.parametrize("count", [MANY + 1, 2 * MANY])
def test_many_rows_make_the_same_system(count: int) -> None:
    rng = np.random.default_rng(count)
    rows, ends = rng.normal(size=(count, 90)), rng.integers(0, 91, count)
    for row, end in zip(rows, ends, strict=True):
        row[end:] = 0.0
    system = np.empty((count, count))
    gram(rows, ends, np.empty((90, count)), system)
    np.testing.assert_allclose(np.tril(system), np.tril(rows @ rows.T), atol=1e-12)
    whole = rows @ rows.T + np.eye(count)
    factored = np.tril(whole)
    assert factor(factored)
    np.testing.assert_allclose(factored, np.linalg.cholesky(whole), atol=1e-12)


@pytest.mark.parametrize(
    ("rate", "a_max", "x", "y"), [(3, 0.05, -14.9029, 26.0366), (4, 0.1, 0.9036, 29.9864)]
)
def test_long_horizons_are_settled(rate: float, a_max: float, x: float, y: float) -> None:
    """Rows that reach kilometres: the method came no closer than 5e-5 m, did all its iterations and left it open."""
    question = Question(Scenario.of(rate, a_max), 2.0, 300)
    before = SOLVED_BY["open"]
    answer = decide(question, np.array([x, y, 0.0, 0.0]))
    assert SOLVED_BY["open"] == before
    assert answer.verdict is Verdict.GO
    assert answer.gap <= 1e-4
