"""The largest ellipsoid of errors that the LQR corrects without leaving the corridor or the thrust limit.

The error e = x - x_ref (LVLH, 4) obeys e(k+1) = F e(k), and tau after a node it is M(tau) e, M = Phi - B K. {e' P e <=
rho} is invariant, as F' P F <= P, and it is to do at every angle of the body. At tau the reference keeps room(tau) of
each face, and the error takes at most sqrt(rho lambda_max(M_p P^-1 M_p')) of it, whatever way the face points; so does
-K e of the thrust.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from safestart.control.hold.loop import Hold
from safestart.model.scenario import Floats


@dataclass(frozen=True, slots=True)
class Ellipsoid:
    """{e' P e <= ``level``}; ``limited_by`` names a face or the thrust; level 0: the hold itself is not possible."""

    level: float
    limited_by: str
    volume: float
    extents: Floats


@dataclass(frozen=True, slots=True)
class Room:
    """What the reference leaves of one limit, ``room`` (m, m/s^2 or m/s); errors of level rho take up to
    sqrt(rho ``reach``) of it."""

    name: str
    room: float
    reach: float


_SPEED, _THRUST = "speed", "thrust"


def rooms_of(hold: Hold, speed_limit: float | None = None) -> tuple[Room, ...]:
    """The thrust limit, every face at every watched instant, and the LVLH ``speed_limit`` (m/s) if there is one."""
    inverse = np.linalg.inv(hold.design.cost)
    normals = hold.corridor.normals / hold.corridor.lengths[:, None]
    offsets = hold.corridor.offsets / hold.corridor.lengths
    spread = hold.design.gain @ inverse @ hold.design.gain.T
    out = [Room(_THRUST, hold.usable - hold.reference.most_thrust, float(np.linalg.eigvalsh(spread)[-1]))]
    for tau in hold.instants().tolist():
        rows = hold.moved(tau)
        reach = float(np.linalg.eigvalsh(rows @ inverse @ rows.T)[-1])
        place, radius = hold.reference.between(tau)
        room = offsets - normals @ place - radius
        out += [Room(name, float(each), reach) for name, each in zip(hold.corridor.names, room, strict=True)]
        if speed_limit is not None:
            rows = hold.moved(tau, velocity=True)
            reach = float(np.linalg.eigvalsh(rows @ inverse @ rows.T)[-1])
            out.append(Room(_SPEED, speed_limit - hold.reference.most_speed(tau), reach))
    return tuple(out)


def lost_of(hold: Hold, level: float) -> tuple[float, float]:
    """By how much a distance (m) may fall and a speed (m/s) may rise between the instants, in that ellipsoid."""
    inverse = np.linalg.inv(hold.design.cost)
    size = np.sqrt(level * np.array([np.linalg.eigvalsh(inverse[k : k + 2, k : k + 2])[-1] for k in (0, 2)]))
    return hold.sag(float(size[0]), float(size[1])), hold.rise(float(size[0]), float(size[1]))


def largest(hold: Hold, rooms: tuple[Room, ...]) -> tuple[float, str]:
    """The largest level within the rooms, and which of them limits it."""
    # Without losses it is too large: its size bounds that of the answer.
    level, name = _largest(rooms, 0.0, 0.0)
    return _largest(rooms, *lost_of(hold, level)) if level > 0.0 else (level, name)


def _largest(rooms: tuple[Room, ...], sag: float, rise: float) -> tuple[float, str]:
    lost = {_THRUST: 0.0, _SPEED: rise}
    return min((max(one.room - lost.get(one.name, sag), 0.0) ** 2 / one.reach, one.name) for one in rooms)


def distance_left(hold: Hold, rooms: tuple[Room, ...], level: float) -> float:
    """Least distance to a face, m, at all times of all flights from that ellipsoid."""
    sag, _ = lost_of(hold, level)
    faces = [one for one in rooms if one.name not in (_THRUST, _SPEED)]
    return min(one.room - math.sqrt(level * one.reach) for one in faces) - sag


def ellipsoid(hold: Hold) -> Ellipsoid:
    """The largest one, at every angle of the body."""
    level, name = largest(hold, rooms_of(hold))
    volume = 0.5 * math.pi**2 * level**2 / math.sqrt(float(np.linalg.det(hold.design.cost)))
    extents = np.sqrt(level * np.diag(np.linalg.inv(hold.design.cost)))
    return Ellipsoid(level, name, volume, extents)
