"""The question to an engine in space, what its answer is restricted to, and which engines answer it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from safestart.constraints.thrust_limit import ThrustLimit
from safestart.engines.base import EngineResult
from safestart.engines.region import ROUND_OFF
from safestart.engines.registry import engine_spec
from safestart.exact.space.plane import Plane
from safestart.exact.space.question import SpaceQuestion
from safestart.exact.space.watch import space_watch_of
from safestart.model.scenario import Bools, Floats
from safestart.runtime.named import load
from safestart.runtime.progress import Context


@dataclass(frozen=True, slots=True)
class PlaneProblem:
    """Which starts of a plane, at ``across`` times ``along`` points, belong to an engine's set at the horizon.

    ``sigma`` are standard deviations of navigation, m and m/s, for engines that fly, ``seed`` that of their draws.
    """

    question: SpaceQuestion
    plane: Plane
    across: int
    along: int
    sigma: tuple[float, float] = (0.0, 0.0)
    seed: int = 0
    shape: tuple[int, int] = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "shape", (self.along, self.across))

    def states(self) -> Floats:
        """LVLH starts (along, across, 6), m and m/s."""
        return self.plane.states(self.plane.grid(self.across, self.along)[2])

    def distance(self) -> Floats:
        """To the nearest face at t = 0 (along, across), m, negative outside."""
        watch = space_watch_of(self.question)
        out: Floats = (watch.offsets - self.states()[..., :3] @ watch.normals.T).min(axis=-1)
        return out

    def inside(self) -> Bools:
        """Where the start is inside all faces: every engine's set is restricted to it."""
        return np.asarray(self.distance() >= 0.0)

    def restricted(self, margin: Floats) -> tuple[Bools, Floats]:
        """Mask and margin (m) of a set with ``margin`` (along, across), restricted to the faces at t = 0."""
        distance = self.distance()
        mask = (distance >= 0.0) & (margin >= -ROUND_OFF)
        least = np.minimum(margin, distance)
        return mask, np.maximum(least, 0.0, out=least, where=mask)


class PlaneEngine(Protocol):
    """An engine of a plane of starts."""

    def solve(self, problem: PlaneProblem, context: Context) -> EngineResult:
        """Decide every point; a numerical failure gives a result code."""
        ...


def engine_in_space(name: str) -> PlaneEngine:
    """Load an engine's form for a plane of starts."""
    made: PlaneEngine = load(engine_spec(name).in_space, f"in_space of engine {name}")()
    return made


def boxed(limit: ThrustLimit) -> ThrustLimit:
    """The least box along LVLH axes, or along the limit's own axes, around a ball or a box; thrusters as they are."""
    return ThrustLimit("box", limit.a_max * 3) if limit.kind == "ball" else limit
