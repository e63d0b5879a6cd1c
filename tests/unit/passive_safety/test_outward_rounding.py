"""Round-off of every stage of a proof against exact arithmetic: balls of 300 bits from the exact matrices."""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from fractions import Fraction

import flint
import numpy as np
import pytest

from safestart.passive_safety.model import Mode, Motion, exact_matrix
from safestart.passive_safety.question import Question
from safestart.passive_safety.reach.crossing import Crossing
from safestart.passive_safety.reach.flow import flow_at
from safestart.passive_safety.reach.passive import DRIFT_STEP, cell_positions, flow_steps, make_bins
from safestart.passive_safety.reach.reach_set import reach
from safestart.passive_safety.reach.rounding import SLACK
from safestart.passive_safety.reach.separation import planar_clearance, timed_clearance

QUESTION = Question(half=(25.0, 25.0, 0.02, 0.02), window=(0.0, 240.0))
TUBES = reach(QUESTION)


@pytest.fixture(autouse=True)
def _precise() -> Iterator[None]:
    before = flint.ctx.prec
    flint.ctx.prec = 300
    yield
    flint.ctx.prec = before


def ball(value: Fraction | float) -> flint.arb:
    exact = Fraction(value)
    return flint.arb(flint.fmpq(exact.numerator, exact.denominator))


def flow(motion: Motion, time: Fraction) -> flint.arb_mat:
    a = flint.arb_mat([[ball(entry) for entry in row] for row in exact_matrix(motion)])
    return (a * ball(time)).exp()


def column(values: np.ndarray) -> flint.arb_mat:
    return flint.arb_mat([[ball(float(v))] for v in values])


def support(sets: list[flint.arb_mat], row: np.ndarray) -> flint.arb:
    """Support of a zonotope, centre first, in the direction of ``row``."""
    parts = [sum((ball(float(r)) * s[i, 0] for i, r in enumerate(row)), flint.arb(0)) for s in sets]
    return parts[0] + sum((abs(part) for part in parts[1:]), flint.arb(0))


def test_nodes_of_tubes_and_their_supports() -> None:
    centre, gens = QUESTION.set()
    tube = TUBES.far
    rows = np.vstack([np.eye(4), np.random.default_rng(0).normal(size=(4, 4))])
    for k in (0, 1, 77, 300, tube.steps):
        power = flow(tube.motion, Fraction(k, 5))
        exact = [power * column(z) for z in (centre, *gens)]
        for ours, there in zip((tube.centre[k], *tube.gens[k]), exact, strict=True):
            off = [abs(float(ball(float(v)) - there[i, 0])) for i, v in enumerate(ours)]
            assert (np.array(off) <= 0.1 * tube.noise[k]).all()
        for row in rows:
            assert tube.node_upper(row[None], k)[0] >= float(support(exact, row).upper())


def test_crossing_is_the_projection_along_the_flow() -> None:
    (branch,) = TUBES.branches
    crossing: Crossing = branch.crossing
    centre, gens = QUESTION.set()
    middle = Fraction(0.5 * (crossing.first + crossing.last))
    motion = Motion(Mode.FAR)
    # The exact first-order projection at another time agrees to second order: inside the box of remainders.
    power = flow(motion, middle)
    a = np.array([[float(v) for v in row] for row in exact_matrix(motion)])
    nominal = power * column(centre)
    f = flint.arb_mat([[ball(float(v)) for v in row] for row in a]) * nominal
    for z, ours in zip(gens, crossing.gens, strict=False):
        there = power * column(z)
        share = there[0, 0] / f[0, 0]
        moved = [float(there[i, 0] - share * f[i, 0]) for i in range(4)]
        assert np.abs(np.array(moved) - ours) == pytest.approx(0.0, abs=0.02 * np.abs(ours).max())
        assert ours[0] == pytest.approx(0.0, abs=float(crossing.gens[-4, 0]))


@pytest.mark.parametrize("tube", [TUBES.far, TUBES.branches[0].tubes[-1]], ids=["mode 1", "mode 2"])
def test_cells_hold_the_exact_drift_of_their_bins(tube) -> None:
    bins = make_bins(tube, TUBES.branches[0].clock, 2, np.array([3, 40]))
    steps = flow_steps(QUESTION.horizon)
    for pick, level, block in ((0, 0, 11), (1, 2, 7)):
        centre, gens, box = cell_positions(bins, np.array([pick]), level, np.array([block]), steps)
        members = [column(bins.centre[pick]), *(column(g) for g in bins.gens[pick])]
        for end in (block, block + 1):
            power = flow(bins.motion, DRIFT_STEP * (1 << level) * end)
            exact = [power * z for z in members]
            for angle in np.linspace(0.0, 6.0, 7):
                row = np.array([np.cos(angle), np.sin(angle)])
                ours = row @ centre[0] + np.abs(gens[0] @ row).sum() + np.abs(row) @ box[0]
                there = float(support(exact, np.array([*row, 0.0, 0.0])).upper())
                assert ours >= there * (1.0 - 1e-15) if there > 0 else ours >= there * (1.0 + 1e-15)


def test_clearance_is_below_the_exact_room_of_its_best_normal() -> None:
    """Boxes that nearly touch, where a rounding the wrong way would show."""
    random = np.random.default_rng(5)
    for _ in range(200):
        gens = random.normal(size=(1, 6, 2)) * 10.0 ** random.integers(-3, 3)
        normal = np.array([-gens[0, 0, 1], gens[0, 0, 0]])
        size = -float(_room(np.zeros(2), gens[0], normal))
        centre = normal / np.abs(normal).max() * size * random.uniform(0.9, 1.5)
        box = np.zeros((1, 2))
        got = float(planar_clearance(centre[None], gens, box)[0])
        candidates = [np.array([-g[1], g[0]]) for g in gens[0]] + [np.array([1.0, 0.0]), np.array([0.0, 1.0])]
        best = max(_room(centre, gens[0], candidate) for candidate in candidates)
        assert Fraction(got) <= best
        assert float(best) - got <= 4.0 * SLACK * (np.abs(centre).sum() + np.abs(gens).sum())
        timed = timed_clearance(centre[None], gens, box, np.zeros(1), np.zeros((1, 6)), (-1.0, 1.0))[0]
        assert Fraction(float(timed)) <= best


def test_tables_are_the_same_from_many_threads_at_once() -> None:
    """The precision is global to the process: without a lock one thread computes with another one's."""
    motion = Motion(Mode.FAR)

    def fresh(k: int) -> np.ndarray:
        return flow_at(motion, 1.0 + k % 4)[0]

    with ThreadPoolExecutor(8) as pool:
        many = list(pool.map(fresh, range(200)))
    for k in range(4, 200):
        assert (many[k] == many[k % 4]).all()
    assert flint.ctx.prec == 300


def _room(centre: np.ndarray, gens: np.ndarray, normal: np.ndarray) -> Fraction:
    n = [Fraction(float(v)) for v in normal]
    along = abs(sum((Fraction(float(c)) * v for c, v in zip(centre, n, strict=True)), Fraction(0)))
    reach_along = sum(
        (abs(Fraction(float(g[0])) * n[0] + Fraction(float(g[1])) * n[1]) for g in gens), Fraction(0)
    )
    return (along - reach_along) / (abs(n[0]) + abs(n[1]))
