"""Separating-direction tests against brute force over the angle, for zonotopes and template polygons."""

import math

import numpy as np
import pytest
from scipy.optimize import linprog

from safestart.constraints.corridor import corridor_of
from safestart.model.scenario import CorridorShape, Floats
from safestart.sets import template, zonotope
from safestart.sets.cone import DualArc, directions
from safestart.sets.cone_meets import MeetArc
from safestart.sets.meet_kernel import meet_margins

SHAPES = [CorridorShape(), CorridorShape(c_x=0.2, x0=0.0, hold_radius=4.0), CorridorShape(c_x=8.0, x0=6.0)]


def brute(support: Floats, angles: Floats, positions: Floats, arc: DualArc) -> Floats:
    values = positions @ directions(angles).T + support + arc.offset(angles)
    return np.asarray(values.min(axis=1))


def margin_twin(arc: MeetArc, position: Floats) -> float:
    """Plain NumPy twin of the kernel, without its short cut: every piece is searched for a corner."""
    unit = directions(arc.angles)
    best = math.inf
    for j, vertex in enumerate(arc.vertices):
        v = position + vertex
        best = min(best, float(unit[j] @ v), float(unit[j + 1] @ v))
        facing = math.atan2(-v[0], -v[1])
        if arc.angles[j] <= facing <= arc.angles[j + 1]:
            best = min(best, -math.hypot(*v))
    return best


@pytest.fixture(params=range(len(SHAPES)))
def arc(request: pytest.FixtureRequest) -> DualArc:
    return DualArc.of(SHAPES[request.param])


@pytest.fixture
def positions() -> Floats:
    return np.random.default_rng(3).uniform(-60.0, 60.0, (200, 2))


class TestArc:
    @pytest.mark.parametrize("shape", SHAPES)
    def test_offset_is_the_infimum_over_the_corridor(self, shape: CorridorShape) -> None:
        arc = DualArc.of(shape)
        corridor = corridor_of(shape)
        for a in arc.nodes(9):
            # Just inside the arc's end the program is bounded; at the end it is so up to round-off.
            d = directions(np.array(0.999999 * a))
            found = linprog(d, A_ub=corridor.normals, b_ub=corridor.offsets, bounds=(None, None))
            assert found.fun == pytest.approx(-float(arc.offset(np.array(0.999999 * a))), abs=1e-9)

    def test_middle_node_is_zero(self) -> None:
        nodes = DualArc.of(SHAPES[0]).nodes(33)
        assert nodes[16] == 0.0
        assert nodes[-1] == -nodes[0] == math.atan(1.0 / 1.5)


class TestZonotope:
    @pytest.mark.parametrize("count", [0, 1, 2, 7, 40])
    def test_margin_is_the_least_over_all_angles(self, arc: DualArc, positions: Floats, count: int) -> None:
        generators = np.random.default_rng(count).normal(0.0, 4.0, (count, 2))
        angles = np.linspace(-arc.half_angle, arc.half_angle, 20001)
        expected = brute(zonotope.support(generators, directions(angles)), angles, positions, arc)
        found = zonotope.meet_arc(generators, arc).margin(positions)
        assert (found <= expected + 1e-9).all()
        np.testing.assert_allclose(found, expected, atol=5e-3)

    def test_parallel_and_axis_aligned_generators(self, arc: DualArc, positions: Floats) -> None:
        generators = np.array([[1.0, 0.0], [2.0, 0.0], [-3.0, 0.0], [0.0, 2.0], [0.0, -1.0], [0.0, 0.0]])
        merged = np.array([[6.0, 0.0], [0.0, 3.0]])
        one, other = zonotope.meet_arc(generators, arc), zonotope.meet_arc(merged, arc)
        np.testing.assert_allclose(one.margin(positions), other.margin(positions), atol=1e-12)
        assert len(one.angles) == 3

    def test_sign_of_generators_does_not_matter(self, arc: DualArc, positions: Floats) -> None:
        generators = np.random.default_rng(9).normal(0.0, 3.0, (12, 2))
        flipped = generators * np.where(np.arange(12) % 2, 1.0, -1.0)[:, None]
        one, other = zonotope.meet_arc(generators, arc), zonotope.meet_arc(flipped, arc)
        np.testing.assert_allclose(one.margin(positions), other.margin(positions), atol=1e-12)


class TestKernel:
    def test_against_its_twin(self, arc: DualArc, positions: Floats) -> None:
        meet = zonotope.meet_arc(np.random.default_rng(4).normal(0.0, 3.0, (15, 2)), arc)
        found = np.empty(len(positions))
        meet_margins(positions, directions(meet.angles), meet.vertices, found)
        np.testing.assert_allclose(found, [margin_twin(meet, p) for p in positions], atol=1e-12)
        assert (found < 0.0).any()
        assert (found > 0.0).any()

    def test_nearest_corner(self) -> None:
        arc = DualArc.of(CorridorShape())
        point = zonotope.meet_arc(np.zeros((0, 2)), arc)
        found = point.margin(np.array([[-3.5, -1.5], [0.0, -3.0], [10.0, 0.5], [0.0, 10.0]]))
        inside = (2.5 + 1.5 * 9.5) / math.hypot(1.0, 1.5)
        np.testing.assert_allclose(found, [-math.hypot(1, 2), -3.5, -7.5 / math.hypot(1.0, 1.5), inside])


class TestTemplate:
    @pytest.mark.parametrize("turn", [0.0, 0.4, 3.0, -9.0])
    def test_polygon_meets_corridor_as_a_linear_program_says(self, arc: DualArc, turn: float) -> None:
        generators = np.random.default_rng(5).normal(0.0, 3.0, (10, 2))
        angles = 2.0 * np.pi * np.arange(12) / 12 + turn
        supports = zonotope.support(generators, directions(angles))
        meet = template.meet_arc(angles, supports, arc)
        shape = next(s for s in SHAPES if DualArc.of(s) == arc)
        corridor = corridor_of(shape)
        faces = np.vstack([directions(angles), corridor.normals])
        positions = np.random.default_rng(6).uniform(-60.0, 60.0, (60, 2))
        margins = meet.margin(positions)
        for q, margin in zip(positions, margins, strict=True):
            bounds = np.concatenate([supports + directions(angles) @ q, corridor.offsets])
            program = linprog([0.0, 0.0], A_ub=faces, b_ub=bounds, bounds=(None, None))
            if abs(margin) > 1e-6:
                assert (program.status == 0) == (margin > 0.0)
        assert (margins > 0.0).any()
        assert (margins < 0.0).any()

    def test_outer(self, arc: DualArc, positions: Floats) -> None:
        generators = np.random.default_rng(8).normal(0.0, 3.0, (10, 2))
        angles = 2.0 * np.pi * np.arange(48) / 48
        outer = template.meet_arc(angles, zonotope.support(generators, directions(angles)), arc)
        inner = zonotope.meet_arc(generators, arc)
        gap = outer.margin(positions) - inner.margin(positions)
        assert (gap >= -1e-9).all()
        assert gap.max() > 1e-3
