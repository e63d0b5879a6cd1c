"""Where the level-set solver gives no field, stops, or refuses."""

from typing import Any

import numpy as np
import pytest

from safestart.errors import Cancelled, InvalidInput
from safestart.levelset import Ball, Flux, Input, Lattice, Linear, Options, Scheme, solve
from safestart.runtime.progress import Context
from tests.unit.levelset.levelset_problems import DOUBLE, PUSH, box, rough_lattice, solved


def test_a_poisoned_boundary_has_no_field() -> None:
    """x' = x carries values in from beyond the wall, where the extrapolation grows without bound."""
    lattice = Lattice.of([-1.0, -1.0], [1.0, 1.0], (21, 21), "extrapolate_away_from_zero")
    x, y = lattice.coordinates()
    values = x**2 - y**2
    bad = solve(lattice, Linear(-np.eye(2)), values, 5.0, kind="fixed", options=Options(Scheme.FIRST))
    good = solve(
        Lattice.of([-1.0, -1.0], [1.0, 1.0], (21, 21)), Linear(-np.eye(2)), values, 5.0, kind="fixed"
    )
    away = solve(lattice, Linear(np.eye(2)), values, 5.0, kind="fixed", options=Options(Scheme.FIRST))
    assert good.field is not None, good.failure
    assert bad.field is not None, bad.failure
    assert away.field is None
    assert "poisoned" in away.failure
    with pytest.raises(InvalidInput, match="did not fail"):
        away.optimal_inputs(np.zeros((1, 2)))


def test_values_that_overflow_have_no_field() -> None:
    lattice = Lattice.of([-1.0, -1.0], [1.0, 1.0], (21, 21))
    x, y = lattice.coordinates()
    huge = 1e30 * np.sin(9.0 * x + y)
    motion = Linear(np.eye(2))
    failed = solve(lattice, motion, huge, 0.5, options=Options(Scheme.WENO5, precision="float32"))
    assert failed.field is None
    assert "not finite" in failed.failure


def test_progress_and_dismissal() -> None:
    lattice = rough_lattice(2, "edge")
    x, v = lattice.coordinates()
    values, seen = np.hypot(x, v), list[float]()
    context = Context(lambda done, total, _: seen.append(done / total))
    motion = Linear(DOUBLE, (Input(PUSH, box(1.0), "min"),))
    solved(lattice, motion, values, 2.0, context=context)
    assert len(seen) > 5
    assert seen == sorted(seen)
    assert seen[-1] == pytest.approx(1.0)
    with pytest.raises(Cancelled):
        solve(lattice, motion, values, 2.0, context=Context(cancelled=lambda: True))


BAD: list[Any] = [
    lambda lattice, motion, values: solve(lattice, motion, values, -1.0),
    lambda lattice, motion, values: solve(lattice, motion, values, np.nan),
    lambda lattice, motion, values: solve(lattice, motion, values[1:], 1.0),
    lambda lattice, motion, values: solve(lattice, motion, np.full(lattice.shape, np.nan), 1.0),
    lambda lattice, motion, values: solve(lattice, object(), values, 1.0),
    lambda lattice, motion, values: solve(lattice, Linear(np.eye(3)), values, 1.0),
    lambda lattice, motion, values: solve(lattice, Linear(1e9 * np.eye(2)), values, 1.0),
    lambda lattice, motion, values: Lattice.of([0.0], [1.0], [9]),
    lambda lattice, motion, values: Lattice.of([0.0, 1.0], [1.0, 1.0], [9, 9]),
    lambda lattice, motion, values: Lattice.of([0.0, 0.0], [1.0, np.inf], [9, 9]),
    lambda lattice, motion, values: Lattice.of([0.0, 0.0], [1.0, 1.0], [9, 3]),
    lambda lattice, motion, values: Linear(np.eye(2), (Input(np.eye(3), box(1.0), "min"),)),
    lambda lattice, motion, values: Linear(np.eye(2), (Input(PUSH, box(-1.0), "min"),)),
    lambda lattice, motion, values: Linear(np.eye(2), (Input(PUSH, box(1.0), "least"),)),  # type: ignore[arg-type]
    lambda lattice, motion, values: Linear(np.eye(2), (Input(PUSH, box(1.0), "min", -1.0),)),
    lambda lattice, motion, values: Options(stages=4),
    lambda lattice, motion, values: Options(precision="float16"),
    lambda lattice, motion, values: Options(courant=1.5),
    lambda lattice, motion, values: solve(
        lattice,
        Linear(np.zeros((2, 2)), (Input(np.eye(2), Ball(np.zeros(2), 1.0), "min"),)),
        values,
        1.0,
        options=Options(flux=Flux.GODUNOV),
    ),
]


@pytest.mark.parametrize("case", range(len(BAD)))
def test_bad_input_is_refused(case: int) -> None:
    lattice = Lattice.of([-1.0, -1.0], [1.0, 1.0], (9, 9))
    x, y = lattice.coordinates()
    with pytest.raises(InvalidInput):
        BAD[case](lattice, Linear(np.zeros((2, 2))), x + y)
