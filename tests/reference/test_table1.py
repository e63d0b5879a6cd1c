"""Paper 000, Table 1: all 20 cells within 0.3 percentage points (corridor cut at y_B <= 150 m, 401 x 401)."""

import pytest

from safestart.closed_form.paper import certify_grid
from safestart.model.scenario import Grid, Scenario
from safestart.papers import safe_start as published

CELLS = [
    (rate, thrust, value)
    for rate, row in published.TABLE1_SAFE_PERCENT.items()
    for thrust, value in zip(published.TABLE1_THRUST_M_S2, row, strict=True)
]


@pytest.mark.parametrize(("rate", "thrust", "paper"), CELLS)
def test_cell(rate: float, thrust: float, paper: float) -> None:
    ours = 100.0 * certify_grid(Scenario.of(rate, thrust), Grid(401, 401, 150.0)).safe_fraction
    assert ours == pytest.approx(paper, abs=0.3)


def test_there_are_twenty_cells() -> None:
    assert len(CELLS) == 20
