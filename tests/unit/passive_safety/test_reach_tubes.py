"""Reach tubes of the switched rendezvous: sound against simulations, tight, and able to fail."""

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import linprog

from benchmarks.peers.reach_audit import drift_excess, powered_excess, random_starts
from safestart.passive_safety.flights.independent_flight import replay
from safestart.passive_safety.flights.simulate import active, crossing_times, drifted, flown
from safestart.passive_safety.model import PUBLISHED, Dynamics, Mode, Motion, matrix
from safestart.passive_safety.question import Question
from safestart.passive_safety.reach import chord_error as interpolation
from safestart.passive_safety.reach import crossing, passive
from safestart.passive_safety.reach.flow import flow_at, flow_table, growth
from safestart.passive_safety.reach.reach_set import reach
from safestart.passive_safety.reach.separation import planar_clearance, timed_clearance
from safestart.passive_safety.reach.tube import Tube, propagate
from safestart.passive_safety.switching_guard import FACE_LIMITS, FACE_NAMES, FACES
from safestart.passive_safety.verify import bracket

WHOLE = Question(window=(0.0, 300.0))
FROM_THE_SIDE = Question(centre=(-200.0, -900.0, 0.0, 0.0), half=(10.0, 10.0, 0.0, 0.0), window=(0.0, 200.0))
AT_A_CORNER = Question(centre=(-900.0, -520.0, 0.0, 0.0), half=(25.0, 25.0, 0.0, 0.0), window=(0.0, 200.0))


def test_closed_loop_is_the_published_one() -> None:
    """Rows of the competition's closed-loop files, as far as they print them."""
    assert matrix(Motion(Mode.FAR))[2] == pytest.approx(
        [-0.057599765881773, 0.000200959896519766, -2.89995083970656, 0.00877200894463775], rel=1e-13
    )
    assert matrix(Motion(Mode.NEAR))[2] == pytest.approx(
        [-0.575999943070835, 0.000262486079431672, -19.2299795908647, 0.00876275931760007], rel=1e-13
    )


@pytest.mark.parametrize("mode", list(Mode))
def test_exponentials(mode: Mode) -> None:
    motion = Motion(mode)
    a = matrix(motion)
    table = flow_table(motion, Fraction(3, 5), Fraction(1, 4), 300)
    for k in (0, 7, 255, 256, 300):
        there = expm(a * (0.6 + 0.25 * k))
        assert table.phi[k] == pytest.approx(there, rel=1e-9, abs=1e-12)
        assert table.psi[k] == pytest.approx(a @ a @ there, rel=1e-9, abs=1e-11)
        assert flow_at(motion, 0.6 + 0.25 * k)[0] == pytest.approx(table.phi[k], rel=1e-12, abs=1e-14)
    bound = growth(motion, Fraction(8))
    assert all((np.abs(expm(a * s)) <= bound * (1 + 1e-12)).all() for s in np.linspace(0.0, 8.0, 101))


def test_simulation_is_the_exponential() -> None:
    start = np.array([[-880.0, -420.0, 0.0, 0.0]])
    entered = crossing_times(PUBLISHED, start, 300.0)
    for abort, time in ((50.0, 50.0), (50.0, 200.0), (240.0, 260.0), (110.3, 130.0), (300.0, 300.0)):
        flight = active(PUBLISHED, start, entered, np.array([abort]))
        there = replay(PUBLISHED, start[0], abort, time)
        assert drifted(Dynamics.LINEAR, flight, np.array(time - abort))[0] == pytest.approx(
            there[:2], rel=1e-9, abs=1e-9
        )
    assert crossing_times(PUBLISHED, start, 300.0, bracket(reach(WHOLE))) == pytest.approx(entered, abs=1e-9)


@pytest.mark.parametrize("question", [WHOLE, FROM_THE_SIDE, AT_A_CORNER], ids=["face", "side", "corner"])
def test_no_simulated_flight_leaves_its_tube(question: Question) -> None:
    tubes = reach(question)
    assert tubes.entry.reason == ""
    assert powered_excess(question, tubes, 2000, 7) <= 0.0


def test_every_crossing_is_on_a_face_that_has_a_branch() -> None:
    starts = random_starts(AT_A_CORNER, 500, 3)
    entered = crossing_times(PUBLISHED, starts, 300.0)
    tubes = reach(AT_A_CORNER)
    assert len(tubes.branches) > 1
    heights = flown(Motion(Mode.FAR), starts, entered)[:, :2] @ FACES.T - FACE_LIMITS
    assert {FACE_NAMES[face] for face in heights.argmax(axis=1)} <= {
        branch.crossing.name for branch in tubes.branches
    }
    assert (entered >= tubes.entry.first).all()
    assert (entered <= tubes.entry.last).all()


def test_no_simulated_drift_leaves_its_cell() -> None:
    tubes = reach(WHOLE)
    for level in (0, 3, 5):
        assert drift_excess(WHOLE, tubes, 2000, 11, level) <= 0.0


def without_curvature(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(interpolation, "chord_error", lambda _, second: 0.0 * second)


def without_guard_remainder(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(crossing, "remainder", lambda *_: np.zeros(4))


def without_second_order(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = crossing.second_order
    monkeypatch.setattr(crossing, "second_order", lambda *given: scaled(whole(*given)))


def scaled(curve: crossing.Quadratic) -> crossing.Quadratic:
    return crossing.Quadratic(0.0 * curve.constant, 0.0 * curve.linear, 0.0 * curve.products)


def without_bin_width(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(passive, "sweep", lambda low, _, bend: (0.0 * low[0], 0.0 * bend))


@pytest.mark.parametrize("leave_out", [without_curvature, without_second_order, without_guard_remainder])
def test_leaving_out_a_bound_is_caught_by_flights(
    leave_out: Callable[[pytest.MonkeyPatch], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    leave_out(monkeypatch)
    assert powered_excess(WHOLE, reach(WHOLE), 500, 7) > 1e-4


@pytest.mark.parametrize("leave_out", [without_curvature, without_second_order, without_bin_width])
def test_leaving_out_a_bound_is_caught_by_drifts(
    leave_out: Callable[[pytest.MonkeyPatch], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    leave_out(monkeypatch)
    assert drift_excess(WHOLE, reach(WHOLE), 2000, 2, 5) > 1e-4


def greatest(tube: Tube, starts: np.ndarray, rows: np.ndarray, inside: int = 8) -> np.ndarray:
    """Greatest values (n, r) of ``rows`` over each segment: flights from ``starts`` at ``inside`` + 1 times of it."""
    times = tube.start + tube.step * np.arange(tube.steps * inside + 1) / inside
    values = np.max([flown(tube.motion, start, times) @ rows.T for start in starts], axis=0)
    return np.max([values[k : len(values) - inside + k : inside] for k in range(inside + 1)], axis=0)


def test_tube_is_within_five_percent_of_the_hull_of_dense_simulations() -> None:
    """Positions and velocities, in every segment of both modes, from the first one on."""
    centre, gens = WHOLE.set()
    side = np.linspace(-1.0, 1.0, 17)
    ends = np.ones_like(side)
    edges = np.concatenate([np.stack(pair, axis=1) for pair in ((side, ends), (ends, side))])
    starts = (
        centre
        + np.concatenate([edges, -edges, np.stack(np.meshgrid(side[::4], side[::4]), -1).reshape(-1, 2)])
        @ gens
    )
    tubes = reach(Question())
    (branch,) = tubes.branches
    crossed = flown(Motion(Mode.FAR), starts, crossing_times(PUBLISHED, starts, 300.0))
    rows = np.vstack([np.eye(4), -np.eye(4)])
    for tube, origin in ((tubes.far, starts), *((tube, crossed) for tube in branch.tubes)):
        hull, upper = greatest(tube, origin, rows), tube.upper(rows)
        assert (upper >= hull - 1e-9).all()
        width = hull[:, :4] + hull[:, 4:]
        assert (upper[:, :4] + upper[:, 4:] < 1.05 * width).all()


@pytest.mark.parametrize("mode", [Mode.FAR, Mode.NEAR])
@pytest.mark.parametrize("step", [Fraction(1, 40), Fraction(1, 4)])
def test_no_flight_exceeds_a_row_between_nodes(mode: Mode, step: Fraction) -> None:
    """Small sets at long steps, where the excess is nearly all of the width; what lies between nodes is bounded."""
    random = np.random.default_rng(8)
    corners = np.array(list(product([-1.0, 1.0], repeat=2)))
    rows = np.vstack([np.eye(4), -np.eye(4), random.normal(size=(6, 4))])
    caught = 0.0
    for _ in range(20):
        centre, gens = (
            random.normal(size=4) * [50, 50, 3, 3],
            random.normal(size=(2, 4)) * [0.1, 0.1, 0.01, 0.01],
        )
        tube = propagate(Motion(mode), centre, gens, Fraction(0), step, 40)
        hull = greatest(tube, centre + corners @ gens, rows, 32)
        assert (tube.upper(rows) >= hull - 1e-9).all()
        caught = max(caught, float((hull - replace(tube, second=0.0 * tube.second).upper(rows)).max()))
    # And there is something to bound.
    assert caught > 1e-6


def test_rows_over_segments_are_those_of_the_twin() -> None:
    random = np.random.default_rng(9)
    rows = np.vstack([np.eye(4), -np.eye(4), random.normal(size=(6, 4))])
    for tube in (reach(WHOLE).far, *reach(WHOLE).branches[0].tubes):
        assert tube.upper(rows) == pytest.approx(twin_upper(tube, rows), rel=1e-12, abs=1e-12)


def twin_upper(tube: Tube, rows: np.ndarray) -> np.ndarray:
    """:meth:`Tube.upper` in NumPy, without round-off."""
    a, h = matrix(tube.motion), tube.step

    def ends(lines: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        middle, wide = tube.centre @ lines.T, np.abs(tube.gens @ lines.T).sum(axis=1)
        return middle - wide, middle + wide

    def widest(values: np.ndarray) -> np.ndarray:
        return np.maximum(values[:-1], values[1:])

    (low, high), (slow, fast), (dip, hump) = ends(rows), ends(rows @ a), ends(rows @ a @ a)
    sway = tube.third @ np.abs(rows.T)
    rough = tube.bend @ np.abs(rows.T)
    steep = h * (np.minimum(widest(fast), widest(-slow)) + h**2 / 8.0 * sway)
    chord = h**2 / 8.0 * (widest(-dip) + 0.5 * h * sway)
    concave = -widest(hump) - 0.5 * h * sway
    leaves = np.maximum(0.0, np.minimum(fast[:-1], -slow[1:]))
    peak = np.where(concave > 0.0, leaves**2 / (2.0 * np.where(concave > 0.0, concave, 1.0)), np.inf)
    closer = np.minimum(rough, np.maximum(0.0, np.minimum(np.minimum(steep, chord), peak)))
    width = 0.5 * (high - low)[1:] + 0.5 * np.abs(high[1:] - high[:-1])
    return widest(high) + widest(tube.noise @ np.abs(rows.T)) + np.where(rough > 0.01 * width, closer, rough)


def test_interpolation_bound_converges_with_order_two() -> None:
    centre, gens = WHOLE.set()
    bends = [
        float(propagate(Motion(Mode.FAR), centre, gens, Fraction(0), step, 64).bend[0, 0])
        for step in (Fraction(1, 20), Fraction(1, 40))
    ]
    assert bends[0] / bends[1] == pytest.approx(4.0, rel=0.15)


def test_planar_clearance_is_the_distance() -> None:
    """Against linear programs: the least max-norm of a point of the zonotope."""
    random = np.random.default_rng(1)
    for _ in range(40):
        centre, gens, box = random.normal(size=2) * 4.0, random.normal(size=(5, 2)), random.uniform(0, 0.3, 2)
        whole = np.vstack([gens, np.diag(box)])
        got = planar_clearance(centre[None], gens[None], box[None])[0]
        rows = np.block([[whole.T, -np.ones((2, 1))], [-whole.T, -np.ones((2, 1))]])
        limits = np.concatenate([-centre, centre])
        lp = linprog(np.eye(8)[7], rows, limits, bounds=[(-1, 1)] * 7 + [(0, None)])
        # Nearest points at a corner of the square need a diagonal of it, which no face normal is.
        assert got <= lp.fun + 1e-9
        assert (got > 0.0) == (lp.fun > 1e-9)


def test_timed_clearance_sees_only_members_inside_the_window() -> None:
    gens = np.array([[[1.0, 0.0], [0.0, 0.1]]])
    clock_gens = np.array([[1.0, 0.0]])
    centre, box = np.array([[1.0, 0.0]]), np.zeros((1, 2))
    # x = 1 + w, clock = 10 + w: the origin is met at clock 9 only.
    assert planar_clearance(centre, gens, box)[0] <= 0.0
    timed = timed_clearance(centre, gens, box, np.array([10.0]), clock_gens, (9.5, 11.0))[0]
    assert timed == pytest.approx(0.5, abs=1e-9)
    assert timed_clearance(centre, gens, box, np.array([10.0]), clock_gens, (8.0, 11.0))[0] <= 0.0
    assert timed_clearance(centre, gens, box, np.array([10.0]), clock_gens, (12.0, 13.0))[0] == np.inf
