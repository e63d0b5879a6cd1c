"""The manoeuvres for arrays of starts: whether thrust suffices for each, and the room it leaves to each face.

Every sum and product is written out over whole arrays, in the order of :mod:`~safestart.closed_form.certified_point`.
A matrix product would round by the processor and the number of starts, NumPy's complex product may fuse; near a face
the verdict would then depend on who asks.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from safestart.closed_form.family import DEGREE, SMOOTH_STEP
from safestart.closed_form.rates import Rates
from safestart.constraints.corridor import corridor_of
from safestart.model.scenario import Bools, CorridorShape, Floats

Ints = np.ndarray[tuple[int, ...], np.dtype[np.int64]]

BRAKE = -1
"""Member number of the manoeuvre that only brakes; members from 0 are the family's."""

_FEW = 64
"""Up to so many starts all faces are computed at once: the same bits by fewer calls, which are most of the time."""
_INNER_STEP = SMOOTH_STEP[1:DEGREE, None]


@dataclass(frozen=True, slots=True)
class Faces:
    """Unit ``normals`` (F, d) and ``offsets`` (F, 1): offsets - normals @ p are the distances in metres."""

    names: tuple[str, ...]
    normals: Floats
    offsets: Floats

    @classmethod
    def of(cls, shape: CorridorShape, dimensions: int) -> Faces:
        """The faces of a corridor in 2-D or 3-D."""
        corridor = corridor_of(shape, dimensions)
        return cls(
            corridor.names,
            corridor.normals / corridor.lengths[:, None],
            (corridor.offsets / corridor.lengths)[:, None],
        )

    def room(self, place: Floats) -> Floats:
        """Distances (F, M) of points (d, M); negative outside."""
        return self.least_room(place[:, None])

    def least_room(self, places: Floats) -> Floats:
        """The least distances (F, M) over the middle axis of ``places`` (d, J, M)."""
        if places.shape[2] <= _FEW:
            outward = self.normals[:, 0, None, None] * places[0]
            for factor, axis in zip(self.normals.T[1:, :, None, None], places[1:], strict=True):
                outward += factor * axis
            return np.asarray(self.offsets - outward.max(axis=1))
        found = np.empty((len(self.offsets), places.shape[2]))
        for face, normal, (offset,) in zip(found, self.normals.tolist(), self.offsets.tolist(), strict=True):
            np.subtract(offset, _outward(normal, places).max(axis=0), out=face)
        return found


def _outward(normal: list[float], place: Floats) -> Floats:
    """a x + b y + c z over ``place`` (d, ...), from the left; terms of coefficient 0 change no bit."""
    terms = [(factor, axis) for factor, axis in zip(normal, place, strict=True) if factor != 0.0]
    found: Floats = terms[0][0] * terms[0][1]
    for factor, axis in terms[1:]:
        found += factor * axis
    return found


@dataclass(frozen=True, slots=True)
class Offer:
    """One manoeuvre for each start: whether thrust suffices (M,), its clearance (F, M), and its parameters."""

    flyable: Bools
    clearance: Floats
    member: Ints | int
    drop: Floats | float

    @property
    def worst(self) -> Floats:
        """The least clearance (M,) in metres, -inf without thrust."""
        return np.where(self.flyable, self.clearance.min(axis=0), -np.inf)


def offers(rates: Rates, faces: Faces, place: Floats, start: Floats) -> list[Offer]:
    """Braking and turning in with z held; in 3-D also turning in with z drawn in.

    ``place`` (d, M) in metres, ``start`` (F, M) its room.
    """
    square = place[0] * place[0] + place[1] * place[1]
    if len(place) == 2:
        held = np.sqrt(square) * rates.scale
        return [_brake(rates, faces, start, place, held), _turn_in(rates, faces, start, place, held)]
    height = place[2] * place[2]
    sway = np.abs(place[2]) * rates.sway
    # The rest of the thrust disk after n^2 z of it holds z; without a rest nothing can be flown.
    left = np.sqrt(np.maximum(1.0 - sway * sway, 1e-200))
    held = np.sqrt(square) * rates.scale / left
    drawn = np.sqrt(square + height) * rates.scale / np.maximum(1.0 - sway, 1e-200)
    return [
        _brake(rates, faces, start, place, held),
        _turn_in(rates, faces, start, place, held),
        _turn_in(rates, faces, start, place, drawn, draw=True),
    ]


def _brake(rates: Rates, faces: Faces, start: Floats, place: Floats, rho: Floats) -> Offer:
    """Straight on in the body frame, slowing down to a stop at p (1 - i beta); stands at once without speed."""
    if rates.omega == 0.0:
        # The gravity gradient is constant in the body frame, so its thrust is known, not only bounded.
        pull = 3.0 * place[0] * rates.sway
        push = place[2] * rates.sway if len(place) == 3 else 0.0
        return Offer(pull * pull + push * push <= 1.0, start, BRAKE, 0.0)
    flyable = rho <= rates.brake_limit
    if rates.speed == 0.0:
        return Offer(flyable, start, BRAKE, 0.0)
    beta = stopping_angle(rates, np.minimum(rho, rates.brake_limit))
    end = np.array(place)
    end[0] += beta * place[1]
    end[1] -= beta * place[0]
    return Offer(flyable, np.minimum(start, faces.room(end)), BRAKE, 0.0)


def stopping_angle(rates: Rates, rho: Floats) -> Floats:
    """Beta: the distance to the stop over the range, for rho <= brake_limit."""
    spare = 1.0 - rates.lost * rho
    across = rates.across * rho
    square = spare * spare - across * across
    speed = rates.speed * rates.speed
    rest = np.sqrt(np.maximum(square - 2.0 * rates.turning * speed * (rho * rho), 0.0))
    return np.asarray(speed * rho / (np.sqrt(square) + rest))


def _turn_in(
    rates: Rates, faces: Faces, start: Floats, place: Floats, rho: Floats, *, draw: bool = False
) -> Offer:
    """The first member of the family that reaches the start; its control points, each p h_j, and z held or drawn in."""
    family = rates.family
    member = family.reach.searchsorted(rho)
    flyable = member < len(family.reach)
    member = np.minimum(member, len(family.reach) - 1)
    real, imag = family.inner.real.take(member, axis=1), family.inner.imag.take(member, axis=1)
    places = np.empty((len(place), *real.shape))
    np.multiply(place[0], real, out=places[0])
    places[0] -= place[1] * imag
    np.multiply(place[0], imag, out=places[1])
    places[1] += place[1] * real
    drop: Floats | float = 0.0
    if len(place) == 3:
        drop = family.drop.take(member) if draw else 0.0
        places[2] = place[2] - place[2] * drop * _INNER_STEP
    return Offer(flyable, np.minimum(start, faces.least_room(places)), member, drop)
