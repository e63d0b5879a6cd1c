"""Sets of accelerations: a product of balls over consecutive channels; a box is one ball per channel, a disk one for
both.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from safestart.errors import invalid
from safestart.model.scenario import MAX_ACCELERATION, Floats, number
from safestart.model.unit import unit

SIZES = {"box": None, "disk": (2,), "ball": (3,), "cylinder": (2, 1)}
"""Channels of every part by shape; a box has one part per channel."""


class Part(NamedTuple):
    """Channels ``begin`` to ``end`` (exclusive) lie in a ball of ``radius`` (m/s^2)."""

    begin: int
    end: int
    radius: float


@dataclass(frozen=True, slots=True)
class InputSet:
    """Admissible accelerations, centred at zero; the caller assigns axes to the channels.

    ``shape`` and ``bound`` (m/s^2): "box" with one half width per channel (1 to 3), "disk" (radius,) for two
    channels, "ball" (radius,) for three, "cylinder" (radius in the plane, half width normal to it). Raises
    ``InvalidInput`` for anything else.
    """

    shape: str
    bound: tuple[float, ...]

    def __post_init__(self) -> None:
        if self.shape not in SIZES:
            raise invalid("shape", "one of " + ", ".join(SIZES), self.shape)
        sizes = SIZES[self.shape]
        wanted = (1, 2, 3) if sizes is None else (len(sizes),)
        if len(self.bound) not in wanted:
            raise invalid("bound", f"{' or '.join(map(str, wanted))} numbers for a {self.shape}", self.bound)
        bound = tuple(number("bound", value, 0.0, MAX_ACCELERATION) for value in self.bound)
        object.__setattr__(self, "bound", bound)

    @property
    def parts(self) -> tuple[Part, ...]:
        """The balls whose product the set is."""
        sizes = SIZES[self.shape] or (1,) * len(self.bound)
        ends = np.cumsum(sizes)
        rows = zip(sizes, ends, self.bound, strict=True)
        return tuple(Part(int(end) - size, int(end), radius) for size, end, radius in rows)

    @property
    def channels(self) -> int:
        """Number of channels m."""
        return self.parts[-1].end

    @property
    def radius(self) -> float:
        """Largest size of an input, m/s^2."""
        return math.hypot(*self.bound)

    def with_bound(self, bound: tuple[float, ...]) -> InputSet:
        """Set of the same shape."""
        return InputSet(self.shape, bound)

    def restricted(self, begin: int, end: int) -> InputSet:
        """The set of channels ``begin`` to ``end``: both the section at zero and the projection of this set."""
        kept = [part for part in self.parts if part.begin < end and part.end > begin]
        radii = tuple(part.radius for part in kept)
        round_ = len(kept) == 1 and end - begin > 1
        return InputSet({2: "disk", 3: "ball"}[end - begin] if round_ else "box", radii)

    def support(self, directions: Floats) -> Floats:
        """Largest s . w (...) over inputs w, for directions s (..., m)."""
        sizes = [
            part.radius * np.linalg.norm(directions[..., part.begin : part.end], axis=-1)
            for part in self.parts
        ]
        return np.asarray(np.sum(sizes, axis=0))

    def extreme(self, directions: Floats) -> Floats:
        """Input (..., m) with the largest s . w for directions s (..., m); zero in parts where s is zero."""
        found = np.zeros_like(directions)
        for part in self.parts:
            found[..., part.begin : part.end] = part.radius * unit(directions[..., part.begin : part.end])
        return found

    def cut(self, demand: Floats) -> Floats:
        """``demand`` (..., m) cut off at the limits: per channel for a box, by its length for a disk or ball."""
        found = np.array(demand)
        for part in self.parts:
            size = np.linalg.norm(found[..., part.begin : part.end], axis=-1, keepdims=True)
            found[..., part.begin : part.end] *= part.radius / np.maximum(size, max(part.radius, 1e-300))
        return found
