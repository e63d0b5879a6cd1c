"""The forward engine against the literal recursion, and as an outer bound of the backward engine."""

import math

import numpy as np
import pytest

from benchmarks.peers.literal_forward import literal_map
from safestart.engines.backward import Backward
from safestart.engines.base import Problem
from safestart.engines.forward import Forward, constants, template
from safestart.engines.sampled import steps
from safestart.model.scenario import (
    Bools,
    Chaser,
    CorridorShape,
    Floats,
    Grid,
    Rest,
    Scenario,
    SetKind,
    Target,
)
from safestart.runtime.progress import Context
from safestart.sets.cone import directions
from tests.unit.engines.vertex_twin import target_vertices, vertex_margin


def unrestricted(problem: Problem) -> Floats:
    return Forward().solve(problem, Context()).arrays["margin_unrestricted"]


def masks(problem: Problem) -> tuple[Bools, Bools]:
    backward, forward = Backward().solve(problem, Context()).mask, Forward().solve(problem, Context()).mask
    assert backward is not None
    assert forward is not None
    return backward, forward


class TestLiteralRecursion:
    @pytest.mark.parametrize("rest", Rest)
    @pytest.mark.parametrize("rate", [0.0, 3.0, 5.0])
    def test_verdicts_and_supports(self, rate: float, rest: Rest) -> None:
        problem = Problem(Scenario.of(rate, 0.1), rest=rest)
        cells = slice(3, None, 23)
        verdicts, supports = literal_map(problem, cells)
        ours = vertex_margin(problem).ravel()[cells]
        np.testing.assert_array_equal(ours >= 0.0, verdicts)
        (step,) = steps(problem)
        lvlh = problem.points().reshape(-1, 2)[cells] @ step.drift.T
        collapsed = lvlh @ directions(template()).T + constants(step, template(), 0.1)
        np.testing.assert_allclose(collapsed, supports, rtol=1e-11, atol=1e-9)

    def test_both_verdicts_occur(self) -> None:
        ours = vertex_margin(Problem(Scenario.of(3.0, 0.1)))
        assert 50 < (ours >= 0.0).sum() < 900


class TestOuter:
    @pytest.mark.parametrize("kind", SetKind)
    @pytest.mark.parametrize("rest", Rest)
    @pytest.mark.parametrize("rate", [0.0, 1.0, 3.0, 5.0, 12.0])
    def test_contains_the_backward_set(self, rate: float, rest: Rest, kind: SetKind) -> None:
        problem = Problem(Scenario.of(rate, 0.1), rest=rest, kind=kind)
        inner = Backward().solve(problem, Context()).arrays["margin_unrestricted"]
        assert (unrestricted(problem) >= inner - 1e-9).all()
        backward, forward = masks(problem)
        assert not (backward & ~forward).any()

    def test_is_larger_somewhere(self) -> None:
        scenario = Scenario(Target(math.radians(5.0), 1.3e-3), Chaser(0.1), CorridorShape(c_x=0.1))
        problem = Problem(scenario, Grid(61, 61, 150.0))
        inner = Backward().solve(problem, Context()).arrays["margin_unrestricted"]
        assert (unrestricted(problem) - inner).max() > 1e-3


class TestVertexCriterion:
    def test_implies_that_the_polygon_meets_the_corridor(self) -> None:
        for rate in (0.0, 1.0, 3.0, 5.0):
            scenario = Scenario.of(rate, 0.1)
            vertex, meets = vertex_margin(Problem(scenario)), unrestricted(Problem(scenario))
            assert not ((vertex >= 0.0) & (meets < -1e-9)).any()

    def test_is_not_a_necessary_condition(self) -> None:
        """The paper calls it one; starts that truly reach the corridor fail it, in the middle of the cone."""
        problem = Problem(Scenario.of(1.0, 0.1))
        truly, _ = masks(problem)
        vertex = vertex_margin(problem) >= 0.0
        assert (truly & ~vertex).sum() > 100

    def test_target_is_the_corridor_cut_at_the_grid(self) -> None:
        expected = [[-2.5, 0.5], [2.5, 0.5], [226.75, 150.0], [-226.75, 150.0]]
        np.testing.assert_allclose(target_vertices(CorridorShape(), 150.0), expected)
