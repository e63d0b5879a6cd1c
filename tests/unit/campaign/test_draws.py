"""What is random belongs to the case: designs, blocks of draws, generators, cuts."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from safestart.campaign.case import Case, uniform_run
from safestart.campaign.cuts import packed, runs
from safestart.campaign.design import Design, Drawn, Factorial, Repeated


def test_a_case_draws_what_seed_index_and_stream_say() -> None:
    drawn = Case(3, 7).generator().standard_normal(1000)
    literal = np.random.Generator(np.random.Philox(key=7, counter=[0, 0, 3, 1]))
    np.testing.assert_array_equal(drawn, literal.standard_normal(1000))
    flights = np.random.Generator(np.random.Philox(key=7, counter=[0, 0, 3, 0]))
    for other in (Case(4, 7).generator(), Case(3, 8).generator(), Case(3, 7).generator(1), flights):
        assert not np.isin(other.standard_normal(1000), drawn).any()


@given(first=st.integers(0, 500), count=st.integers(0, 200), block=st.integers(20, 60))
def test_a_run_is_a_piece_of_the_whole(first: int, count: int, block: int) -> None:
    whole = uniform_run(5, (2,), 0, 700, block)
    np.testing.assert_array_equal(uniform_run(5, (2,), first, count, block), whole[first : first + count])
    assert (np.abs(whole) <= 1.0).all()
    assert len(np.unique(whole)) == 700
    assert not np.isin(uniform_run(5, (3,), 0, 700, block), whole).any()


DRAWN = {"rate": (1.0, 5.0), "range": (30.0, 150.0), "side": (-1.0, 1.0)}
DESIGNS: dict[str, Design] = {
    "repeated": Repeated(230),
    "factorial": Factorial({"thrust": [0.1, 0.2], "rate": [1.0, 2.0, 3.0], "start": range(40)}),
    "drawn": Drawn(DRAWN, 230, 9),
    "stratified": Drawn(DRAWN, 230, 9, stratified=True),
}


@pytest.mark.parametrize("name", DESIGNS)
def test_a_design_does_not_depend_on_the_run(name: str) -> None:
    design = DESIGNS[name]
    whole = design.parameters(0, len(design))
    assert len(whole) == len(design)
    for first, count in ((0, 1), (99, 2), (100, 100), (200, 30), (229, 1), (17, 0)):
        assert design.parameters(first, count) == whole[first : first + count]


def test_every_combination_once_the_first_axis_slowest() -> None:
    design = Factorial({"thrust": [0.1, 0.2], "rate": [1.0, 2.0, 3.0]})
    assert len(design) == 6
    rows = [tuple(values.values()) for values in design.parameters(0, 6)]
    assert rows == [(thrust, rate) for thrust in (0.1, 0.2) for rate in (1.0, 2.0, 3.0)]
    assert list(design.at(4)) == ["thrust", "rate"]


@pytest.mark.parametrize("stratified", [False, True])
def test_draws_fill_their_ranges(stratified: bool) -> None:
    rows = Drawn(DRAWN, 230, 9, stratified).parameters(0, 230)
    for name, (low, high) in DRAWN.items():
        share = (np.array([row[name] for row in rows]) - low) / (high - low)
        assert 0.0 <= share.min() < 0.03 < 0.97 < share.max() <= 1.0
        strata = [sorted(np.floor(share[k : k + n] * n).astype(int)) for k, n in ((0, 100), (200, 30))]
        assert (strata == [list(range(100)), list(range(30))]) is stratified
    assert Drawn(DRAWN, 230, 10, stratified).parameters(0, 1) != rows[:1]


@given(total=st.integers(0, 1000), most=st.integers(1, 100))
def test_runs_cover_every_case_once(total: int, most: int) -> None:
    cut = runs(total, most)
    assert [first + k for first, count in cut for k in range(count)] == list(range(total))
    assert all(1 <= count <= most for _, count in cut)


@given(st.integers(1, 6), st.integers(1, 5), st.integers(1, 40), st.integers(1, 60))
def test_packed_shards_hold_every_case_once(groups: int, cells: int, cases: int, most: int) -> None:
    shards = packed(groups, cells, cases, most)
    seen = [(cell, first + k) for shard in shards for cell, first, count in shard for k in range(count)]
    assert seen == [(cell, k) for cell in range(groups * cells) for k in range(cases)]
    assert all(shard for shard in shards)
    for shard in shards:
        assert sum(count for _, _, count in shard) <= most
        if cells * cases <= most:
            held = {cell // cells for cell, _, _ in shard}
            assert sum(count for _, _, count in shard) == len(held) * cells * cases, "no group is cut"
