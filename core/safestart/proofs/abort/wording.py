"""A missed-burn statement in lines: all that a document proves.

Every number is the double that the document holds; converted ones (degrees, per cent) follow in brackets.
"""

from __future__ import annotations

import math

from flint import fmpq

from safestart.proofs.abort.statement import Asked, Zone


def lines(asked: Asked) -> tuple[str, ...]:
    """The statement, one line per part."""
    box = [_double(e) for e in asked.box]
    held = "before every burn" if asked.anew else "before the first burn; the errors of the burns add up"
    failures = ["missed, as all after it"]
    if asked.partial:
        failures.append("burnt in part, 0 to 100 %")
    if asked.late > 0:
        failures.append(f"late by up to {_double(asked.late)!r} s")
    if asked.stuck > 0:
        own = " or its own thrust" if any(asked.durations) else ""
        failures.append(
            f"stuck on for up to {_double(asked.stuck)!r} s at {_double(asked.acceleration)!r} m/s^2{own}"
        )
    if asked.misdirected > 0:
        failures.append(f"misdirected by up to {_angle(asked.misdirected)}")
    if any(asked.durations):
        failures.append("ended early, at any time, where it has a duration")
    return (
        f"at all times the chaser stays {_double(asked.keep_out)!r} m away from {_from(asked)}, and more: "
        f"{_double(asked.least)!r} m",
        _model(asked),
        f"horizon: {_double(asked.horizon)!r} s after the end of the last burn that is made",
        f"any burn is {'; or '.join(failures)}; no burn follows a failure",
        f"states: within {box[:3]} m and {box[3:]} m/s of the plan {held}",
        *(
            [f"and off by L b, |b| <= 1, columns of L: {[[_double(e) for e in m] for m in asked.ellipsoid]}"]
            if asked.ellipsoid
            else []
        ),
        f"burns: size within a share of {_double(asked.share)!r} ({100 * _double(asked.share):g} %), direction within "
        f"{_angle(asked.angle)}",
        *(
            [f"start in LVLH: {[_double(e) for e in asked.start]} m, m/s"]
            if asked.earth is None
            else [
                f"before burn {k} in LVLH: {[_double(e) for e in state]} m, m/s"
                for k, state in enumerate(asked.earth.before)
            ]
        ),
        *(
            f"burn {k} at {_double(time)!r} s: {[_double(e) for e in impulse]} m/s"
            + (f", evenly over {_double(lasts)!r} s, its errors at any time of it" if lasts else "")
            for k, (time, impulse, lasts) in enumerate(
                zip(asked.times, asked.impulses, asked.durations, strict=True)
            )
        ),
    )


def _from(asked: Asked) -> str:
    zones = [_zone(zone) for zone in asked.zones if not zone.is_point]
    if len(zones) < len(asked.zones):
        zones.insert(0, "the target")
    return " and from ".join(zones)


def _zone(zone: Zone) -> str:
    """The body itself: what axes of other lengths or directions would make of its name does not matter."""
    centre, axes = [_double(e) for e in zone.centre], [[_double(e) for e in axis] for axis in zone.axes]
    if zone.kind == "sphere":
        return f"the sphere of {axes[0][0]!r} m about {centre} m, LVLH"
    what = "[-1, 1] times each" if zone.kind == "box" else "the unit ball times the columns"
    return f"the {zone.kind} of {centre} m and {what} of {axes} m, LVLH"


def _angle(value: fmpq) -> str:
    return f"{_double(value)!r} rad ({math.degrees(_double(value)):g} deg)"


def _model(asked: Asked) -> str:
    if asked.earth is not None:
        state = [_double(e) for e in asked.earth.state]
        return (
            f"model: earth, both bodies about the Earth with J2 = {_double(asked.earth.j2)!r} (mu "
            f"{_double(asked.earth.mu)!r} m^3/s^2, radius {_double(asked.earth.radius)!r} m); the target at "
            f"{state[:3]} m, {state[3:]} m/s, inertial, at the first burn; no drag, no other force"
        )
    n = f"mean motion {_double(asked.n)!r} rad/s"
    if asked.radius is None:
        return f"model: linear (CWH) about a circular orbit, {n}"
    return (
        f"model: nonlinear, two point masses, circular orbit of {_double(asked.radius)!r} m, {n}; the plan's states "
        "before its burns are those of CWH motion from the start"
    )


def _double(value: fmpq) -> float:
    return int(value.p) / int(value.q)
