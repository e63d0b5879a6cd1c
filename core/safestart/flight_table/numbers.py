"""The numbers of one operating point: what its certificate, its atlas and the check of a thrust history need."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from safestart.atlas.atlas import Atlas
from safestart.atlas.extent import Ceiling
from safestart.closed_form.certified_point import Prepared, prepare
from safestart.errors import invalid
from safestart.exact.watch import Watch, watch_of
from safestart.model.scenario import Floats, Rest, Scenario

FARTHEST_M = 30_000.0
"""|x| + |y| + |z| that a verdict is given for."""
THINNEST = 1e-6
"""Radians: a sector of the atlas that is thinner is left out, its starts are then UNDECIDED."""
_ATAN2 = 4e-15
"""More than what arctangents in double precision may be off, radians."""


@dataclass(frozen=True, slots=True)
class Sector:
    """A triangle of the fan: corners ``a``, ``b`` (2,) as seen from the centre, 1 / (a x b), their margins (m).

    Within ``least`` of an edge, as a barycentric weight, safestart may take the neighbouring sector for it.
    """

    a: tuple[float, float]
    b: tuple[float, float]
    inverse: float
    margins: tuple[float, float]
    least: float


@dataclass(frozen=True, slots=True)
class Point:
    """One operating point; ``planar`` and ``spatial`` are the certificate's numbers."""

    scenario: Scenario
    atlas: Atlas
    planar: Prepared
    spatial: Prepared
    sectors: tuple[Sector, ...]
    watch: Watch

    @property
    def ceilings(self) -> tuple[Ceiling, ...]:
        """The atlas's ceilings that some start within :data:`FARTHEST_M` is above."""
        far = FARTHEST_M
        return tuple(c for c in self.atlas.ceilings if c.level - far * float(np.abs(c.slope).sum()) < -1.0)

    @property
    def spread(self) -> float:
        """How much farther than the start a control point or a stop may be, |re| + |im|."""
        largest = max(abs(h.real) + abs(h.imag) for member in self.spatial.inner for h in member)
        return max(2.0, largest)

    @property
    def widest(self) -> float:
        """The largest offset of a face, m."""
        return max(abs(face[1]) for face in self.spatial.faces)

    @property
    def matrices(self) -> tuple[Floats, Floats]:
        """Motion over one sample, (4, 4), and thrust held over it, (4, 2)."""
        motion, h = self.watch.prediction.motion, self.watch.step
        planar = [0, 1, 3, 4]
        drift, push = motion.transition(0.0, h), motion.held(0.0, h)
        return drift[np.ix_(planar, planar)], push[np.ix_(planar, [0, 1])]


def point_of(scenario: Scenario, atlas: Atlas, rest: Rest = Rest.LVLH) -> Point:
    """The numbers of a scenario with its atlas; raises ``InvalidInput`` for an atlas of another scenario."""
    if atlas.question.scenario != scenario:
        raise invalid("atlas", "one of the same scenario", atlas.question.scenario)
    target, a_max = scenario.target, scenario.chaser.max_acceleration
    planar, spatial = (
        prepare(target.tumble_rate, target.mean_motion, a_max, scenario.corridor, rest, in_space)
        for in_space in (False, True)
    )
    if planar.faces != spatial.faces[: len(planar.faces)]:
        raise ArithmeticError("the planar faces are not the first of the spatial ones")
    return Point(scenario, atlas, planar, spatial, _sectors(atlas), watch_of(atlas.question))


def _sectors(atlas: Atlas) -> tuple[Sector, ...]:
    count = len(atlas.rim)
    found = []
    for j in range(count if count >= 3 else 0):
        after = (j + 1) % count
        (ax, ay), (bx, by) = atlas.corners[j].tolist(), atlas.corners[after].tolist()
        cross = ax * by - ay * bx
        one, two = math.hypot(ax, ay), math.hypot(bx, by)
        if not cross > THINNEST * one * two:
            continue
        least = _ATAN2 * one * two / cross * max(one / two, two / one)
        margins = float(atlas.margins[j]), float(atlas.margins[after])
        found.append(Sector((ax, ay), (bx, by), 1.0 / cross, margins, least))
    return tuple(found)
