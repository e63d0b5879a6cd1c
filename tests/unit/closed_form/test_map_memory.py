"""Maps and many starts by blocks: the same bits for any cut, in little more memory than the answer itself."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest

from safestart.closed_form import blocks, certified, paper
from safestart.model.scenario import Chaser, Grid, Rest, Scenario, Target

SCENARIO = Scenario(Target(tumble_rate=np.deg2rad(3.0)), Chaser(max_acceleration=0.1))
SIDE = 700


@pytest.mark.parametrize("find", [certified.certify_grid, paper.certify_grid])
@pytest.mark.parametrize("rest", list(Rest))
@pytest.mark.parametrize("most", [1, 100, 101 * 40, 10**9])
def test_any_cut_has_the_same_bits(find, rest, most, monkeypatch):
    grid = Grid(nx=101, ny=97)
    whole = find(SCENARIO, grid, rest)
    monkeypatch.setattr(blocks, "MOST_CELLS", most)
    cut = find(SCENARIO, grid, rest)
    assert cut.margin.tobytes() == whole.margin.tobytes()
    assert cut.mask.tobytes() == whole.mask.tobytes()
    assert cut.inside.tobytes() == whole.inside.tobytes()
    assert cut.safe_fraction == whole.safe_fraction > 0.0


@pytest.mark.parametrize("find", [certified.certify_grid, paper.certify_grid])
def test_a_large_map_takes_little_more_than_itself(find):
    """Without blocks the sound certificate takes two hundred bytes for each cell."""
    grid = Grid(nx=SIDE, ny=SIDE)
    find(SCENARIO, Grid(nx=9, ny=9))
    tracemalloc.start()
    try:
        find(SCENARIO, grid)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < 50 * SIDE**2


@pytest.mark.parametrize("dimensions", [2, 3])
@pytest.mark.parametrize("most", [1, 100, 10**9])
def test_starts_in_any_blocks_have_the_same_bits(dimensions, most, monkeypatch):
    starts = np.random.default_rng(dimensions).uniform(-100.0, 200.0, (997, dimensions))
    whole = certified.certify(SCENARIO, starts)
    monkeypatch.setattr(blocks, "MOST_CELLS", most)
    cut = certified.certify(SCENARIO, starts)
    assert 0 < whole.go.sum() < len(starts)
    for field in ("go", "margin", "binding", "member", "drop"):
        assert getattr(cut, field).tobytes() == getattr(whole, field).tobytes(), field


def test_many_starts_take_little_more_than_their_answer():
    """Without blocks 255 bytes for each start."""
    starts = np.random.default_rng(0).uniform([-226.0, 0.5], [226.0, 150.0], (500_000, 2))
    certified.certify(SCENARIO, starts[:9])
    tracemalloc.start()
    try:
        certified.certify(SCENARIO, starts)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < 120 * len(starts)


def test_every_row_comes_once():
    for rows, columns in ((1, 1), (7, 40_000), (1000, 1000), (97, 101)):
        found = [row for part in blocks.row_blocks(rows, columns) for row in range(rows)[part]]
        assert found == list(range(rows))
