"""Documents against a disturbance, decided by other means: matrix exponentials, dense samples, worst pushes summed."""

from __future__ import annotations

import math
from dataclasses import replace
from random import Random
from typing import Any

import numpy as np

from tests.fuzzing.plane.decided import Member, Truth, rows_of, steps_of, truth
from tests.fuzzing.plane.printed import Printed

_PANELS, _DIRECTIONS = 48, 24


def truth_against(claim: Printed, document: Any, rng: Random) -> Truth:
    """What is printed of the bounds, and whether the document's own feedback, tube and plan bear it out."""
    bounds, tube, feedback = document["disturbance"], document["tube"], document["feedback"]
    said = (claim.push, claim.away, claim.fast, claim.radius_m, claim.height_m, claim.feedback)
    held = (
        *(bounds[key] for key in ("acceleration_m_s2", "position_m", "velocity_m_s")),
        *(tube["radius_m"], tube.get("height_m", 0.0), tube["thrust_m_s2"]),
    )
    if tuple(map(float, held)) != said:
        return "false"
    # With no disturbance at all, and the start where it is believed to be, it must hold as well.
    nominal = truth(replace(claim, who="one"), rng)
    if nominal != "true":
        return nominal
    thrust = math.hypot(
        _reaches(claim, claim.push, claim.away, claim.fast, feedback, tube["radius_m"], cross=False),
        _reaches(claim, claim.push, claim.away, claim.fast, feedback, claim.height_m, cross=True)
        if claim.d == 3
        else 0.0,
    )
    if not thrust <= claim.feedback * (1.0 + 1e-6) + 1e-12:
        return "false"
    return "true" if _plan_holds(claim, np.array(document["thrust_m_s2"], dtype=np.float64)) else "false"


def _reaches(
    claim: Printed, push: float, away: float, fast: float, feedback: Any, limit: float, *, cross: bool
) -> float:
    """What the feedback may ask for; infinite where the error may leave ``limit``."""
    d = claim.d
    axes = [2] if cross else [0, 1]
    kept = [*axes, *(d + axis for axis in axes)]
    gain = np.array(feedback["cross" if cross else "plane"], dtype=np.float64)
    phi, held = steps_of(claim.motions[0], claim.dt, d, _PANELS)
    phi, held = phi[:, kept][:, :, kept], held[:, kept][:, :, axes]
    m = len(axes)
    closed = phi[-1] + held[-1] @ gain
    angles = np.pi * np.arange(_DIRECTIONS) / _DIRECTIONS
    unit = np.column_stack([np.cos(angles), np.sin(angles)]) if m == 2 else np.ones((1, 1))
    h = claim.dt / _PANELS
    asked = 0.0
    for j in [None, *range(0, _PANELS + 1, 4)]:
        matrix = gain if j is None else (phi[j] + held[j] @ gain)[:m]
        rows, driven, begun = unit @ matrix, np.zeros(len(unit)), np.zeros(len(unit))
        for k in range(claim.ends[1] + 1):
            begun = np.maximum(
                begun,
                away * np.linalg.norm(rows[:, :m], axis=1) + fast * np.linalg.norm(rows[:, m:], axis=1),
            )
            # The last interval is on its way only: what it does comes below.
            if k < claim.ends[1] - 1:
                sizes = np.linalg.norm(np.einsum("ri,jic->jrc", rows, phi[:, :, m:]), axis=2)
                driven += push * h * (sizes.sum(axis=0) - 0.5 * (sizes[0] + sizes[-1]))
            rows = rows @ closed
        late = 0.0
        if j:
            sizes = np.linalg.norm(phi[: j + 1, :m, m:], axis=(1, 2)) / math.sqrt(m)
            late = push * h * (sizes.sum() - 0.5 * (sizes[0] + sizes[-1]))
        worst = float((driven + begun).max())
        if j is None:
            asked = worst
        elif worst + 0.99 * late > limit * (1.0 + 1e-4) + 1e-9:
            return math.inf
    return asked


def _plan_holds(claim: Printed, thrust: Any) -> bool:
    sizes = np.linalg.norm(thrust, axis=1)
    if not sizes.max() <= (claim.thrusts[0] - claim.feedback) * (1.0 + 1e-12):
        return False
    member = Member(claim.rates[0], claim.motions[0], claim.thrusts[0], claim.start)
    constant, rows, _, _ = rows_of(claim, member, claim.ends[1], 200)
    distance = (constant + rows @ thrust.ravel()).reshape(-1, 1 + 2 * len(claim.sides))
    taken = [claim.radius_m] * 3
    if claim.d == 3:
        c_z = claim.sides[1][0]
        taken += [(c_z * claim.radius_m + claim.height_m) / math.hypot(1.0, c_z)] * 2
    return bool((distance.min(axis=0) >= claim.margin + np.array(taken) - 1e-6).all())
