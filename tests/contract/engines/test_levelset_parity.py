"""The fused solver against hj-reachability in float64: the same schemes must give the same numbers."""

import itertools
from collections.abc import Callable, Iterator
from typing import Any

import hj_reachability as hj
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from safestart.engines.base import Problem
from safestart.engines.hamilton_jacobi import HamiltonJacobi
from safestart.engines.hj.frame import Frame, coefficients, system_matrix
from safestart.engines.hj.model import LinearMotion
from safestart.engines.hj.options import HamiltonJacobiInput
from safestart.engines.hj.peer import _edge
from safestart.levelset import Ball, Input, Kind, Lattice, Linear, Options, Scheme, solve
from safestart.levelset.adapter import Tabulated
from safestart.levelset.solution import MOMENTS
from safestart.model.scenario import Grid, Scenario, SetKind
from safestart.runtime.progress import Context

LIMIT = 1e-10
BOUNDARIES: dict[str, Callable[[Any, int], Any]] = {
    "edge": _edge,
    "periodic": hj.boundary_conditions.periodic,
    "extrapolate_away_from_zero": hj.boundary_conditions.extrapolate_away_from_zero,
}
ACCURACY = {Scheme.FIRST: "low", Scheme.WENO3: "high", Scheme.WENO5: "very_high"}


@pytest.fixture
def _double_precision() -> Iterator[None]:
    with jax.enable_x64(True):
        yield


def peer(
    lattice: Lattice,
    model: Any,
    values: np.ndarray,
    horizon: float,
    scheme: Scheme,
    tube: bool,
    pieces: int = 1,
) -> np.ndarray:
    box = hj.sets.Box(jnp.array(lattice.low), jnp.array(lattice.high))
    grid = hj.Grid.from_lattice_parameters_and_boundary_conditions(
        box, lattice.shape, boundary_conditions=tuple(BOUNDARIES[b] for b in lattice.boundary)
    )
    settings = hj.SolverSettings.with_accuracy(
        ACCURACY[scheme],
        hamiltonian_postprocessor=hj.solver.backwards_reachable_tube if tube else hj.solver.identity,
    )
    found, ends = jnp.asarray(values), -horizon * np.arange(pieces + 1) / pieces
    for begin, end in itertools.pairwise(ends.tolist()):
        found = hj.step(settings, model, grid, begin, found, end, progress_bar=False)
    return np.asarray(found)


@pytest.mark.usefixtures("_double_precision")
@pytest.mark.parametrize(("scheme", "kind"), [(Scheme.FIRST, Kind.FIXED), (Scheme.WENO5, Kind.TUBE)])
def test_the_paper_s_motion_in_four_dimensions(scheme: Scheme, kind: Kind) -> None:
    """Body frame, disk of thrust, T = 4 s."""
    target = Scenario.of(3.0, 0.1).target
    half = np.array([60.0, 50.0, 4.0, 5.0])
    lattice = Lattice.of(-half, half, (13, 11, 9, 10))
    x, y, _, _ = lattice.coordinates()
    values = np.broadcast_to(np.hypot(x - 3.0, y + 1.7) - 20.0 + 0.05 * x, lattice.shape)
    expected = peer(
        lattice, LinearMotion(*coefficients(target, Frame.BODY), 0.1), values, 4.0, scheme, kind is Kind.TUBE
    )
    motion = Linear(
        system_matrix(target, Frame.BODY), (Input(np.eye(4)[:, 2:], Ball(np.zeros(2), 0.1), "min"),)
    )
    ours = solve(lattice, motion, values, 4.0, kind=kind, options=Options(scheme)).field
    assert ours is not None
    assert np.abs(expected - values).max() > 1.0
    np.testing.assert_allclose(ours.values, expected, rtol=0, atol=LIMIT)


class Drifting(hj.systems.Air3d):  # type: ignore[misc]
    """The game of two identical vehicles, in a wind that turns with time: nothing linear, nothing constant."""

    def open_loop_dynamics(self, state: Any, time: Any) -> Any:
        return super().open_loop_dynamics(state, time) + jnp.array(
            [0.3 * jnp.sin(2.0 * time), 0.2 * time, 0.0]
        )


@pytest.mark.usefixtures("_double_precision")
@pytest.mark.parametrize(("kind", "varies"), [(hj.systems.Air3d, False), (Drifting, True)])
def test_a_model_of_theirs_runs_unchanged(kind: Any, varies: bool) -> None:
    """Air3d: state-dependent gains, two players, a periodic axis, their own boundary; constant and time-varying."""
    model = kind()
    lattice = Lattice.of(
        [-6.0, -8.0, 0.0],
        [18.0, 9.0, 2.0 * np.pi],
        (15, 13, 12),
        ["extrapolate_away_from_zero", "edge", "periodic"],
    )
    assert Tabulated.of(model, lattice).varies is varies
    x, y, angle = lattice.coordinates()
    values = np.hypot(x, y) - 5.0 + 0.0 * angle
    # A motion that varies is stepped no longer than a share of the horizon, which they have to be asked for.
    expected = peer(lattice, model, values, 0.7, Scheme.WENO3, True, MOMENTS if varies else 1)
    # Their clock runs from 0 to -T.
    ours = solve(lattice, model, values, 0.7, start=-0.7, options=Options(Scheme.WENO3))
    assert ours.field is not None, ours.failure
    np.testing.assert_allclose(ours.field.values, expected, rtol=0, atol=LIMIT)
    gradient = ours.field.gradient_at(np.array([1.0, 0.5, 2.0]))
    control, disturbance = ours.optimal_inputs(np.array([1.0, 0.5, 2.0]))
    theirs = model.optimal_control_and_disturbance(jnp.array([1.0, 0.5, 2.0]), -0.7, jnp.asarray(gradient))
    np.testing.assert_allclose(control, theirs[0], atol=1e-12)
    np.testing.assert_allclose(disturbance, theirs[1], atol=1e-12)


@pytest.mark.parametrize("kind", list(SetKind))
def test_the_engine_answers_the_same_with_either_solver(kind: SetKind) -> None:
    """In float32, with a turning corridor (tube) and a standing one."""
    answers = []
    for solver in ("fused", "hj_reachability"):
        options = HamiltonJacobiInput(accuracy="low", solver=solver, nodes_xy=15, nodes_v=7, frame="lvlh")
        problem = Problem(Scenario.of(3.0, 0.1), Grid(21, 21, 60.0), 20.0, kind=kind)
        result = HamiltonJacobi(options).solve(problem, Context())
        assert result.detail["solver"] == solver
        answers.append(result)
    ours, theirs = (result.arrays["margin_unrestricted"] for result in answers)
    np.testing.assert_allclose(ours, theirs, atol=2e-3)
    np.testing.assert_array_equal(answers[0].mask, answers[1].mask)
