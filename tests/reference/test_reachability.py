"""Published and independently obtained figures about the reachable sets of paper 000."""

import highspy
import numpy as np
import pytest

from safestart.constraints.corridor import corridor_of
from safestart.dynamics.cwh import planar_input, planar_transition
from safestart.model.scenario import Rest, Scenario, SetKind
from tests.unit.sets.exact_margin import reach_margin

# Source: our own study before this code was written (tube and fixed-time sets by a separate prototype): cone
# cells of a 31 x 31 grid over x in [-150, 150] m, y in [0, 200] m from which the corridor is reachable at
# exactly 40 s with 0.10 m/s^2, at 1, 3 and 5 deg/s. The grid is that of the level-set engine's narrow domain.
FIXED_TIME_CELLS = {Rest.LVLH: (668, 239, 113), Rest.BODY: (720, 461, 17)}


@pytest.mark.parametrize("rest", Rest)
def test_fixed_time_cells_at_40_s(rest: Rest) -> None:
    points = np.stack(np.meshgrid(np.linspace(-150.0, 150.0, 31), np.linspace(0.0, 200.0, 31)), axis=-1)
    found = []
    for rate in (1.0, 3.0, 5.0):
        scenario = Scenario.of(rate, 0.1)
        inside = corridor_of(scenario.corridor).contains(points)
        assert inside.sum() == 720
        reach = reach_margin(scenario, points, 40.0, rest, SetKind.FIXED)
        found.append(int((inside & (reach >= 0.0)).sum()))
    assert tuple(found) == FIXED_TIME_CELLS[rest]


def radial_extent(mean_motion: float, *, at_rest: bool) -> float:
    """Extent in x of the starts driven to (0, 30, 0, 0) in 20 steps of 2 s by |u_i| <= 0.1: two programs."""
    a, b = planar_transition(mean_motion, 2.0), planar_input(mean_motion, 2.0)
    gains = np.hstack([np.linalg.matrix_power(a, 19 - k) @ b for k in range(20)])
    rows = np.hstack([np.linalg.matrix_power(a, 20), gains])
    ends = []
    for sense in (1.0, -1.0):
        solver = highspy.Highs()
        solver.setOptionValue("output_flag", False)
        speed = 0.0 if at_rest else highspy.kHighsInf
        free = highspy.kHighsInf
        for j in range(44):
            bound = free if j < 2 else speed if j < 4 else 0.1
            solver.addVar(-bound, bound)
        solver.changeColCost(0, sense)
        for row, value in zip(rows, (0.0, 30.0, 0.0, 0.0), strict=True):
            solver.addRow(value, value, 44, np.arange(44, dtype=np.int32), row)
        solver.run()
        assert solver.getModelStatus() == highspy.HighsModelStatus.kOptimal
        ends.append(sense * solver.getInfo().objective_function_value)
    return ends[1] - ends[0]


@pytest.mark.parametrize(("at_rest", "ratio"), [(True, 1.010), (False, 1.029)])
def test_orbital_coupling_expands_the_radial_reach(at_rest: bool, ratio: float) -> None:
    """Paper 000, section 3 and Fig. 2, prints a contraction to 81 %; the exact programs say otherwise."""
    found = radial_extent(1.1e-3, at_rest=at_rest) / radial_extent(0.0, at_rest=at_rest)
    assert found == pytest.approx(ratio, abs=6e-4)
