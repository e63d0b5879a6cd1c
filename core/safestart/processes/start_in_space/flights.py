"""Curves over time: the flight of a GO, which is the thrust history of its proof, flown; and how the target turns."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from safestart.attitude.attitude import to_body
from safestart.attitude.quaternion import quaternion_of
from safestart.exact.space.question import SpaceQuestion
from safestart.exact.space.watch import space_watch_of
from safestart.model.scenario import Floats
from safestart.optim.prediction import prediction_of

_PARTS = 4


def curves(question: SpaceQuestion, state: Floats, history: Floats) -> dict[str, Any]:
    """:class:`~safestart.processes.start_in_space.flight_output.SpaceFlight` from ``state`` (6,), LVLH.

    ``history`` (k, channels) is an answer's thrust: the flight ends with it.
    """
    watch = space_watch_of(question).until(len(history))
    return flown_curves(question, state, watch.accelerations(history))


def flown_curves(question: SpaceQuestion, state: Floats, thrust: Floats) -> dict[str, Any]:
    """The same under ``thrust`` (k, 3), LVLH, m/s^2, each held over an interval."""
    count = len(thrust)
    flown = prediction_of(question.motion, question.dt, count, 3, _PARTS).flight(state, thrust)
    states = np.concatenate([flown[:, :-1].reshape(-1, 6), flown[-1, -1:]])
    times: Floats = question.dt / _PARTS * np.arange(len(states), dtype=np.float64)
    body = to_body(question.attitude, times, states)
    distance = []
    for face in question.faces:
        seen = body if face.frame == "body" else states
        normal = np.array(face.normal)
        distance.append((face.offset - seen[:, :3] @ normal) / np.linalg.norm(normal))
    return {
        "time_s": times.tolist(),
        "lvlh_m": states[:, :3].tolist(),
        "lvlh_m_s": states[:, 3:].tolist(),
        "body_m": body[:, :3].tolist(),
        "body_m_s": body[:, 3:].tolist(),
        "attitude_wxyz": [quaternion_of(turn).tolist() for turn in question.attitude.rotation(times)],
        "thrust_m_s2": [*np.repeat(thrust, _PARTS, axis=0).tolist(), thrust[-1].tolist()],
        "distance_m": np.stack(distance, axis=1).tolist(),
        "delta_v_m_s": question.dt * math.fsum(np.linalg.norm(thrust, axis=1)),
    }


def turning(question: SpaceQuestion) -> dict[str, Any]:
    """:class:`~safestart.processes.start_in_space.flight_output.Turning` at the ends of every interval."""
    times: Floats = question.dt * np.arange(question.steps + 1, dtype=np.float64)
    return {
        "time_s": times.tolist(),
        "attitude_wxyz": [quaternion_of(turn).tolist() for turn in question.attitude.rotation(times)],
        "rate_deg_s": np.degrees(question.attitude.angular_velocity(times)).tolist(),
    }
