"""The watch of a question with walls, half-spaces that change by interval, and with cut sets of thrusts."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import NamedTuple, Self

import numpy as np

from safestart.constraints.thrust_limit import Frame
from safestart.exact.space.question import SpaceQuestion
from safestart.exact.space.watch import SpaceWatch
from safestart.exact.watch import Cuts, Ints
from safestart.model.scenario import Floats
from safestart.optim.cut_set import CutSet
from safestart.optim.thrust_shapes import UnitSet

# Rows this close to a node (s) are taken on both sides of it: there one wall ends and the next one begins.
_AT_NODE_S = 1e-6


class Wall(NamedTuple):
    """normal_k . p <= offset_k over interval k: unit normals (N, 3) in ``frame``, offsets (N,) m."""

    name: str
    frame: Frame
    normals: Floats
    offsets: Floats


@dataclass(frozen=True)
class CutQuestion(SpaceQuestion):
    """A question whose thrusts keep cut_k . u_k <= 0, ``cuts`` (N, 3) in LVLH axes or None."""

    cuts: Floats | None = field(default=None, compare=False)
    by_channel: Floats | None = field(default=None, compare=False)

    @property
    def thrust_set(self) -> UnitSet:
        """The unit set, cut."""
        whole = SpaceQuestion.thrust_set.__get__(self)
        return whole if self.by_channel is None else CutSet(whole, self.by_channel)


class RestrictedWatch(SpaceWatch):
    """``base`` with ``walls`` after its faces, and with ``cuts`` (N, 3) of the thrusts, LVLH, or None.

    It shares the tables of ``base``, so that a restriction costs little.
    """

    def __init__(self, base: SpaceWatch, walls: tuple[Wall, ...], cuts: Floats | None = None) -> None:
        vars(self).update(vars(base))
        question = base.question
        by_channel = None
        if cuts is not None:
            pushes = np.eye(3) if base._pushes is None else base._pushes
            by_channel = (cuts[:, None, :] @ pushes)[:, 0]
        parts = {one.name: getattr(question, one.name) for one in fields(SpaceQuestion)}
        self.question = CutQuestion(**parts, cuts=cuts, by_channel=by_channel)
        self._faces = len(base.names)
        self._walls = walls
        if not walls:
            self._wall_normals, self._wall_offsets = np.empty((0, 0, 3)), np.empty((0, 0))
            return
        own = self._wall_normals = np.stack([wall.normals for wall in walls], axis=1)
        levels = self._wall_offsets = np.stack([wall.offsets for wall in walls], axis=1)
        self.names = base.names + tuple(wall.name for wall in walls)
        in_body = np.array([wall.frame == "body" for wall in walls])
        self._in_body = np.concatenate([base._in_body, in_body])
        at = own[self._interval]
        turned, rate, just = at, np.zeros_like(at), np.zeros_like(at)
        first = own[:1]
        if in_body.any():
            mask, attitude, times = in_body[:, None], question.attitude, self._times
            turn = attitude.rotation(times)
            turned = np.where(mask, at @ turn, at)
            omega = attitude.angular_velocity(times)
            rate = np.where(mask, np.cross(omega[:, None, :], at) @ turn, 0.0)
            just = rate
            if len(attitude.knots):
                before = attitude.angular_velocity(np.nextafter(times, -np.inf))
                just = np.where(mask, np.cross(before[:, None, :], at) @ turn, 0.0)
            first = np.where(mask, own[:1] @ attitude.rotation(np.zeros(1)), first)
        self._normals = np.concatenate([base._normals, turned], axis=1)
        self._slope_first = np.concatenate([base._slope_first, rate[self._first]], axis=1)
        self._slope_last = np.concatenate([base._slope_last, just[self._last]], axis=1)
        self._levels = np.concatenate(
            [np.broadcast_to(base.offsets, (len(at), self._faces)), levels[self._interval]], axis=1
        )
        self.offsets = np.concatenate([base.offsets, levels[0]])
        self.normals = np.concatenate([base.normals, first[0]])

    def until(self, steps: int) -> Self:
        """See :meth:`SpaceWatch.until`."""
        out = super().until(steps)
        if self._walls:
            out._levels = self._levels[: len(out._times)]
        return out

    def cuts(self, times: Floats, faces: Ints) -> Cuts:
        """Rows; for a wall at a node the row of the interval before it, too."""
        dt = self.question.dt
        node = np.rint(times / dt)
        both = (faces >= self._faces) & (np.abs(times - dt * node) < _AT_NODE_S) & (node > 0.0)
        before = np.maximum(dt * node[both] - _AT_NODE_S, 0.0)
        return super().cuts(np.concatenate([times, before]), np.concatenate([faces, faces[both]]))

    def _planes(self, times: Floats, faces: Ints) -> tuple[Floats, Floats]:
        own, offset = np.empty((len(faces), 3)), np.empty(len(faces))
        plain = faces < self._faces
        own[plain], offset[plain] = self._own[faces[plain]], self.offsets[faces[plain]]
        k = np.clip(np.floor(times[~plain] / self.question.dt), 0, self.question.steps - 1).astype(np.int64)
        wall = faces[~plain] - self._faces
        own[~plain], offset[~plain] = self._wall_normals[k, wall], self._wall_offsets[k, wall]
        return own, offset
