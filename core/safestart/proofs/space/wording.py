"""What a checked document in space proves, in words; every number as the double it is."""

from __future__ import annotations

import math

from flint import fmpq

from safestart.proofs.space.statement import Attitude, SpaceStated

_AXES = {"lvlh": "LVLH", "body": "the body frame"}


def lines(stated: SpaceStated) -> tuple[str, ...]:
    """The statement, a line for each part of it."""
    found = "a thrust history keeps" if stated.verdict == "GO" else "no thrust history keeps more than"
    span = _double(stated.dt * stated.steps)
    return (
        f"{found} the margin, the least of the distances to the nearest face",
        f"stay: inside all faces at all times for {stated.steps} steps of {_number(stated.dt)} s ({span:g} s)",
        "thrust held in LVLH axes over each step, motion in space",
        *(
            f"face {name!a}: {_vector(face.normal)} . p <= {_number(face.offset)} m for p in {_AXES[face.frame]}"
            for name, face in stated.faces.items()
        ),
        *_attitude(stated.attitude),
        f"orbit: mean motion {_number(stated.mean_motion)} rad/s, eccentricity {_number(stated.eccentricity)}, true "
        f"anomaly {_number(stated.true_anomaly)} rad ({_degrees(stated.true_anomaly)} deg) at t = 0",
        _thrust(stated),
        f"start, position in LVLH: {_vector(stated.start[:3])} m",
        f"start, velocity in LVLH: {_vector(stated.start[3:])} m/s",
    )


def _attitude(said: Attitude) -> list[str]:
    seen = "inertial axes, those of LVLH at t = 0" if said.inertial else "LVLH"
    if said.kind == "spin":
        return [
            f"attitude: a steady spin against {seen}, about {_vector(said.axis)} at {_number(said.rate)} rad/s "
            f"({_degrees(said.rate)} deg/s), ahead by {_number(said.phase)} rad at t = 0"
        ]
    if said.kind == "torque_free":
        rows = "; ".join(_vector(row) for row in said.inertia)
        return [
            f"attitude: torque-free, inertia [{rows}] kg m^2, from LVLH at t = 0 by the quaternion (scalar first) "
            f"{_vector(said.quaternions[0])}",
            f"body rate against inertial axes at t = 0: {_vector(said.rate_vector)} rad/s",
        ]
    return [
        f"attitude: against {seen}, by slerp between {len(said.times)} quaternions from {_number(said.times[0])} s to "
        f"{_number(said.times[-1])} s"
    ]


def _thrust(stated: SpaceStated) -> str:
    limit = stated.thrust
    if limit.kind == "ball":
        return f"thrust: at most {_number(limit.bounds[0])} m/s^2 in any direction, no disturbance"
    axes = "LVLH" if limit.frame == "lvlh" else "the body frame at the step's begin"
    if limit.kind == "box":
        return f"thrust: at most {_vector(limit.bounds)} m/s^2 along the axes of {axes}, no disturbance"
    arms = "; ".join(
        f"{_number(bound)} along {_vector(direction)}"
        for bound, direction in zip(limit.bounds, limit.directions, strict=True)
    )
    return f"thrust: shares, together at most 1, of thrusters in {axes}, m/s^2: {arms}; no disturbance"


def _degrees(value: fmpq) -> str:
    return f"{math.degrees(_double(value)):.6g}"


def _vector(values: list[fmpq]) -> str:
    return f"[{', '.join(_number(e) for e in values)}]"


def _number(value: fmpq) -> str:
    return repr(_double(value))


def _double(value: fmpq) -> float:
    return int(value.p) / int(value.q)
