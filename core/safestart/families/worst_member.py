"""The worst member of a family at each time, as :class:`~safestart.exact.search.Search` sees the family.

One history must stay for every member. The search runs on the rows of a few nodes (tumble rate, mean motion), each row
less the part that the start box takes, sum_i |start_i| half_i; each face of each node counts as a separate face. The
flight is watched from every corner of the box at every node; ``between.py`` bounds the values between nodes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from safestart.constraints.cubic import dips
from safestart.exact.norm_rows import Blocks, blocks
from safestart.exact.watch import Cuts, Ints, Minima, Watch, watch_of
from safestart.families.between import chord_gap, half_angle, nodes, reach, turned
from safestart.families.members import Family, corner_signs
from safestart.model.scenario import Floats

MOST_NODES, MOST_VALUES = 128, 4_000_000
"""Largest number of nodes, and of distances (corners, samples, faces) checked per flight."""


class Hostile:
    """A family as one watch: ``names`` and rows node by node; ``question`` is the one with the least thrust."""

    rounding = Watch.rounding

    def __init__(self, family: Family, rates: tuple[float, ...], motions: tuple[float, ...]) -> None:
        self.family, self.rates, self.motions = family, rates, motions
        thrust = family.thrusts[0]
        self.question = family.member(rates[0], motions[0], thrust)
        self.nodes = [Watch(family.member(rate, n, thrust)) for rate in rates for n in motions]
        first = self.nodes[0]
        self.faces = len(first.names)
        self.half = family.half
        self.names, self.prediction = first.names * len(self.nodes), first.prediction
        self.normals = np.tile(first.normals, (len(self.nodes), 1))
        held = np.abs(first.normals) @ self.half[: self.question.dimensions]
        self.offsets = np.tile(first.offsets - held, len(self.nodes))
        self.delta = half_angle(rates, self.question.horizon)
        self.boxes = [_box(node, self.half) for node in self.nodes]
        self.lean = first.normals[:, 0] != 0.0

    def cuts(self, times: Floats, faces: Ints) -> Cuts:
        """Rows of the worst start: the offset is less by sum_i |start_i| half_i."""
        size = 2 * self.question.dimensions
        start, thrust = np.empty((len(times), size)), np.empty((len(times), size // 2 * self.question.steps))
        offset = np.empty(len(times))
        node = faces // self.faces
        for k in np.unique(node):
            rows = node == k
            cut = self.nodes[k].cuts(times[rows], faces[rows] % self.faces)
            start[rows], thrust[rows] = cut.start, cut.thrust
            offset[rows] = cut.offset - np.abs(cut.start) @ self.half
        return Cuts(times, faces, offset, start, thrust)

    def blocks(self, names: Sequence[str], times: Floats) -> Blocks:
        """Rows of the norm limits ``names`` (B) at ``times`` (B,)."""
        return blocks(self.question, self.prediction, names, times)

    def minima(self, state: Floats, thrust: Floats) -> Minima:
        """Local minima at the nodes; ``lowest`` bounds the distances of every member where it is positive."""
        found = [
            _node_minima(node, box, state, thrust) for node, box in zip(self.nodes, self.boxes, strict=True)
        ]
        offsets = self.nodes[0].offsets
        lowest = np.min([low for low, _ in found], axis=0)
        sure = float(turned(lowest, offsets, self.lean, self.delta).min()) - self.chord(state)
        times = np.concatenate([minima.times for _, minima in found])
        faces = np.concatenate([minima.faces + k * self.faces for k, (_, minima) in enumerate(found)])
        values = np.concatenate([minima.values for _, minima in found])
        # One face's lowest minimum in an interval is a sufficient cut, as nodes are close together.
        order = np.lexsort((values, faces % self.faces, times // self.question.dt))
        key = np.stack([times // self.question.dt, faces % self.faces])[:, order]
        kept = order[np.concatenate([[True], (np.diff(key) != 0.0).any(axis=0)])]
        return Minima(sure, times[kept], faces[kept], values[kept])

    def chord(self, state: Floats) -> float:
        """Largest loss of distance from the mean motions between the nodes, m."""
        if len(self.motions) == 1:
            return 0.0
        return chord_gap(self.motions, bend_of(self.family, state))

    @property
    def lost(self) -> float:
        """Largest loss of a positive margin from the tumble rates between the nodes, m."""
        room = float(np.where(self.lean, np.maximum(self.nodes[0].offsets, 0.0), 0.0).max())
        return room * (1.0 / math.cos(self.delta) - 1.0)


def bend_of(family: Family, state: Floats) -> float:
    """Largest |d2f/dn2| over the family's flights from the box around ``state`` (2 d,), least thrust limit."""
    d, half = family.question.dimensions, family.half
    far = float(np.linalg.norm(state[:d]) + np.linalg.norm(half[:d]))
    fast = float(np.linalg.norm(state[d:]) + np.linalg.norm(half[d:]))
    return reach(far, fast, family.thrusts[0], family.motions[1], family.question.horizon).bend


@lru_cache(maxsize=2)
def hostile_of(family: Family, rate_parts: int, motion_parts: int) -> Hostile:
    """The family at the ends of its intervals and at equally spaced values between, kept between calls."""
    return Hostile(family, nodes(*family.rates, rate_parts), nodes(*family.motions, motion_parts))


def samples_of(family: Family) -> int:
    """Number of watched distances of a flight of the fastest member: samples times faces."""
    node = watch_of(family.member(family.rates[1], family.motions[1], family.thrusts[0]))
    return node.times.size * len(node.names)


@dataclass(frozen=True, slots=True)
class _Box:
    """The start box at one node: ``signs`` (P, K) of its corners along the K axes that have a width.

    Each half-width adds ``value`` and ``slope`` (K, N, S+1, F) to distances and slopes; all together add at most
    ``far`` (m) and ``fast`` (m/s) to position and speed.
    """

    signs: Floats
    value: Floats
    slope: Floats
    far: float
    fast: float


def _box(node: Watch, half: Floats) -> _Box:
    d = len(half) // 2
    still = np.zeros((node.question.steps, d))
    wide = np.nonzero(half > 0.0)[0]
    columns = [node.prediction.flight(half[i] * np.eye(2 * d)[i], still) for i in wide]
    along = [node.along_normals(column) for column in columns]
    shape = (len(wide), *node.times.shape, len(node.names))
    return _Box(
        corner_signs(half)[:, wide],
        np.array([value for value, _ in along]).reshape(shape),
        np.array([slope for _, slope in along]).reshape(shape),
        sum(float(np.linalg.norm(column[..., :d], axis=-1).max()) for column in columns),
        sum(float(np.linalg.norm(column[..., d:], axis=-1).max()) for column in columns),
    )


def _node_minima(node: Watch, box: _Box, state: Floats, thrust: Floats) -> tuple[Floats, Minima]:
    """All-times bounds per face (F,) and the local minima over time of the worst corner's distances."""
    d = node.question.dimensions
    flown = node.prediction.flight(state, thrust)
    value, slope = node.along_normals(flown)
    value += node.offsets
    low, at = dips(
        value + np.tensordot(box.signs, box.value, 1), slope + np.tensordot(box.signs, box.slope, 1)
    )
    worst = low.argmin(axis=0)[None]
    low, at = (np.take_along_axis(a, worst, 0)[0].reshape(-1, len(node.names)) for a in (low, at))
    fence = np.full((1, len(node.names)), np.inf)
    before, after = np.concatenate([fence, low[:-1]]), np.concatenate([low[1:], fence])
    index, face = np.nonzero((low <= before) & (low < after))
    times = node.times[:, :-1].ravel()[index] + node.step * at[index, face]
    furthest = float(np.linalg.norm(flown[..., :d], axis=-1).max()) + box.far
    fastest = float(np.linalg.norm(flown[..., d:], axis=-1).max()) + box.fast
    sure = low.min(axis=0) - node.between(furthest, fastest, thrust)
    return sure, Minima(float(sure.min()), np.minimum(times, node.question.horizon), face, low[index, face])
