"""A thrust history flown by an integrator that shares no code with the solver: SciPy's DOP853, rotations of SciPy."""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import solve_ivp

from benchmarks.peers.space_cases import turns
from safestart.exact.space.question import SpaceQuestion
from safestart.model.orbit import MU


def flown_margin(question: SpaceQuestion, state: np.ndarray, thrust: np.ndarray, samples: int = 40) -> float:
    """Least distance (m) to a face, ``samples`` times an interval: of ``state`` (6,) under ``thrust`` (N, 3), m/s^2."""
    orbit = question.orbit
    e, n = orbit.eccentricity, orbit.mean_motion
    a = (MU / n**2) ** (1.0 / 3.0)
    p = a * (1.0 - e * e)
    h = math.sqrt(MU * p)
    push = np.zeros(3)

    def rates(_: float, y: np.ndarray) -> list[float]:
        r = p / (1.0 + e * math.cos(y[6]))
        w, g = h / r**2, MU / r**3
        w_dot = -2.0 * w * (MU / h) * e * math.sin(y[6]) / r
        return [
            *y[3:6],
            (w * w + 2.0 * g) * y[0] + w_dot * y[1] + 2.0 * w * y[4] + push[0],
            -w_dot * y[0] + (w * w - g) * y[1] - 2.0 * w * y[3] + push[1],
            -g * y[2] + push[2],
            w,
        ]

    at = np.concatenate([state, [orbit.true_anomaly]])
    times, path = [np.zeros(1)], [at[None]]
    for k, push in enumerate(thrust):  # noqa: B007 - `rates` reads it
        ends = question.dt * (k + np.arange(1, samples + 1) / samples)
        found = solve_ivp(rates, (question.dt * k, ends[-1]), at, "DOP853", ends, rtol=1e-11, atol=1e-11)
        at = found.y[:, -1]
        times.append(ends)
        path.append(found.y.T)
    states = np.concatenate(path)
    seen = turns(question, np.concatenate(times), states[:, 6] - orbit.true_anomaly)
    body = np.einsum("tij,tj->ti", seen, states[:, :3])
    least = math.inf
    for face in question.faces:
        place = body if face.frame == "body" else states[:, :3]
        distance = (face.offset - place @ np.array(face.normal)) / np.linalg.norm(face.normal)
        least = min(least, float(distance.min()))
    return least
