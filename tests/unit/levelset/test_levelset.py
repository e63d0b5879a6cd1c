"""One step of the fused level-set solver: kernels against their twin, step length, threads, memory."""

import tracemalloc

import numpy as np
import pytest

from safestart.levelset import (
    Ball,
    Boundary,
    Flux,
    Input,
    Kind,
    Lattice,
    Linear,
    March,
    Options,
    Scheme,
    solve,
)
from tests.unit.levelset.levelset_problems import SHAPES, Rough, rough_lattice, solved, wavy
from tests.unit.levelset.levelset_twin import euler


@pytest.mark.parametrize("precision", ["float64", "float32"])
@pytest.mark.parametrize("boundary", list(Boundary))
@pytest.mark.parametrize("n", SHAPES)
def test_a_stage_is_what_the_twin_computes(n: int, boundary: str, precision: str) -> None:
    """Every scheme, flux and set on rough data, in 2 to 6 dimensions."""
    lattice, dt, time = rough_lattice(n, boundary), 1e-3, 0.7
    values = wavy(lattice)
    cases = [(scheme, Flux.LAX_FRIEDRICHS, Kind.FIXED) for scheme in Scheme]
    cases += [(Scheme.FIRST, Flux.GODUNOV, Kind.TUBE), (Scheme.WENO5, Flux.GODUNOV, Kind.ALWAYS)]
    for scheme, flux, kind in cases:
        motion = Rough(n, separable=flux is Flux.GODUNOV)
        march = March(
            lattice, motion, values, time, kind, Options(scheme, stages=1, flux=flux, precision=precision)
        )
        assert march.step(dt) == dt
        gain = (march.nodes() - values) / dt
        expected = (euler(lattice, motion, values, dt, time, scheme, flux, kind) - values) / dt
        scale = np.abs(expected).max()
        atol = 1e-10 if precision == "float64" else 2e-3
        differs = np.abs(gain - expected) > atol * scale
        # In float32 an ENO stencil may be chosen otherwise where two are equally rough.
        allowed = 0.01 if precision == "float32" and scheme in (Scheme.ENO2, Scheme.ENO3) else 0.0
        assert differs.mean() <= allowed, (scheme, flux, kind, np.abs(gain - expected).max() / scale)


def test_the_step_is_the_longest_stable_one() -> None:
    lattice, motion = rough_lattice(3, "edge"), Rough(3, separable=True, varies=False)
    march = March(lattice, motion, wavy(lattice), 0.0, Kind.FIXED, Options(Scheme.FIRST))
    x = lattice.coordinates()
    speeds = [sum(terms) for terms in motion.rates(lattice, 0.0).drift]
    speeds[0] = abs(speeds[0] + 0.1 * np.cos(x[2])) + 0.6 * np.cos(x[2])
    speeds[1] = abs(speeds[1]) + np.cos(x[2])
    total = sum(np.abs(s) / h for s, h in zip(speeds, lattice.spacing, strict=True))
    assert march.rate == pytest.approx(total.max(), rel=1e-12)
    assert march.step(10.0) == pytest.approx(0.75 / total.max(), rel=1e-12)


@pytest.mark.parametrize("stages", [1, 2, 3])
def test_runge_kutta_against_the_twin(stages: int) -> None:
    lattice, motion, dt, t = rough_lattice(3, "periodic"), Rough(3), 2e-3, 0.3
    v = wavy(lattice)

    def push(values: np.ndarray, time: float) -> np.ndarray:
        return euler(lattice, motion, values, dt, time, Scheme.WENO3)

    if stages == 1:
        expected = push(v, t)
    elif stages == 2:
        expected = (v + push(push(v, t), t - dt)) / 2
    else:
        second = 0.75 * v + 0.25 * push(push(v, t), t - dt)
        expected = v / 3 + 2 / 3 * push(second, t - dt / 2)
    march = March(lattice, motion, v, t, Kind.FIXED, Options(Scheme.WENO3, stages=stages))
    march.step(dt)
    np.testing.assert_allclose(march.nodes(), expected, rtol=0, atol=1e-12)
    assert march.time == pytest.approx(t - dt)


@pytest.mark.slow
def test_threads_change_nothing() -> None:
    lattice = rough_lattice(4, "extrapolate")
    values = wavy(lattice)
    one, many = (
        solve(lattice, Rough(4), values, 0.01, kind="fixed", options=Options(Scheme.WENO5, threads=k)).field
        for k in (1, 5)
    )
    assert one is not None
    assert many is not None
    np.testing.assert_array_equal(one.values, many.values)


def test_memory_is_at_most_six_grids() -> None:
    lattice = Lattice.of([-1.0] * 4, [1.0] * 4, (40, 21, 21, 21))
    x = lattice.coordinates()
    values = np.broadcast_to(np.hypot(x[0], x[1]) - 0.5, lattice.shape)
    motion = Linear(np.eye(4)[[1, 2, 3, 0]], (Input(np.eye(4)[:, 2:], Ball(np.zeros(2), 0.1), "min"),))
    tracemalloc.start()
    solved(lattice, motion, values, 0.05, options=Options(Scheme.WENO5))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak <= 6 * values.size * 8


def test_the_first_order_scheme_holds_two_grids_beside_the_callers() -> None:
    """The value and its next stage, later the value and the result; ghosts make them 26 / 24 as large."""
    lattice = Lattice.of([-1.0] * 4, [1.0] * 4, (24, 24, 24, 24))
    values = sum(axis**2 for axis in lattice.coordinates()) - np.full(lattice.shape, 0.3)
    motion = Linear(np.eye(4)[[2, 3, 0, 1]], (Input(np.eye(4)[:, 2:], Ball(np.zeros(2), 0.1), "min"),))
    solved(lattice, motion, values, 0.05, options=Options(Scheme.FIRST))  # compiles
    tracemalloc.start()
    solved(lattice, motion, values, 0.05, options=Options(Scheme.FIRST))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak <= 2.3 * values.nbytes
