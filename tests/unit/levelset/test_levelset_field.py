"""A value function between its nodes, and the inputs that are optimal there."""

import numpy as np
import pytest

from safestart.errors import InvalidInput
from safestart.levelset import (
    Ball,
    Box,
    Input,
    Lattice,
    Linear,
    Options,
    Scheme,
    ValueField,
    optimal_inputs,
    solve,
)
from tests.unit.levelset.levelset_problems import Rough, rough_lattice, wavy

RNG = np.random.default_rng(5)


class TestField:
    """Reading between nodes."""

    LATTICE = Lattice.of(
        [-1.0, 0.0, -2.0], [1.0, 2.0 * np.pi, 2.0], (21, 40, 17), ["edge", "periodic", "edge"]
    )

    def field(self) -> ValueField:
        x, a, z = self.LATTICE.coordinates()
        return ValueField(self.LATTICE, 2.0 * x - 3.0 * z + np.sin(a))

    def test_value_and_gradient(self) -> None:
        states = np.stack([RNG.uniform(-1, 1, 50), RNG.uniform(-9, 9, 50), RNG.uniform(-2, 2, 50)], axis=-1)
        value, gradient = self.field().read(states)
        np.testing.assert_allclose(
            value, 2 * states[:, 0] - 3 * states[:, 2] + np.sin(states[:, 1]), atol=4e-3
        )
        np.testing.assert_allclose(gradient[:, [0, 2]], np.tile([2.0, -3.0], (50, 1)), atol=1e-12)
        np.testing.assert_allclose(gradient[:, 1], np.cos(states[:, 1]), atol=1e-2)
        corner = np.array([1.0, 2.0 * np.pi, 2.0])
        np.testing.assert_allclose(self.field().value_at(corner), -4.0, atol=1e-12)

    @pytest.mark.parametrize(
        "state", [[1.1, 0.0, 0.0], [0.0, 0.0, -2.1], [np.nan, 0.0, 0.0], [0.0, np.inf, 0.0], [0.0, 0.0]]
    )
    def test_outside_is_an_error(self, state: list[float]) -> None:
        with pytest.raises(InvalidInput, match="states"):
            self.field().gradient_at(np.array(state))


def test_optimal_inputs_are_the_best_of_many() -> None:
    motion = Linear(
        np.zeros((3, 3)),
        (
            Input(RNG.standard_normal((3, 2)), Ball(np.array([0.1, 0.2]), 0.7), "max"),
            Input(RNG.standard_normal((3, 2)), Box(np.array([-1.0, 0.0]), np.array([0.5, 2.0])), "min"),
        ),
    )
    gradient, states = RNG.standard_normal((20, 3)), np.zeros((20, 3))
    ball, corner = optimal_inputs(motion, gradient, states)
    some = RNG.standard_normal((400, 2))
    some *= 0.7 * np.sqrt(RNG.uniform(0, 1, (400, 1))) / np.linalg.norm(some, axis=1, keepdims=True)
    slope = gradient @ motion.inputs[0].matrix
    assert (
        (slope * ball).sum(axis=1)[:, None] >= slope @ (some + motion.inputs[0].bound.middle).T - 1e-12
    ).all()
    assert np.allclose(np.linalg.norm(ball - [0.1, 0.2], axis=1), 0.7)
    others = RNG.uniform([-1.0, 0.0], [0.5, 2.0], (400, 2))
    slope = gradient @ motion.inputs[1].matrix
    assert ((slope * corner).sum(axis=1)[:, None] <= slope @ others.T + 1e-12).all()


@pytest.mark.parametrize("separable", [False, True])
def test_optimal_inputs_follow_gains_that_vary(separable: bool) -> None:
    """At nodes, where the gains of the rates are known: the support functions of the Hamiltonian are attained."""
    lattice, motion = rough_lattice(3, "edge"), Rough(3, separable)
    values = wavy(lattice)
    solution = solve(lattice, motion, values, 1e-3, options=Options(Scheme.FIRST))
    assert solution.field is not None
    at = np.array([3, 5, 2])
    state = np.array([axis[k] for axis, k in zip(lattice.axes, at, strict=True)])
    gradient = solution.field.gradient_at(state)
    chosen = solution.optimal_inputs(state)
    columns = [
        [
            [0.0 if g is None else np.broadcast_to(g, lattice.shape)[tuple(at)] for g in column]
            for column in player
        ]
        for player in motion.rates(lattice, solution.time).gains
    ]
    for (bound, aim, price), gains, u in zip(motion.bounds, columns, chosen, strict=True):
        slope = np.array(gains) @ gradient
        if isinstance(bound, Ball):
            most = bound.radius * np.linalg.norm(slope)
        else:
            most = (bound.half * np.abs(slope) * (np.abs(slope) > price)).sum()
        sign = 1.0 if aim == "max" else -1.0
        assert slope @ (u - bound.middle) == pytest.approx(sign * most, rel=1e-9)
