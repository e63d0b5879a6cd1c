"""The engine's problem for our own solver (:mod:`safestart.levelset`)."""

from __future__ import annotations

import numpy as np

from safestart.attitude.body_frame import into_body
from safestart.engines.base import Problem
from safestart.engines.hj.domain import Domain
from safestart.engines.hj.frame import Frame, system_matrix
from safestart.engines.hj.settings import BOUNDARY, PRECISION, Settings
from safestart.engines.hj.target import faces, mismatch
from safestart.levelset import Ball, Input, Kind, Lattice, Linear, March, Options, Scheme
from safestart.levelset.warm import warm
from safestart.model.scenario import Floats, SetKind

_SCHEMES = {
    "low": Scheme.FIRST,
    "medium": Scheme.ENO2,
    "high": Scheme.WENO3,
    "very_high": Scheme.WENO5,
}


class FusedSolver:
    """Value function on the lattice, stepped backwards in stretches from the horizon (float32).

    ``compile_s`` is the time for compiling or loading from the cache.
    """

    def __init__(
        self, problem: Problem, domain: Domain, settings: Settings, terminal: Floats, courant: float
    ) -> None:
        self.compile_s = warm(PRECISION)
        scenario = problem.scenario
        lattice = Lattice.of(-domain.half, domain.half, settings.shape, BOUNDARY)
        thrust = Ball(np.zeros(2), scenario.chaser.max_acceleration)
        motion = Linear(
            system_matrix(scenario.target, settings.frame), (Input(np.eye(4)[:, 2:], thrust, "min"),)
        )
        x, y = lattice.axes[0][:, None], lattice.axes[1][None, :]
        rows, rate = faces(scenario.corridor), scenario.target.tumble_rate

        apart: Floats | None = None
        if settings.match is not None:
            nodes = np.stack(np.meshgrid(*lattice.axes, indexing="ij"), axis=-1)
            apart = mismatch(nodes, rate, settings.frame, settings.match)

        def turned(time: float) -> Floats:
            """l at a time on the nodes: l(R(-omega_t t) p), (nx, ny, 1, 1), or the velocity-aware one."""
            c, s = np.cos(rate * time), np.sin(rate * time)
            along, across = into_body(c, s, x, y)
            levels = [a * along + b * across + d for a, b, d in rows]
            highest: Floats = np.maximum.reduce(levels)
            distance = highest[:, :, None, None]
            return distance if apart is None else np.maximum(distance, apart)

        tube = problem.kind is SetKind.TUBE
        turns = tube and settings.frame is Frame.LVLH
        self._march = March(
            lattice,
            motion,
            np.ascontiguousarray(terminal),
            problem.horizon,
            Kind.TUBE if tube and not turns else Kind.FIXED,
            Options(_SCHEMES[settings.accuracy], precision=PRECISION, courant=courant),
            cap=turned if turns else None,
        )

    def advance(self, span: float) -> tuple[bool, float, float]:
        """Step ``span`` seconds back; returns whether all values are finite, and the least and largest value."""
        self._march.advance(span)
        low, high = self._march.range()
        return bool(np.isfinite(low)), low, high

    def value(self) -> Floats:
        """The value function in float64."""
        return np.array(self._march.nodes(), dtype=np.float64)
