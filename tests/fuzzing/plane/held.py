"""Whether what is printed about a feedback after the end is true, by matrix exponentials and eigenvalues in floats.

The largest image of the ellipsoid k steps later, at instants of a step and against every direction, is closed-form;
so no cost function needs to fall and no flight is drawn. A feedback whose loop is not stable leaves in the end.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from tests.fuzzing.plane.decided import Truth, steps_of
from tests.fuzzing.plane.printed import Feedback, Printed

_INSTANTS, _STEPS, _TOLERANCE = 40, 60, 1e-7


def truth_held(claim: Printed, said: Feedback, document: dict[str, Any]) -> Truth:
    """ "true" means: nothing was found against it."""
    if not (said.level > 0.0 and said.margin > 0.0):
        return "false"
    gain, cost = np.array(said.gain), np.array(said.cost)
    if np.linalg.eigvalsh(cost)[0] <= 0.0 or (cost != cost.T).any():
        return "false"
    w, a_max, dt = claim.rates[0], claim.thrusts[0], claim.dt
    phi, held = steps_of(claim.motions[0], dt, 2, _INSTANTS)
    closed = phi[-1] + held[-1] @ gain
    if np.abs(np.linalg.eigvals(closed)).max() >= 1.0:
        return "false"
    angles, states, thrusts = _reference(said.point, w, dt, phi[-1], held[-1])
    if not _ends_inside(claim, said, document, phi[-1], held[-1]):
        return "false"
    faces = [(np.array([0.0, -1.0]), -claim.plane)]
    (slope, width) = claim.sides[0]
    for sign in (1.0, -1.0):
        length = math.hypot(1.0, slope)
        faces.append((np.array([sign, -slope]) / length, (width - slope * claim.plane) / length))
    # The ellipsoid is root y, |y| <= 1.
    root = math.sqrt(said.level) * np.linalg.inv(np.linalg.cholesky(cost)).T
    for _ in range(_STEPS):
        asked = np.linalg.svd(gain @ root, compute_uv=False)[0]
        if np.linalg.norm(thrusts, axis=1).max() + asked > a_max * (1.0 + _TOLERANCE) + 2e-4 * a_max:
            return "false"
        for j in range(_INSTANTS + 1):
            moved = (phi[j] + held[j] @ gain) @ root
            place, fast = (np.linalg.svd(moved[k : k + 2], compute_uv=False)[0] for k in (0, 2))
            seen = states @ phi[j].T + thrusts @ held[j].T
            if (
                claim.speed is not None
                and np.linalg.norm(seen[:, 2:], axis=1).max() + fast > claim.speed + 1e-4
            ):
                return "false"
            body = _turned(seen[:, :2], -(angles + w * dt * j / _INSTANTS))
            for normal, offset in faces:
                if offset - (body @ normal).max() - place < said.margin - _TOLERANCE:
                    return "false"
        root = closed @ root
    return "true"


def _reference(point: tuple[float, ...], w: float, dt: float, phi: Any, held: Any) -> Any:
    """Angles (A,) of the body at a node, with the states (A, 4) and thrusts (A, 2) that are at the point.

    The velocity is a turning vector, so its value at two angles a step apart is linear in (cos, sin) of the angle.
    """
    angles = np.linspace(0.0, 2.0 * math.pi, 64, endpoint=False)
    # v(angle) = C cos + S sin and u likewise: eight unknowns; position and velocity a step later, at two angles.
    rows, right = [], []
    for angle in (0.3, 1.7):
        now, then = (np.array([math.cos(a), math.sin(a)]) for a in (angle, angle + w * dt))
        at, later = (_turned(np.array([point]), np.array([a]))[0] for a in (angle, angle + w * dt))
        before, after = (np.kron(e, np.eye(2)) for e in (now, then))
        left = np.hstack([phi[:, 2:] @ before, held @ before])
        left[2:, :4] -= after
        rows.append(left)
        right.append(np.r_[later, 0.0, 0.0] - phi[:, :2] @ at)
    found = np.linalg.solve(np.vstack(rows), np.concatenate(right))
    waves = np.column_stack([np.cos(angles), np.sin(angles)])
    places = _turned(np.tile(point, (len(angles), 1)), angles)
    return angles, np.hstack([places, waves @ found[:4].reshape(2, 2)]), waves @ found[4:].reshape(2, 2)


def _turned(points: Any, angles: Any) -> Any:
    c, s = np.cos(angles), np.sin(angles)
    return np.column_stack([c * points[:, 0] - s * points[:, 1], s * points[:, 0] + c * points[:, 1]])


def _ends_inside(claim: Printed, said: Feedback, document: dict[str, Any], phi: Any, held: Any) -> bool:
    state = np.array(claim.start)
    for u in document["thrust_m_s2"]:
        state = phi @ state + held @ np.array(u)
    angle = claim.rates[0] * claim.dt * len(document["thrust_m_s2"])
    angles, states, _ = _reference(said.point, claim.rates[0], claim.dt, phi, held)
    error = state - _between(angles, states, angle)
    # Rounding of states moves the cost by twice its slope.
    slack = 1e-9 * (1.0 + float(np.abs(state).max())) * np.linalg.norm(np.array(said.cost), 2)
    return bool(
        error @ np.array(said.cost) @ error <= said.level * (1.0 + 1e-9) + slack * np.linalg.norm(error)
    )


def _between(angles: Any, values: Any, angle: float) -> Any:
    """The harmonic through equally spaced values, at any angle."""
    share = 2.0 / len(angles)
    return share * (np.cos(angles - angle) @ values)
