"""The watch of a question whose attitude and forces are not known exactly: every distance less what that may take.

A member's attitude is within the angle k(t) of the stated one and its position within y(t) of the flight, so a face of
the body keeps at least d - k |r| - (1 + k) y, a face of LVLH d - y. |r| is convex in the start and the thrusts, so the
largest margin of all this is a concave problem; k e . r with e the unit vector along a known flight is its tangent.
"""

from __future__ import annotations

import math

import numpy as np

from safestart.exact.space.bends import Rates
from safestart.exact.space.spread import angles, drifts
from safestart.exact.space.watch import SpaceWatch
from safestart.exact.watch import Cuts, Ints, Minima
from safestart.model.scenario import Floats

# The checker bounds |r| around one value of it for each piece of time.
_RESERVE_M, _NEAREST_M = 1e-3, 0.5


class TightenedWatch(SpaceWatch):
    """``base`` less what the unknowns of its question may take, for flights from around ``state`` (6,).

    It shares the tables of ``base``, and remembers the flight of the last history that keeps least: its rows lean
    along it. ``widest`` is the largest angle, rad; inf: no bound of use.
    """

    def __init__(self, base: SpaceWatch, state: Floats) -> None:
        vars(self).update(vars(base))
        question = base.question
        ends = np.unique(self._times)
        angle = angles(question.attitude, question.unknowns, ends, question.dt)
        self.widest = float(angle[-1])
        # No two attitudes are further apart.
        angle = np.minimum(angle, math.pi)
        self._ends, self._angles = ends, angle
        self._angle = np.interp(self._times, ends, angle)
        self._drift = drifts(question.orbit, question.unknowns, self._times)
        self._fixed = self._drift[:, None] * (1.0 + self._angle[:, None] * self._in_body)
        # The bound at t = 0, where a search looks for the nearest face first.
        self.offsets = base.offsets - angle[0] * float(np.linalg.norm(state[:3])) * self._in_body
        self._bare = base.offsets
        self._course = np.broadcast_to(state[:3], (len(self._times), 3))
        self._of: Floats | None = None
        self._least = np.inf

    @property
    def told(self) -> str:
        """What the unknowns may do until the end, in words."""
        if not math.isfinite(self.widest):
            return "what is not known of the attitude may turn the body any way before the end"
        parts = []
        if self.widest:
            parts.append(f"the attitude may be off by {math.degrees(self.widest):.2g} deg")
        if self._drift[-1]:
            parts.append(f"forces may move the chaser by {self._drift[-1]:.2g} m")
        return f"at the end {' and '.join(parts)}: by these bounds none keeps all faces for every member"

    def reserve(self, half: Floats, state: Floats, thrust: Floats | None) -> float:
        """What a proof's bound on |r| may take beyond this watch's, m: it is quadratic in what moves the flight.

        ``half`` (6,): half-widths of the starts around the flight from ``state`` (6,) under ``thrust`` (N, channels),
        which the proof takes the bound around; None: around the remembered flight.
        """
        still = np.zeros((self.question.steps, self.question.channels))
        moved = np.stack([self.flown(column, still)[:, :3] for column in np.diag(half)])
        course = self._course if thrust is None else self.flown(state, thrust)[:, :3]
        away = np.maximum(np.sqrt(np.square(course).sum(axis=1)), _NEAREST_M)
        wide = np.count_nonzero(half) * np.square(moved).sum(axis=(0, 2)) / (2.0 * away)
        return _RESERVE_M + 1.05 * float((self._angle * wide).max())

    def minima(self, state: Floats, thrust: Floats) -> Minima:
        """See :meth:`SpaceWatch.minima`."""
        found = super().minima(state, thrust)
        if self._of is not thrust or found.lowest < self._least:
            self._of, self._least = thrust, found.lowest
            self._course = self.flown(state, thrust)[:, :3]
        return found

    def _taken(self, position: Floats) -> Floats:
        away = np.sqrt(np.square(position).sum(axis=1))
        out: Floats = self._fixed + (self._angle * away)[:, None] * self._in_body
        return out

    def _taken_between(self, position: Floats, rates: Rates) -> float:
        """A position is off its chord by at most h^2 / 8 |r''|; of two rising factors the product may bulge."""
        away = np.sqrt(np.square(position).sum(axis=1))
        first, last = self._first, self._last
        bulge = np.abs((self._angle[last] - self._angle[first]) * (away[last] - away[first])).max()
        return self.widest * self._longest**2 / 8.0 * rates.a + 0.25 * float(bulge)

    def cuts(self, times: Floats, faces: Ints) -> Cuts:
        """Rows that lean towards the remembered flight; any flight keeps at most this."""
        normals, _ = self._across(times, faces)
        angle = np.interp(times, self._ends, self._angles) * self._in_body[faces]
        towards = np.stack([np.interp(times, self._times, row) for row in self._course.T], axis=1)
        towards /= np.maximum(np.sqrt(np.square(towards).sum(axis=1)), 1e-9)[:, None]
        start, thrust = self.prediction.position_rows(times, -(normals + angle[:, None] * towards))
        drift = drifts(self.question.orbit, self.question.unknowns, times)
        offset = self._bare[faces] - drift * (1.0 + angle)
        return Cuts(times, faces, offset, start, self._by_channels(thrust))
