"""The builder of cone programs: against dense matrices written out, HiGHS, closed forms, and bad input."""

from fractions import Fraction

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.sparse import csc_array

from safestart.errors import InvalidInput
from safestart.optim.cone_program import ConeProgram, Each
from safestart.optim.thrust_ball import bound, into_balls, keep_in_balls


def test_standard_form_written_out() -> None:
    """Two variables, rows and norms added in turn: rows come first, columns go by variable, zeros are left out."""
    program = ConeProgram(x=2, t=1)
    program.norms(
        "ball", np.array([[5.0, 1.0, 2.0]]), x=np.array([[0.0, 0.0], [1.0, 0.0], [0.5, -1.0]]), t=-3.0
    )
    program.rows("plane", np.array([7.0, 8.0]), x=np.array([[1.0, 2.0], [0.0, 4.0]]), t=2.0)
    program.norms("disks", np.array([[1.0, 0.0], [2.0, 0.0]]), x=Each(np.array([[1], [3]]), 6.0))
    program.rows("more", np.array([9.0]), t=np.array([[-1.0]]))
    program.minimise(x=np.array([0.5, 0.0]), t=-1.0)
    cost, a, b, cones = program.standard_form()
    assert cost == [0.5, 0.0, -1.0]
    assert b == [7.0, 8.0, 9.0, 5.0, 1.0, 2.0, 1.0, 0.0, 2.0, 0.0]
    assert cones == [(0, 3), (3, 1), (2, 2)]
    dense = np.array(
        [
            [-1.0, -2.0, -2.0],
            [0.0, -4.0, -2.0],
            [0.0, 0.0, 1.0],
            [0.0, 0.0, 3.0],
            [-1.0, 0.0, 0.0],
            [-0.5, 1.0, 0.0],
            [0.0, 0.0, 0.0],
            [-6.0, 0.0, 0.0],
            [0.0, 0.0, 0.0],
            [0.0, -6.0, 0.0],
        ]
    )
    expected = csc_array(dense)
    assert a.shape == dense.shape
    assert (a.data, a.indices, a.indptr) == (
        expected.data.tolist(),
        expected.indices.tolist(),
        expected.indptr.tolist(),
    )


@pytest.mark.parametrize("seed", range(5))
def test_linear_programs_agree_with_highs(seed: int) -> None:
    rng = np.random.default_rng(seed)
    rows, limits = rng.normal(size=(12, 4)), rng.uniform(0.5, 2.0, 12)
    cost, side = rng.normal(size=4), rng.normal(size=12)
    program = ConeProgram(u=4, slack=1)
    program.rows("faces", limits, u=-rows, slack=side[:, None])
    program.rows("box", np.full(8, 1.5), u=np.concatenate([np.eye(4), -np.eye(4)]))
    program.rows("up", np.zeros(1), slack=1.0)
    program.rows("down", np.full(1, 0.3), slack=-1.0)
    program.minimise(u=cost, slack=0.2)
    found = program.solve()
    limits_of = [(-1.5, 1.5)] * 4 + [(0.0, 0.3)]
    highs = linprog(
        np.r_[cost, 0.2], np.column_stack([rows, -side]), limits, bounds=limits_of, method="highs"
    )
    assert found.solved
    assert cost @ found.value("u") + 0.2 * found.value("slack")[0] == pytest.approx(highs.fun, abs=1e-6)
    np.testing.assert_allclose(found.value("u"), highs.x[:4], atol=1e-5)
    np.testing.assert_allclose(found.weights("faces"), -highs.ineqlin.marginals, atol=1e-5)


def test_a_set_of_thrusters_agrees_with_highs() -> None:
    """Thrust is a sum of five nozzles that push and never pull: the hull of their ends, and the least flow for it."""
    rng = np.random.default_rng(3)
    nozzles = rng.normal(size=(2, 5))
    wanted = nozzles @ np.array([0.2, 0.0, 0.7, 0.1, 0.0])
    program = ConeProgram(flow=5)
    program.rows("at least", np.zeros(5), flow=Each(np.arange(5)[:, None]))
    program.rows("at most", np.ones(5), flow=-np.eye(5))
    program.norms("wanted", np.concatenate([[1e-6], -wanted])[None], flow=np.vstack([np.zeros(5), nozzles]))
    program.minimise(flow=1.0)
    found = program.solve()
    highs = linprog(np.ones(5), A_eq=nozzles, b_eq=wanted, bounds=(0.0, 1.0), method="highs")
    assert found.solved
    assert found.value("flow").sum() == pytest.approx(highs.fun, abs=1e-5)


def test_a_small_second_order_program_by_hand() -> None:
    """The point of the unit disk farthest along (3, 4) with x <= 0.5: on the rim, above the limit."""
    program = ConeProgram(x=2)
    program.rows("limit", np.array([0.5]), x=np.array([[-1.0, 0.0]]))
    program.norms("disk", np.array([[1.0, 0.0, 0.0]]), x=Each(np.array([[1], [2]])))
    program.minimise(x=np.array([-3.0, -4.0]))
    found = program.solve()
    assert found.solved
    np.testing.assert_allclose(found.value("x"), [0.5, np.sqrt(0.75)], atol=1e-7)
    # cost = limit's normal times its weight + the disk's: 3 = weight + s x, 4 = s y with |y| = head.
    share = 4.0 / np.sqrt(0.75)
    np.testing.assert_allclose(found.weights("limit"), [3.0 - 0.5 * share], atol=1e-5)
    np.testing.assert_allclose(found.weights("disk"), [share, -0.5 * share, -4.0], atol=1e-5)


def test_the_solver_says_what_has_no_solution() -> None:
    program = ConeProgram(x=1)
    program.rows("above", np.array([-1.0]), x=1.0)
    program.minimise(x=-1.0)
    assert (program.solve().status, program.solve().solved) == ("DualInfeasible", False)
    program.rows("below", np.array([0.5]), x=-1.0)
    assert (program.solve().status, program.solve().solved) == ("PrimalInfeasible", False)


def test_coarse_is_close() -> None:
    program = ConeProgram(thrust=20)
    keep_in_balls(program, 10, 2)
    cost = np.random.default_rng(1).normal(size=20)
    program.minimise(thrust=cost)
    best = -np.linalg.norm(cost.reshape(10, 2), axis=1).sum()
    assert cost @ program.solve().value("thrust") == pytest.approx(best, abs=1e-6)
    assert cost @ program.solve(fine=False).value("thrust") == pytest.approx(best, abs=1e-3)


@pytest.mark.parametrize("d", [2, 3])
def test_balls_of_unit_and_of_variable_radius(d: int) -> None:
    cost = np.random.default_rng(d).normal(size=4 * d)
    unit, radii = ConeProgram(thrust=4 * d), ConeProgram(thrust=4 * d, radius=4)
    keep_in_balls(unit, 4, d)
    keep_in_balls(radii, 4, d, radius="radius")
    radii.rows("largest", np.array([0.1, 0.2, 0.3, 0.4]), radius=-np.eye(4))
    lengths = np.linalg.norm(cost.reshape(4, d), axis=1)
    for program, size in ((unit, np.ones(4)), (radii, np.array([0.1, 0.2, 0.3, 0.4]))):
        program.minimise(thrust=cost)
        assert cost @ program.solve().value("thrust") == pytest.approx(-float(size @ lengths), abs=1e-6)


def test_thrusts_are_inside_in_exact_arithmetic() -> None:
    rng = np.random.default_rng(5)
    w = rng.normal(size=(200, 3))
    w /= np.linalg.norm(w, axis=1)[:, None]
    w *= rng.choice([0.3, 1.0 - 1e-15, 1.0, 1.0 + 1e-9, 2.0], 200)[:, None]
    inside = into_balls(w)
    for thrust, before in zip(inside.tolist(), w.tolist(), strict=True):
        assert sum(Fraction(e) ** 2 for e in thrust) <= 1
        if sum(Fraction(e) ** 2 for e in before) < Fraction(99, 100):
            assert thrust == before


def test_the_bound_is_the_best_history_and_no_history_beats_it() -> None:
    rng = np.random.default_rng(6)
    constant, rows, weights = rng.normal(size=7), rng.normal(size=(7, 30)), rng.dirichlet(np.ones(7))
    highest = bound(constant, rows, weights, 0.1, 3)
    pull = (weights @ rows).reshape(10, 3)
    best = 0.1 * pull / np.linalg.norm(pull, axis=1)[:, None]
    assert weights @ (constant + rows @ best.ravel()) == pytest.approx(highest, abs=1e-12)
    for _ in range(100):
        thrust = 0.1 * into_balls(rng.normal(size=(10, 3)))
        assert weights @ (constant + rows @ thrust.ravel()) <= highest


BAD = [
    lambda p: p.rows("a", np.ones(2), y=np.ones((2, 3))),
    lambda p: p.rows("a", np.ones(2), x=np.ones((3, 2))),
    lambda p: p.rows("a", np.ones(2), x=np.ones((2, 2))),
    lambda p: p.rows("a", np.ones(2), x=1.0),
    lambda p: p.rows("a", np.ones(2), x=Each(np.array([[0], [1]]))),
    lambda p: p.rows("a", np.ones(2), x=Each(np.array([[0], [1], [2]]))),
    lambda p: p.rows("a", np.ones(3), x=Each(np.array([0, 1, 2]))),
    lambda p: p.rows("a", np.ones(3), x=Each(np.array([[0], [1], [-1]]))),
    lambda p: p.rows("a", np.ones(3), x=Each(np.array([[1, 0], [0, 1], [0, 1]]))),
    lambda p: p.rows("there", np.ones(2), t=1.0),
    lambda p: p.norms("there", np.ones((1, 2)), t=1.0),
    lambda p: p.norms("a", np.ones(3), t=1.0),
    lambda p: p.norms("a", np.ones((3, 1)), t=1.0),
    lambda p: p.norms("a", np.ones((2, 2)), x=np.ones((2, 3))),
    lambda p: p.minimise(y=1.0),
    lambda p: p.minimise(x=np.ones(2)),
]


@pytest.mark.parametrize("k", range(len(BAD)))
def test_what_does_not_fit_is_refused(k: int) -> None:
    program = ConeProgram(x=3, t=1)
    program.rows("there", np.ones(1), t=1.0)
    with pytest.raises(InvalidInput):
        BAD[k](program)


def test_a_quadratic_cost_is_minimised() -> None:
    # |x - a|^2 / 2 + |y - b|^2 / 2 + x . C y: the gradient vanishes at the solution of a linear system.
    a, b, cross = np.array([1.0, -2.0]), np.array([0.5, 3.0]), np.array([[0.3, 0.1], [-0.2, 0.4]])
    program = ConeProgram(x=2, y=2)
    program.minimise(x=-a, y=-b)
    program.curve("x", "x", np.eye(2))
    program.curve("x", "y", cross)
    program.curve("y", "y", np.eye(2))
    program.rows("far", np.full(2, 100.0), x=np.eye(2))
    for plain in (False, True):
        found = program.solve(plain=plain)
        assert found.solved
        best = np.linalg.solve(np.block([[np.eye(2), cross], [cross.T, np.eye(2)]]), np.concatenate([a, b]))
        np.testing.assert_allclose(np.concatenate([found.value("x"), found.value("y")]), best, atol=1e-6)


def test_a_quadratic_cost_of_another_shape_is_refused() -> None:
    program = ConeProgram(x=2, y=1)
    with pytest.raises(InvalidInput, match=r"x\.y"):
        program.curve("x", "y", np.eye(2))
    with pytest.raises(InvalidInput, match=r"y\.x"):
        program.curve("y", "x", np.ones((1, 2)))
