"""What a checked document in space proves, in words; every number as the double it is."""

from __future__ import annotations

import math

from flint import fmpq

from safestart.proofs.space.demands import View
from safestart.proofs.space.parts import Attitude
from safestart.proofs.space.statement import SpaceStated
from safestart.proofs.wording import found, margin_parts

_AXES = {"lvlh": "LVLH", "body": "the body frame"}


def lines(stated: SpaceStated) -> tuple[str, ...]:
    """The statement, a line for each part of it."""
    return (
        _found(stated),
        *_asked(stated),
        "thrust held in LVLH axes over each step, motion in space",
        *(
            f"face {name!a}: {_vector(face.normal)} . p <= {_number(face.offset)} m for p in {_AXES[face.frame]}"
            for name, face in stated.faces.items()
        ),
        *_demands(stated),
        *_attitude(stated.attitude, stated.dt * stated.steps),
        f"orbit: mean motion {_number(stated.mean_motion)} rad/s, eccentricity {_number(stated.eccentricity)}, true "
        f"anomaly {_number(stated.true_anomaly)} rad ({_degrees(stated.true_anomaly)} deg) at t = 0",
        _thrust(stated),
        *_unknowns(stated),
        f"start, position in LVLH: {_vector(stated.start[:3])}{_around(stated.half[:3])} m",
        f"start, velocity in LVLH: {_vector(stated.start[3:])}{_around(stated.half[3:])} m/s",
    )


def _found(stated: SpaceStated) -> str:
    go, box = stated.verdict == "GO", any(stated.half)
    who = found(stated)
    if box:
        who = (
            "one thrust history, held over the steps, keeps, from every start of the box,"
            if go
            else "from no start of the box a thrust history that is held over the steps keeps more than"
        )
    parts = [*margin_parts(stated.limits), *("distance to " + ascii(name) for name in stated.demands.regions)]
    return f"{who} the margin, the least of {', '.join(parts)}"


def _unknowns(stated: SpaceStated) -> list[str]:
    said = stated.unknowns
    if said is None:
        return []
    out = ["for every member: the same thrust history keeps the margin whatever is not known"]
    if stated.verdict == "NO_GO":
        out = ["the member that is as stated: what is not known counts for no NO_GO"]
    if said.angle > 0:
        out.append(
            f"not known: the attitude at t = 0, within {_number(said.angle)} rad ({_degrees(said.angle)} deg)"
        )
    if said.rate > 0:
        when = "at t = 0" if stated.attitude.kind == "torque_free" else "at all times"
        out.append(
            f"not known: the angular velocity {when}, within {_number(said.rate)} rad/s ({_degrees(said.rate)} deg/s) "
            "in body axes"
        )
    if said.inertia > 0:
        out.append(
            f"not known: the moments about the body's axes, each within a share of {_number(said.inertia)}"
        )
    if said.disturbance > 0:
        out.append(f"not known: an acceleration of the chaser, any up to {_number(said.disturbance)} m/s^2")
    return out


def _asked(stated: SpaceStated) -> list[str]:
    limits, dt = stated.limits, _number(stated.dt)
    first, last = (f"{_double(stated.dt * k):g} s" for k in (stated.earliest, stated.steps))
    if limits.hold is None:
        out = [f"stay: inside all faces at all times for {stated.steps} steps of {dt} s ({last})"]
    else:
        out = [
            f"synchronize: inside all faces at all times until the end, which is any of the steps {stated.earliest} to "
            f"{stated.steps} of {dt} s ({first} to {last})",
            f"at the end: within {_number(limits.radius)} m of {_vector(limits.hold)} m in the body frame, at most "
            f"{_number(limits.rest)} m/s against the turning body",
        ]
    if limits.most is not None:
        out.append(f"speed: at most {_number(limits.most)} m/s in LVLH at all times")
    return out


def _demands(stated: SpaceStated) -> list[str]:
    """The demands as they are; their margins count with the others, the plume rule has none."""
    out = []
    for name, region in stated.demands.regions.items():
        axes = _AXES[region.frame]
        if isinstance(region, View):
            out.append(
                f"{name}: {_vector(region.point)} m is seen within {_number(region.angle)} rad "
                f"({_degrees(region.angle)} deg) of the direction {_vector(region.axis)}, both in {axes}"
            )
        elif len(region.size) == 1:
            out.append(
                f"keep-out {name!a}: outside the sphere of {_number(region.size[0])} m about "
                f"{_vector(region.centre)} m in {axes}"
            )
        else:
            out.append(
                f"keep-out {name!a}: outside the box of half-widths {_vector(region.size)} m about "
                f"{_vector(region.centre)} m along {axes}"
            )
    plume = stated.demands.plume
    if plume is not None:
        out.append(
            f"plume: within {_number(plume.reach)} m of {_vector(plume.point)} m in {_AXES[plume.frame]} no exhaust "
            f"(opposite to the thrust) within {_number(plume.angle)} rad ({_degrees(plume.angle)} deg) of the "
            "direction to that point"
        )
    if stated.violated:
        out.append(f"the start itself does not keep {stated.violated!a}")
    return out


def _around(half: list[fmpq]) -> str:
    return f" +- {_vector(half)}" if any(half) else ""


def _attitude(said: Attitude, horizon: fmpq) -> list[str]:
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
    # All entries that [0, horizon] touches: a table that is not printed would be any table.
    first = max(k for k, t in enumerate(said.times) if t <= 0)
    last = min(k for k, t in enumerate(said.times) if t >= horizon)
    return [
        f"attitude: against {seen}, by slerp between these quaternions (scalar first), as far as they are needed",
        *(
            f"attitude at {_number(said.times[k])} s: {_vector(said.quaternions[k])}"
            for k in range(first, last + 1)
        ),
    ]


def _thrust(stated: SpaceStated) -> str:
    limit, said = stated.thrust, stated.unknowns
    still = "" if said is not None and said.disturbance > 0 else ", no disturbance"
    if limit.kind == "ball":
        return f"thrust: at most {_number(limit.bounds[0])} m/s^2 in any direction{still}"
    axes = "LVLH" if limit.frame == "lvlh" else "the body frame at the step's begin"
    if limit.kind == "box":
        return f"thrust: at most {_vector(limit.bounds)} m/s^2 along the axes of {axes}{still}"
    arms = "; ".join(
        f"{_number(bound)} along {_vector(direction)}"
        for bound, direction in zip(limit.bounds, limit.directions, strict=True)
    )
    return f"thrust: shares, together at most 1, of thrusters in {axes}, m/s^2: {arms}{still and '; no disturbance'}"


def _degrees(value: fmpq) -> str:
    return f"{math.degrees(_double(value)):.6g}"


def _vector(values: list[fmpq]) -> str:
    return f"[{', '.join(_number(e) for e in values)}]"


def _number(value: fmpq) -> str:
    return repr(_double(value))


def _double(value: fmpq) -> float:
    return int(value.p) / int(value.q)
