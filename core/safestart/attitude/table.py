"""An attitude from times and quaternions, by slerp: between two times the body turns steadily about a fixed axis.

Every answer is about the interpolated attitude. The caller must judge the true body's motion between the times: if its
angular velocity changes by at most c rad/s^2, it stays within c h^2 / 8 rad of the interpolation, with h the time step.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from safestart.attitude.quaternion import conjugate, matrix_of, product, rotation_vector, unit_quaternion
from safestart.attitude.turning import Bounds, of_rates
from safestart.errors import invalid
from safestart.model.scenario import MAX_TUMBLE_RATE, Floats

MOST_ENTRIES = 20_000
LARGEST_STEP = math.radians(90.0)
"""Largest turn between two entries; beyond it the direction of the turn is ambiguous."""


@dataclass(frozen=True)
class Table:
    """``times`` (K,) s, rising from 0 or before, and ``quaternions`` (K, 4), scalar first, scaled to unit length.

    A quaternion and its negative are the same attitude. The caller chooses the reference: LVLH, or inertial axes
    (:mod:`safestart.attitude.in_lvlh`). Raises ``InvalidInput`` for times that do not rise or begin after 0, a zero
    quaternion, and a jump: more than 90 degrees or 60 deg/s between two entries.
    """

    times: tuple[float, ...]
    quaternions: tuple[tuple[float, float, float, float], ...]
    _at: Floats = field(init=False, repr=False, compare=False)
    _first: Floats = field(init=False, repr=False, compare=False)
    _rates: Floats = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        if not 2 <= len(self.times) <= MOST_ENTRIES or len(self.quaternions) != len(self.times):
            required = f"2 to {MOST_ENTRIES} times and as many quaternions"
            raise invalid("times", required, (len(self.times), len(self.quaternions)))
        at = np.array(self.times, dtype=np.float64)
        if not np.isfinite(at).all() or (np.diff(at) <= 0.0).any() or at[0] > 0.0:
            raise invalid("times", "finite times that rise, the first at or before 0 s", self.times)
        units = tuple(unit_quaternion("attitude", entry) for entry in self.quaternions)
        entries = np.array(units)
        steps = rotation_vector(product(conjugate(entries[:-1]), entries[1:]))
        turns = np.sqrt(np.square(steps).sum(axis=1))
        rates = steps / np.diff(at)[:, None]
        worst = int(np.argmax(np.maximum(turns / LARGEST_STEP, turns / np.diff(at) / MAX_TUMBLE_RATE)))
        if turns[worst] > LARGEST_STEP or turns[worst] > MAX_TUMBLE_RATE * (at[worst + 1] - at[worst]):
            raise invalid(
                "attitude",
                "no jump: at most 90 degrees and 60 deg/s between two entries",
                f"{math.degrees(turns[worst]):.4g} degrees from {at[worst]:g} to {at[worst + 1]:g} s",
            )
        object.__setattr__(self, "times", tuple(at.tolist()))
        object.__setattr__(self, "quaternions", units)
        object.__setattr__(self, "_at", at)
        object.__setattr__(self, "_first", matrix_of(entries))
        object.__setattr__(self, "_rates", rates)

    @property
    def knots(self) -> Floats:
        """Times (K,), s, at which the angular velocity jumps."""
        return self._at

    def turn_bounds(self) -> Bounds:
        """Bound the derivatives by powers of the largest rate: between two entries the body turns steadily."""
        return of_rates(self.rate_bounds()[0], 0.0, 0.0, 0.0)

    def reaches(self, end: float) -> None:
        """Raise ``InvalidInput`` unless the table reaches ``end`` seconds."""
        if self._at[-1] < end:
            raise invalid("times", f"entries up to the end, {end:g} s", f"the last at {self._at[-1]:g} s")

    def rotation(self, times: Floats) -> Floats:
        """(..., 3, 3): reference coordinates to body coordinates; after the last entry the body keeps turning."""
        times = np.asarray(times, dtype=np.float64)
        index = self._index(times)
        vector = self._rates[index] * (times - self._at[index])[..., None]
        angle = np.sqrt(np.square(vector).sum(axis=-1))
        # cos(angle / 2) and sin(angle / 2) / angle, which is 1/2 - angle^2 / 48 at 0.
        half = 0.5 * np.sinc(angle / (2.0 * math.pi))
        turn = np.concatenate([np.cos(0.5 * angle)[..., None], half[..., None] * vector], axis=-1)
        out: Floats = matrix_of(turn) @ self._first[index]
        return out

    def angular_velocity(self, times: Floats) -> Floats:
        """(..., 3), rad/s, against the reference, in body axes; at an entry, that of the interval after it."""
        out: Floats = self._rates[self._index(np.asarray(times, dtype=np.float64))]
        return out

    def rate_bounds(self) -> tuple[float, float]:
        """The largest rate, and 0: the rate is constant between entries; see :attr:`knots`."""
        return float(np.sqrt(np.square(self._rates).sum(axis=1)).max()) * (1.0 + 1e-14), 0.0

    def _index(self, times: Floats) -> np.ndarray[tuple[int, ...], np.dtype[np.int64]]:
        found = np.searchsorted(self._at, times, side="right") - 1
        return np.clip(found, 0, len(self._at) - 2)
