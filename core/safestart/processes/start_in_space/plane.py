"""Planes of the wire as planes of LVLH states."""

from __future__ import annotations

import math

import numpy as np

from safestart.exact.space.plane import Plane
from safestart.exact.space.question import SpaceQuestion, starts_in_lvlh
from safestart.model.scenario import Floats, Rest
from safestart.processes.start_in_space.plane_input import PlaneInput


def plane_of(said: PlaneInput, question: SpaceQuestion) -> Plane:
    """In LVLH and SI units."""
    columns = []
    for axis in (said.first, said.second):
        length = math.hypot(*axis.direction)
        unit = [e / length for e in axis.direction]
        still = [0.0, 0.0, 0.0]
        columns.append(unit + still if axis.kind == "position" else still + unit)
    rows = np.array([said.origin_m + said.velocity_m_s, *columns])
    moved = _in_lvlh(said, question, rows)
    return Plane(
        moved[0],
        moved[1:].T,
        np.array([said.first.low, said.second.low]),
        np.array([said.first.high, said.second.high]),
    )


def _in_lvlh(said: PlaneInput, question: SpaceQuestion, rows: Floats) -> Floats:
    """States (K, 6) of ``frame`` and ``rest`` as LVLH states: a linear map."""
    at, attitude = np.zeros(1), question.attitude
    turn, omega = attitude.rotation(at)[0], attitude.angular_velocity(at)[0]
    body = rows.reshape(-1, 2, 3) if said.frame == "body" else rows.reshape(-1, 2, 3) @ turn.T
    position, velocity = body[:, 0], body[:, 1]
    if said.rest is Rest.LVLH:
        velocity = velocity - np.cross(omega, position)
    return starts_in_lvlh(attitude, position, velocity)
