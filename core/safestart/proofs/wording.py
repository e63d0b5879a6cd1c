"""The whole statement of a checked document in words, from the numbers that the checker has read.

Part of the checker. It prints every number as an exact double, so that nobody reads a rounded one as proved; converted
values (degrees, seconds of a number of steps) follow in brackets.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from flint import fmpq

from safestart.proofs.disturbed_statement import StatedDisturbed
from safestart.proofs.family_statement import StatedForAll
from safestart.proofs.statement import Stated

_ONE_FOR_ALL = "one thrust history, held over the steps, keeps the margin for all members of these sets"
_PER_CORNER = (
    "each corner of the start box has a thrust history, held over the steps, that keeps the margin for all values of "
    "the intervals; a start between the corners has their mixture"
)
_NONE = "no member of these sets has a thrust history, held over the steps, that keeps more than the margin"


def found(stated: Any) -> str:
    """Who keeps the margin: a NO_GO says nothing about thrust that changes within a step."""
    if stated.verdict == "GO":
        return "a thrust history, held over the steps, keeps"
    return "no thrust history that is held over the steps keeps more than"


def lines(stated: Stated) -> tuple[str, ...]:
    """The statement about one start, one line per part."""
    return (
        f"{found(stated)} the margin, {_margin(stated)}",
        *_asked(stated),
        *_arrival(stated),
        *_held(stated),
        f"tumble rate about the orbit normal, from the axes of LVLH on: {_rate(stated.w, stated.w)}",
        f"mean motion: {_value(stated.n, stated.n)} rad/s",
        f"thrust: at most {_value(stated.a_max, stated.a_max)} m/s^2, no disturbance",
        *_start(stated, None),
    )


def _arrival(stated: Stated) -> list[str]:
    if stated.arrival is None:
        return []
    stop, margin = map(_number, stated.arrival)
    return [
        f"after that end for ever: it stops against the body frame in {stop} s and stands there, at least {margin} m "
        "from every face, within the limits, by thrust that follows the turn of the body (not held over steps)"
    ]


def _held(stated: Stated) -> list[str]:
    held = stated.held
    if held is None:
        return []
    gain, cost = (", ".join(map(_vector, rows)) for rows in (held.gain, held.cost))
    limits = "the thrust limit" if stated.limits.most is None else "the limits of thrust and speed"
    return [
        f"after that end for ever under a feedback: thrust u_ref + K (x - x_ref), held over the same steps, x position "
        f"and velocity in LVLH, x_ref at {_vector(held.point)} m in the body frame at every step, u_ref what keeps it "
        f"there, K = [{gain}]; at least {_number(held.margin)} m from every face, within {limits}",
        f"so from every x with (x - x_ref)' P (x - x_ref) <= {_number(held.level)} at a step, whatever the angle of "
        f"the body, that of the end being one, P = [{cost}]",
    ]


def lines_for_all(stated: StatedForAll) -> tuple[str, ...]:
    """The statement about all members of a family."""
    middle = stated.middle
    who = {"common": _ONE_FOR_ALL, "per_corner": _PER_CORNER}.get(stated.witness, _NONE)
    return (
        f"{who}; the margin is {_margin(middle)}",
        *_asked(middle),
        f"tumble rate about the orbit normal, from the axes of LVLH on: {_rate(stated.rates[0], stated.rates[-1])}",
        f"mean motion: {_value(stated.motions[0], stated.motions[-1])} rad/s",
        f"thrust: at most {_value(stated.thrusts[0], stated.thrusts[1])} m/s^2, no disturbance",
        *_start(middle, stated.box),
    )


def lines_disturbed(stated: StatedDisturbed) -> tuple[str, ...]:
    """The statement about one start that withstands every disturbance within its bounds."""
    plan, space = stated.plan, stated.plan.d == 3
    tube = f"{_number(stated.radius)} m" + (
        f" in the orbit plane and {_number(stated.height)} m across it" if space else ""
    )
    radius, hold = stated.radius, plan.shape["hold_radius_m"]
    across = (plan.shape["c_z"] * radius + stated.height) if space else fmpq(0)
    # Every face moved in by the error bound: |A| radius off the sides' offsets, with rounded roots.
    narrow = [f"y >= {_double(hold + radius):g}"]
    c_x, x0 = (_double(plan.shape[key]) for key in ("c_x", "x0_m"))
    narrow.append(f"|x| <= {x0 - _double(radius) * math.hypot(1.0, c_x):g} + {c_x:g} (y - {_double(hold):g})")
    if space:
        c_z, z0 = (_double(plan.shape[key]) for key in ("c_z", "z0_m"))
        narrow.append(f"|z| <= {z0 - _double(across):g} + {c_z:g} (y - {_double(hold):g})")
    return (
        "a plan with feedback keeps the margin against every disturbance within these bounds; the margin is "
        f"{_margin(plan)}",
        *_asked(plan),
        f"disturbance: an acceleration of at most {_number(stated.push)} m/s^2 at all times, in any direction and any "
        "course",
        f"start: within {_number(stated.away)} m and {_number(stated.fast)} m/s of where it is believed to be",
        f"feedback on the state met at each step; the flight stays within {tube} of the plan, the feedback asks for at "
        f"most {_number(stated.thrust)} m/s^2",
        f"the plan stays in the tightened corridor (rounded), m: {', '.join(narrow)}, with "
        f"{_double(plan.a_max - stated.thrust):g} m/s^2",
        f"tumble rate about the orbit normal, from the axes of LVLH on: {_rate(plan.w, plan.w)}",
        f"mean motion: {_value(plan.n, plan.n)} rad/s",
        f"thrust: at most {_value(plan.a_max, plan.a_max)} m/s^2, plan and feedback together",
        *_start(plan, None),
    )


def question_shown(document: Mapping[str, Any]) -> dict[str, Any]:
    """Question, start and bounds of a checked document, without the parts that its kind does not use."""
    question = document["question"]
    if "corridor" not in question:
        # About the true Earth the orbit is the target's own.
        own = question.get("model") == "earth"
        read = {key: value for key, value in question.items() if not (own and key == "mean_motion_rad_s")}
        return {"question": read} | ({"start": document["start"]} if "start" in document else {})
    unused = ("c_z", "z0_m") if question["dimensions"] == 2 else ()
    corridor = {key: value for key, value in question["corridor"].items() if key not in unused}
    bounds = {key: document[key] for key in ("disturbance", "feedback", "tube") if key in document}
    return {"question": question | {"corridor": corridor}, "start": document["start"]} | bounds


def _margin(stated: Stated) -> str:
    least, *also = margin_parts(stated.limits)
    return f"the least of {', '.join([least, *also])}" if also else least


def margin_parts(limits: Any) -> list[str]:
    """The distances (m) whose least is the margin, in words; ``limits`` has a speed limit and an end, or neither."""
    parts = ["the distance to the nearest face"]
    if limits.most is not None:
        parts.append(f"{_number(limits.scale)} s times the speed left to the limit")
    if limits.hold is not None:
        parts.append("at the end the distance to the edge of the hold ball")
        parts.append(f"{_number(limits.radius)} / {_number(limits.rest)} s times the speed left to rest")
    return parts


def _asked(stated: Stated) -> list[str]:
    """Question, corridor and limits."""
    limits, last = stated.limits, _seconds(stated, stated.steps)
    if limits.hold is None:
        out = [
            f"stay: in the corridor at all times for {stated.steps} steps of {_number(stated.dt)} s ({last})"
        ]
    else:
        out = [
            f"synchronize: in the corridor at all times until the end, which is any of the steps {stated.earliest} to "
            f"{stated.steps} of {_number(stated.dt)} s ({_seconds(stated, stated.earliest)} to {last})",
            f"at the end: within {_number(limits.radius)} m of {_vector(limits.hold)} m in the body frame, at most "
            f"{_number(limits.rest)} m/s against it",
        ]
    out.append(f"thrust held over each step, motion {'in the orbit plane' if stated.d == 2 else 'in space'}")
    shape = {key: _number(value) for key, value in stated.shape.items()}
    behind = f"(y - {shape['hold_radius_m']})"
    sides = [f"y >= {shape['hold_radius_m']}"]
    sides += [
        f"|{axis}| <= {shape[f'{axis}0_m']} + {shape[f'c_{axis}']} {behind}" for axis in "xz"[: stated.d - 1]
    ]
    out.append(f"corridor in the body frame, m: {', '.join(sides)}")
    if limits.most is not None:
        out.append(f"speed: at most {_number(limits.most)} m/s in LVLH at all times")
    if limits.keep_out is not None:
        out.append(
            f"keep-out radius: {_number(limits.keep_out)} m around the target's centre, by the hold plane"
        )
    return out


def _start(stated: Stated, box: list[fmpq] | None) -> list[str]:
    d, out = stated.d, []
    for name, unit, first in (("position", "m", 0), ("velocity", "m/s", d)):
        around = "" if box is None else f" +- {_vector(box[first : first + d])}"
        out.append(f"start, {name} in LVLH: {_vector(stated.start[first : first + d])}{around} {unit}")
    return out


def _seconds(stated: Stated, steps: int) -> str:
    return f"{float(_double(stated.dt * steps)):g} s"


def _rate(low: fmpq, high: fmpq) -> str:
    return f"{_value(low, high)} rad/s ({_value(low, high, math.degrees(1.0))} deg/s)"


def _value(low: fmpq, high: fmpq, factor: float | None = None) -> str:
    """A number, or an interval if its ends differ; only converted values are rounded."""
    ends = [_number(e) if factor is None else f"{_double(e) * factor:.6g}" for e in (low, high)]
    return ends[0] if low == high else f"{ends[0]} to {ends[1]}"


def _vector(values: list[fmpq]) -> str:
    return f"[{', '.join(_number(e) for e in values)}]"


def _number(value: fmpq) -> str:
    """The shortest text that reads as the same double."""
    return repr(_double(value))


def _double(value: fmpq) -> float:
    return int(value.p) / int(value.q)
