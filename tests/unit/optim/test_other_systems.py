"""The parts on a system that no process has yet: a varying motion, a tumbling box, thrusts in a box or a ball."""

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation

from safestart.optim.cone_program import ConeProgram, Each
from safestart.optim.largest_margin import solve
from safestart.optim.prediction import prediction_of
from tests.unit.optim.motions import Tilted, integrate

DT, STEPS, A_MAX = 8.0, 5, 0.01
STATE = np.array([2.0, -4.0, 1.0, -0.4, 0.3, 0.3])
TIMES = np.linspace(0.0, DT * STEPS, 11)
NORMALS, OFFSETS = np.concatenate([np.eye(3), -np.eye(3)]), np.array([12.0, 15.0, 10.0, 12.0, 15.0, 10.0])
TURNS = Rotation.from_rotvec(0.02 * TIMES[:, None] * np.array([0.6, -0.3, 0.8]))


def faces() -> tuple[np.ndarray, np.ndarray]:
    """Distances of all faces at all times: without thrust, (J,), and what the thrusts add, (J, N d)."""
    prediction = prediction_of(Tilted(), DT, STEPS, 3, 1)
    outward = np.stack([turn.inv().apply(NORMALS) for turn in TURNS])
    start, push = prediction.position_rows(np.repeat(TIMES, 6), -outward.reshape(-1, 3))
    return np.tile(OFFSETS, len(TIMES)) + start @ STATE, push


def faces_flown() -> tuple[np.ndarray, np.ndarray]:
    """The same by integration: one flight without thrust, one for each component of each thrust."""

    def distances(state: np.ndarray, thrust: np.ndarray) -> np.ndarray:
        body = TURNS.apply(integrate(Tilted(), DT, 0.0, state, thrust, TIMES)[:, :3])
        return -(body @ NORMALS.T).ravel()

    free = np.tile(OFFSETS, len(TIMES)) + distances(STATE, np.zeros((STEPS, 3)))
    units = np.eye(3 * STEPS).reshape(-1, STEPS, 3)
    return free, np.stack([distances(np.zeros(6), unit) for unit in units], axis=1)


def test_the_largest_margin_with_a_box_of_thrusts_is_that_of_highs() -> None:
    constant, push = faces()
    program = ConeProgram(thrust=3 * STEPS, margin=1)
    program.rows("faces", constant, thrust=A_MAX * push, margin=-1.0)
    each = np.arange(3 * STEPS)[:, None]
    program.rows("upper", np.ones(3 * STEPS), thrust=Each(each, -1.0))
    program.rows("lower", np.ones(3 * STEPS), thrust=Each(each))
    program.minimise(margin=-1.0)
    found = program.solve()
    free, columns = faces_flown()
    outer, inner = (by_highs(free, columns, limit) for limit in (A_MAX, A_MAX / np.sqrt(3.0)))
    assert found.solved
    assert found.value("margin")[0] == pytest.approx(outer, abs=1e-6)
    # The ball lies in this box and holds the one that is smaller by the root of 3.
    ball = solve(constant, push, A_MAX, 3)
    assert ball.thrust is not None
    assert free.min() < inner - 0.1
    assert inner + 0.1 < ball.bound < outer - 0.1
    assert (free + columns @ ball.thrust.ravel()).min() == pytest.approx(ball.bound, abs=1e-6)


def by_highs(free: np.ndarray, columns: np.ndarray, limit: float) -> float:
    """The largest margin over thrusts whose components are within ``limit``."""
    done = linprog(
        np.r_[np.zeros(3 * STEPS), -1.0],
        np.column_stack([-columns, np.ones(len(free))]),
        free,
        bounds=[(-limit, limit)] * (3 * STEPS) + [(None, None)],
        method="highs",
    )
    return -float(done.fun)
