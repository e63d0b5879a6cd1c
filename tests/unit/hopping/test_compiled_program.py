"""The compiled program of the hopping MPC beside Clarabel's, and the barrier's compiled rows beside plain NumPy."""

import math
from dataclasses import replace

import numpy as np
import pytest

from safestart.hopping.approach import line
from safestart.hopping.barrier import Barrier, Noise
from safestart.hopping.compiled_program import CompiledProgram
from safestart.hopping.hop_program import HopProgram, Weights
from safestart.hopping_flights.fly import World

NOISE = Noise(0.5, 1e-3, 0.01, math.radians(0.5))


def _asked(angle: float, k: int, rng):
    """Arguments of a program at the start of hop ``k``, from a state that is off."""
    world = World(angle_deg=angle, noise=NOISE, barrier="tightened", kappa=3.0)
    steer = world.controller()
    d = steer.distances
    state = np.concatenate(
        [
            d[k] * line(angle) * (1.0 + 0.02 * rng.standard_normal()) + rng.standard_normal(3),
            0.05 * rng.standard_normal(3),
        ]
    )
    return steer, (
        world.mean_motion,
        steer.axes,
        d[k + 1 :],
        steer._times(state, d[k + 1 :]),
        state,
        Weights(),
    )


def _cost(program: HopProgram, u, barrier=None) -> float:
    """The cost of impulses, slacks at their least."""
    off, two = program.tracked @ u - program.targets, np.isfinite(program.tolerance)
    values = program.soft @ u + program.level
    slack = np.where(
        two, np.maximum(np.abs(values) - np.where(two, program.tolerance, 0.0), 0.0), np.maximum(-values, 0.0)
    )
    breach = 0.0 if barrier is None else max(0.0, -float((barrier[0] @ u[:3] + barrier[1]).min()))
    heavy = 100.0 * program.weights.soft
    return float(np.abs(u).sum() + (program.costs * off**2).sum() + program.scales @ slack + heavy * breach)


@pytest.mark.parametrize("angle", [0.0, 40.0, 90.0, 130.0])
def test_it_costs_no_more_than_what_clarabel_finds(angle: float) -> None:
    rng = np.random.default_rng(int(angle))
    for k in (0, 2, 4, 5):
        for _ in range(3):
            steer, asked = _asked(angle, k, rng)
            plain = HopProgram(*asked)
            theirs, ours = plain.solve(), CompiledProgram(*asked).solve()
            assert theirs.solved
            assert ours.solved
            best = _cost(plain, theirs.impulses.ravel())
            assert _cost(plain, ours.impulses.ravel()) <= best + 1e-6 * (1.0 + best)
            # With rows on the first impulse, in a box.
            first = ours.impulses[0]
            values, slopes = steer.barrier.rows(asked[4], first)
            which = steer.barrier.worst(values)
            rows = slopes[which], values[which] - slopes[which] @ first
            near = first, max(0.2 * float(np.abs(first).max()), 0.02)
            theirs, ours = plain.solve(rows, near), CompiledProgram(*asked).solve(rows, near)
            best = _cost(plain, theirs.impulses.ravel(), rows)
            assert _cost(plain, ours.impulses.ravel(), rows) <= best + 1e-6 * (1.0 + best)
            assert np.abs(ours.impulses[0] - first).max() <= near[1] + 1e-7


@pytest.mark.parametrize("angle", [0.0, 40.0])
def test_it_is_assembled_as_the_plain_one(angle: float) -> None:
    _, asked = _asked(angle, 1, np.random.default_rng(3))
    plain, (square, lean, rows, level, edge, both, weight) = HopProgram(*asked), CompiledProgram(*asked).parts
    gram = (plain.tracked * plain.costs[:, None]).T @ plain.tracked
    assert square == pytest.approx(2.0 * gram, rel=1e-9, abs=1e-6)
    assert lean == pytest.approx(-2.0 * plain.tracked.T @ (plain.costs * plain.targets), rel=1e-9, abs=1e-6)
    assert rows == pytest.approx(plain.soft, rel=1e-9, abs=1e-8)
    assert level == pytest.approx(plain.level, rel=1e-9, abs=1e-8)
    assert (both == np.isfinite(plain.tolerance)).all()
    assert edge[both] == pytest.approx(plain.tolerance[both])
    assert weight == pytest.approx(plain.scales)


def test_bounds_on_impulses_are_left_to_clarabel() -> None:
    _, asked = _asked(40.0, 0, np.random.default_rng(5))
    free = CompiledProgram(*asked).solve().impulses
    limits = replace(Weights(), most=0.5 * float(np.abs(free).max()))
    bounded = CompiledProgram(*asked[:5], limits).solve().impulses
    assert np.abs(bounded).max() <= limits.most + 1e-6
    assert bounded == pytest.approx(HopProgram(*asked[:5], limits).solve().impulses, abs=1e-12)


def test_the_barriers_rows_are_those_of_plain_numpy() -> None:
    barrier, rng = Barrier(8.66e-4, 50.0, 3.0, NOISE), np.random.default_rng(7)
    state, impulse = rng.normal(0.0, 100.0, 6) * np.repeat([1.0, 1e-3], 3), rng.normal(0.0, 0.1, 3)
    values, slopes = barrier.rows(state, impulse)
    after = state + np.concatenate([np.zeros(3), impulse])
    there = barrier.phi @ after
    p, v = there[:, :3], there[:, 3:]
    distance = np.linalg.norm(p, axis=1)
    q = np.einsum("ti,tij->tj", p / distance[:, None], barrier.phi[:, :3])
    ahead = (q[:, 3:] @ impulse) ** 2
    across = (impulse @ impulse) * (q[:, 3:] ** 2).sum(axis=1) - ahead
    spread = np.sqrt(
        NOISE.position**2 * (q[:, :3] ** 2).sum(axis=1)
        + NOISE.velocity**2 * (q[:, 3:] ** 2).sum(axis=1)
        + NOISE.share**2 * ahead
        + NOISE.angle**2 * across
    )
    scale, radius = 2.0 * barrier.alpha * 50.0, 50.0 + 3.0 * spread
    plain = (2.0 * (p * v).sum(axis=1) + barrier.alpha * (distance**2 - radius**2)) / scale
    assert values == pytest.approx(plain, rel=1e-9, abs=1e-9)
    # The slope leaves the change of the spread out: against differences with kappa = 0.
    still = Barrier(8.66e-4, 50.0, 0.0, NOISE)
    for axis in range(3):
        step = 1e-4 * np.eye(3)[axis]
        change = (still.rows(state, impulse + step)[0] - still.rows(state, impulse - step)[0]) / 2e-4
        assert slopes[:, axis] == pytest.approx(change, rel=1e-6, abs=1e-5)
