"""The largest ellipsoid of errors that a loop corrects without meeting a limit, at every angle of the body.

The error e (LVLH) obeys e(k+1) = F e(k), and tau after a node it is M(tau) e. {e' P e <= rho} is invariant, as
F' P F <= P, and it is to do at every angle of the body. At tau the reference keeps room(tau) of each face, and the
error takes at most sqrt(rho lambda_max(M_p P^-1 M_p')) of it, whatever way the face points; so does the thrust, and
what else the loop needs to stay as it is.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from safestart.control.hold.loop import Loop, Loss, Room
from safestart.model.scenario import Floats


@dataclass(frozen=True, slots=True)
class Ellipsoid:
    """{e' P e <= ``level``}; ``limited_by`` names a limit; level 0: the hold itself is not possible."""

    level: float
    limited_by: str
    volume: float
    extents: Floats


def rooms_of(hold: Loop, speed_limit: float | None = None) -> tuple[Room, ...]:
    """The thrust limit, every face at every watched instant, the LVLH ``speed_limit`` (m/s) if there is one, and the
    loop's own conditions."""
    normals = hold.corridor.normals / hold.corridor.lengths[:, None]
    offsets = hold.corridor.offsets / hold.corridor.lengths
    out = [Room("thrust", hold.usable - hold.reference.most_thrust, hold.reach_of(hold.rows))]
    for tau in hold.instants().tolist():
        reach = hold.reach_of(hold.moved(tau))
        place, radius = hold.reference.between(tau)
        room = offsets - normals @ place - radius
        out += [
            Room(name, float(each), reach, "sag")
            for name, each in zip(hold.corridor.names, room, strict=True)
        ]
        if speed_limit is not None:
            reach = hold.reach_of(hold.moved(tau, velocity=True))
            out.append(Room("speed", speed_limit - hold.reference.most_speed(tau), reach, "rise"))
    return (*out, *hold.conditions())


def lost_of(hold: Loop, level: float) -> dict[Loss, float]:
    """By how much a distance (m) may fall and a speed (m/s) may rise between the instants, in that ellipsoid."""
    inverse = np.linalg.inv(hold.cost)
    size = np.sqrt(level * np.array([np.linalg.eigvalsh(inverse[k : k + 2, k : k + 2])[-1] for k in (0, 2)]))
    position, velocity = size.tolist()
    return {"none": 0.0, "sag": hold.sag(position, velocity), "rise": hold.rise(position, velocity)}


def largest(hold: Loop, rooms: tuple[Room, ...]) -> tuple[float, str]:
    """The largest level within the rooms, and which of them limits it."""
    # Without losses it is too large: its size bounds that of the answer.
    level, name = _largest(rooms, {"none": 0.0, "sag": 0.0, "rise": 0.0})
    return _largest(rooms, lost_of(hold, level)) if level > 0.0 else (level, name)


def _largest(rooms: tuple[Room, ...], lost: dict[Loss, float]) -> tuple[float, str]:
    return min((max(one.room - lost[one.loss], 0.0) ** 2 / one.reach, one.name) for one in rooms)


def distance_left(hold: Loop, rooms: tuple[Room, ...], level: float) -> float:
    """Least distance to a face, m, at all times of all flights from that ellipsoid."""
    faces = [one for one in rooms if one.loss == "sag"]
    return min(one.room - math.sqrt(level * one.reach) for one in faces) - lost_of(hold, level)["sag"]


def ellipsoid(hold: Loop) -> Ellipsoid:
    """The largest one, at every angle of the body."""
    level, name = largest(hold, rooms_of(hold))
    half = len(hold.cost) // 2
    ball = math.pi**half / math.factorial(half)
    volume = ball * level**half / math.sqrt(float(np.linalg.det(hold.cost)))
    return Ellipsoid(level, name, volume, np.sqrt(level * np.diag(np.linalg.inv(hold.cost))))
