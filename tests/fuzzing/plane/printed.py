"""Read a printed statement back from its lines alone, as a reader would."""

from __future__ import annotations

import json
import math
import re
from dataclasses import dataclass, field
from typing import Any

Range = tuple[float, float]
_NUMBER = r"-?[0-9.]+(?:e[-+]?[0-9]+)?"
_VECTOR = rf"\[{_NUMBER}(?:, {_NUMBER})*\]"
_ROWS = rf"{_VECTOR}(?:, {_VECTOR})*"
_VALUE = rf"{_NUMBER}(?: to {_NUMBER})?"
_BRACKET = r" \([^()]*\)"
_LINES = (
    r"(?P<who>.+?)(?: the margin, |; the margin is )(?P<margin>the .*)",
    rf"stay: in the corridor at all times for (?P<steps>\d+) steps of (?P<dt>{_NUMBER}) s{_BRACKET}",
    rf"synchronize: in the corridor at all times until the end, which is any of the steps (?P<first>\d+) to "
    rf"(?P<last>\d+) of (?P<dt>{_NUMBER}) s{_BRACKET}",
    rf"at the end: within (?P<radius>{_NUMBER}) m of (?P<hold>{_VECTOR}) m in the body frame, at most "
    rf"(?P<rest>{_NUMBER}) m/s against it",
    rf"after that end for ever: it stops against the body frame in (?P<stop>{_NUMBER}) s and stands there, at least "
    rf"(?P<after>{_NUMBER}) m from every face, within the limits, by thrust that follows the turn of the body "
    r"\(not held over steps\)",
    rf"after that end for ever under a feedback: thrust u_ref \+ K \(x - x_ref\), held over the same steps, x position "
    rf"and velocity in LVLH, x_ref at (?P<point>{_VECTOR}) m in the body frame at every step, u_ref what keeps it "
    rf"there, K = \[(?P<gain>{_ROWS})\]; at least (?P<kept>{_NUMBER}) m from every face, within "
    r"(?P<within>the thrust limit|the limits of thrust and speed)",
    rf"so from every x with \(x - x_ref\)' P \(x - x_ref\) <= (?P<level>{_NUMBER}) at a step, whatever the angle of "
    rf"the body, that of the end being one, P = \[(?P<cost>{_ROWS})\]",
    r"thrust held over each step, motion in (?P<space>the orbit plane|space)",
    rf"corridor in the body frame, m: y >= (?P<plane>{_NUMBER}), "
    rf"\|x\| <= (?P<x0>{_NUMBER}) \+ (?P<c_x>{_NUMBER}) \(y - (?P=plane)\)"
    rf"(?:, \|z\| <= (?P<z0>{_NUMBER}) \+ (?P<c_z>{_NUMBER}) \(y - (?P=plane)\))?",
    rf"speed: at most (?P<speed>{_NUMBER}) m/s in LVLH at all times",
    rf"keep-out radius: (?P<keep_out>{_NUMBER}) m around the target's centre, by the hold plane",
    rf"tumble rate about the orbit normal, from the axes of LVLH on: (?P<rate>{_VALUE}) rad/s{_BRACKET}",
    rf"mean motion: (?P<motion>{_VALUE}) rad/s",
    rf"thrust: at most (?P<thrust>{_VALUE}) m/s\^2, no disturbance",
    rf"thrust: at most (?P<thrust>{_VALUE}) m/s\^2, plan and feedback together",
    rf"disturbance: an acceleration of at most (?P<push>{_NUMBER}) m/s\^2 at all times, in any direction "
    rf"and any course",
    rf"start: within (?P<away>{_NUMBER}) m and (?P<slip>{_NUMBER}) m/s of where it is believed to be",
    rf"feedback on the state met at each step; the flight stays within (?P<tube>{_NUMBER}) m"
    rf"(?: in the orbit plane and (?P<height>{_NUMBER}) m across it)? of the plan, the feedback asks for at most "
    rf"(?P<asks>{_NUMBER}) m/s\^2",
    rf"the plan stays in the tightened corridor \(rounded\), m: y >= (?P<tight>{_NUMBER}), "
    rf"\|x\| <= (?P<tight_x>{_NUMBER}) \+ {_NUMBER} \(y - {_NUMBER}\)"
    rf"(?:, \|z\| <= (?P<tight_z>{_NUMBER}) \+ {_NUMBER} \(y - {_NUMBER}\))?, with (?P<left>{_NUMBER}) m/s\^2",
    rf"start, position in LVLH: (?P<position>{_VECTOR})(?: \+- (?P<wide>{_VECTOR}))? m",
    rf"start, velocity in LVLH: (?P<velocity>{_VECTOR})(?: \+- (?P<fast>{_VECTOR}))? m/s",
)
_WHO = {
    "a thrust history, held over the steps, keeps": ("GO", "one"),
    "no thrust history that is held over the steps keeps more than": ("NO_GO", "one"),
    "one thrust history, held over the steps, keeps the margin for all members of these sets": (
        "GO",
        "common",
    ),
    "each corner of the start box has a thrust history, held over the steps, that keeps the margin for all values of "
    "the intervals; a start between the corners has their mixture": ("GO", "per_corner"),
    "a plan with feedback keeps the margin against every disturbance within these bounds": ("GO", "against"),
    "no member of these sets has a thrust history, held over the steps, that keeps more than the margin": (
        "NO_GO",
        "any",
    ),
}
_FACES = "the distance to the nearest face"


Rows = tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class Feedback:
    """What is said of a feedback after the end: ``margin`` m kept from every x whose cost is at most ``level``."""

    point: tuple[float, ...]
    gain: Rows
    cost: Rows
    level: float
    margin: float


@dataclass(frozen=True)
class Printed:
    """A claim: ``verdict`` with ``margin`` m for ``who``; ranges are (low, high), ``half`` is 0 for a known start."""

    verdict: str
    margin: float
    who: str
    d: int
    ends: tuple[int, int]
    dt: float
    plane: float
    sides: tuple[tuple[float, float], ...]
    rates: Range
    motions: Range
    thrusts: Range
    start: tuple[float, ...]
    half: tuple[float, ...]
    hold: tuple[float, ...] = ()
    radius: float = 0.0
    rest: float = 0.0
    speed: float | None = None
    scale: float = 0.0
    keep_out: float = 0.0
    stop: float | None = None
    after: float = 0.0
    push: float = 0.0
    away: float = 0.0
    fast: float = 0.0
    radius_m: float = 0.0
    height_m: float = 0.0
    feedback: float = 0.0
    held: Feedback | None = None
    lines: tuple[str, ...] = field(default=(), compare=False)


def printed(verdict: str, margin: float, lines: tuple[str, ...]) -> Printed:
    """What the lines claim; fails on a line that it cannot read, and on one that contradicts another."""
    found: dict[str, str] = {}
    for line in lines:
        groups = [match.groupdict() for pattern in _LINES if (match := re.fullmatch(pattern, line))]
        assert len(groups) == 1, line
        new = {key: value for key, value in groups[0].items() if value is not None}
        assert not set(new) & set(found), line
        found |= new
    said, who = _WHO[found["who"]]
    assert said == verdict, (verdict, found["who"])
    d = 2 if found["space"] == "the orbit plane" else 3
    assert ("z0" in found) is (d == 3), lines
    first, last = ("steps", "steps") if "steps" in found else ("first", "last")
    start, half = _vector(found, "position", d) + _vector(found, "velocity", d), (0.0,) * (2 * d)
    if "wide" in found:
        half = _vector(found, "wide", d) + _vector(found, "fast", d)
    number = {key: float(found[key]) for key in ("dt", "plane", "x0", "c_x", "z0", "c_z") if key in found}
    out: dict[str, Any] = {}
    terms = [_FACES]
    assert (who == "against") is ("push" in found) is ("tube" in found) is ("tight" in found), lines
    if who == "against":
        out |= {
            **{
                name: float(found[key])
                for name, key in (("push", "push"), ("away", "away"), ("fast", "slip"))
            },
            "radius_m": float(found["tube"]),
            "height_m": float(found.get("height", 0.0)),
            "feedback": float(found["asks"]),
        }
        _tightened(found, number, out)
    if "speed" in found:
        (scale,) = re.findall(rf"({_NUMBER}) s times the speed left to the limit", found["margin"])
        out |= {"speed": float(found["speed"]), "scale": float(scale)}
        terms.append(f"{scale} s times the speed left to the limit")
    if "stop" in found:
        assert who == "one", lines
        assert (said, "hold" in found) == ("GO", True), lines
        out |= {"stop": float(found["stop"]), "after": float(found["after"])}
    if "point" in found:
        assert (who, said, d, "hold" in found, "level" in found) == ("one", "GO", 2, True, True), lines
        assert ("speed" in found) is ("speed" in found["within"]), lines
        out["held"] = Feedback(
            _vector(found, "point", 2),
            *(tuple(map(tuple, json.loads(f"[{found[key]}]"))) for key in ("gain", "cost")),
            *(float(found[key]) for key in ("level", "kept")),
        )
    if "hold" in found:
        assert "first" in found, lines
        out |= {
            "hold": _vector(found, "hold", d),
            "radius": float(found["radius"]),
            "rest": float(found["rest"]),
        }
        terms.append("at the end the distance to the edge of the hold ball")
        terms.append(f"{found['radius']} / {found['rest']} s times the speed left to rest")
    assert found["margin"] == (terms[0] if len(terms) == 1 else f"the least of {', '.join(terms)}"), found[
        "margin"
    ]
    return Printed(
        verdict=verdict,
        margin=margin,
        who=who,
        d=d,
        ends=(int(found[first]), int(found[last])),
        dt=number["dt"],
        plane=number["plane"],
        sides=tuple((number[f"c_{axis}"], number[f"{axis}0"]) for axis in "xz"[: d - 1]),
        rates=_range(found["rate"]),
        motions=_range(found["motion"]),
        thrusts=_range(found["thrust"]),
        start=start,
        half=half,
        keep_out=float(found.get("keep_out", 0.0)),
        lines=lines,
        **out,
    )


def _tightened(found: dict[str, str], number: dict[str, float], out: dict[str, Any]) -> None:
    """The rounded corridor is the real one tightened by the tube."""
    radius = out["radius_m"]
    wanted = {
        "tight": number["plane"] + radius,
        "tight_x": number["x0"] - radius * math.hypot(1.0, number["c_x"]),
        "left": float(found["thrust"]) - out["feedback"],
    }
    if "z0" in number:
        wanted["tight_z"] = number["z0"] - number["c_z"] * radius - out["height_m"]
    for key, value in wanted.items():
        assert math.isclose(float(found[key]), value, rel_tol=1e-5, abs_tol=1e-5), (key, found[key], value)


def _vector(found: dict[str, str], key: str, d: int) -> tuple[float, ...]:
    values = tuple(float(e) for e in json.loads(found[key]))
    assert len(values) == d, found[key]
    return values


def _range(text: str) -> Range:
    low, _, high = text.partition(" to ")
    return float(low), float(high or low)
