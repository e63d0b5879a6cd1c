"""Read the printed statement of a proof in space back from its lines alone."""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass, field
from typing import Any

import numpy as np

Vector = tuple[float, ...]
_N = r"-?[0-9.]+(?:e[-+]?[0-9]+)?"
_V = rf"\[{_N}(?:, {_N})*\]"
_BRACKET = r" \([^()]*\)"
_FRAME = r"(?:LVLH|the body frame)"
_NAME = r"'(?:[^'\\]|\\.)*'|\"(?:[^\"\\]|\\.)*\""
_WHO = {
    "a thrust history, held over the steps, keeps": ("GO", False),
    "no thrust history that is held over the steps keeps more than": ("NO_GO", False),
    "one thrust history, held over the steps, keeps, from every start of the box,": ("GO", True),
    "from no start of the box a thrust history that is held over the steps keeps more than": ("NO_GO", True),
}
_LINES = {
    "who": r"(?P<found>.+?) the margin, the least of (?P<terms>.*)",
    "stay": rf"stay: inside all faces at all times for (?P<steps>\d+) steps of (?P<dt>{_N}) s{_BRACKET}",
    "synchronize": r"synchronize: inside all faces at all times until the end, which is any of the steps "
    rf"(?P<first>\d+) to (?P<steps>\d+) of (?P<dt>{_N}) s{_BRACKET}",
    "end": rf"at the end: within (?P<radius>{_N}) m of (?P<hold>{_V}) m in the body frame, at most (?P<rest>{_N}) "
    r"m/s against the turning body",
    "speed": rf"speed: at most (?P<most>{_N}) m/s in LVLH at all times",
    "held": r"thrust held in LVLH axes over each step, motion in space",
    "face": rf"face (?P<name>{_NAME}): (?P<normal>{_V}) \. p <= (?P<offset>{_N}) m for p in (?P<frame>{_FRAME})",
    "view": rf"field_of_view: (?P<point>{_V}) m is seen within (?P<angle>{_N}) rad{_BRACKET} of the direction "
    rf"(?P<axis>{_V}), both in (?P<frame>{_FRAME})",
    "sphere": rf"keep-out (?P<name>{_NAME}): outside the sphere of (?P<radius>{_N}) m about (?P<centre>{_V}) m in "
    rf"(?P<frame>{_FRAME})",
    "box": rf"keep-out (?P<name>{_NAME}): outside the box of half-widths (?P<half>{_V}) m about (?P<centre>{_V}) m "
    rf"along (?P<frame>{_FRAME})",
    "plume": rf"plume: within (?P<reach>{_N}) m of (?P<point>{_V}) m in (?P<frame>{_FRAME}) no exhaust \(opposite to "
    rf"the thrust\) within (?P<angle>{_N}) rad{_BRACKET} of the direction to that point",
    "violated": rf"the start itself does not keep (?P<name>{_NAME})",
    "spin": r"attitude: a steady spin against (?P<seen>inertial axes, those of LVLH at t = 0|LVLH), about "
    rf"(?P<axis>{_V}) at (?P<rate>{_N}) rad/s{_BRACKET}, ahead by (?P<phase>{_N}) rad at t = 0",
    "free": rf"attitude: torque-free, inertia \[(?P<rows>{_V}(?:; {_V})*)\] kg m\^2, from LVLH at t = 0 by the "
    rf"quaternion \(scalar first\) (?P<q>{_V})",
    "turning": rf"body rate against inertial axes at t = 0: (?P<w>{_V}) rad/s",
    "table": r"attitude: against (?P<seen>inertial axes, those of LVLH at t = 0|LVLH), by slerp between these "
    r"quaternions \(scalar first\), as far as they are needed",
    "entry": rf"attitude at (?P<time>{_N}) s: (?P<q>{_V})",
    "orbit": rf"orbit: mean motion (?P<n>{_N}) rad/s, eccentricity (?P<e>{_N}), true anomaly (?P<nu>{_N}) "
    rf"rad{_BRACKET} at t = 0",
    "ball": rf"thrust: at most (?P<bound>{_N}) m/s\^2 in any direction(?P<still>, no disturbance)?",
    "cube": rf"thrust: at most (?P<bounds>{_V}) m/s\^2 along the axes of (?P<frame>LVLH|the body frame at the step's "
    r"begin)(?P<still>, no disturbance)?",
    "thrusters": r"thrust: shares, together at most 1, of thrusters in (?P<frame>LVLH|the body frame at the step's "
    rf"begin), m/s\^2: (?P<arms>{_N} along {_V}(?:; {_N} along {_V})*)(?P<still>; no disturbance)?",
    "stated": r"the member that is as stated: what is not known counts for no NO_GO",
    "members": r"for every member: the same thrust history keeps the margin whatever is not known",
    "u_angle": rf"not known: the attitude at t = 0, within (?P<angle>{_N}) rad{_BRACKET}",
    "u_rate": rf"not known: the angular velocity (?:at t = 0|at all times), within (?P<rate>{_N}) rad/s{_BRACKET} in "
    r"body axes",
    "u_inertia": rf"not known: the moments about the body's axes, each within a share of (?P<share>{_N})",
    "u_push": rf"not known: an acceleration of the chaser, any up to (?P<push>{_N}) m/s\^2",
    "position": rf"start, position in LVLH: (?P<at>{_V})(?: \+- (?P<wide>{_V}))? m",
    "velocity": rf"start, velocity in LVLH: (?P<at>{_V})(?: \+- (?P<wide>{_V}))? m/s",
}
_MANY = ("face", "sphere", "box", "entry")


@dataclass(frozen=True, slots=True)
class SpacePrinted:
    """A claim; ``said`` holds the groups of each kind of line, those of ``_MANY`` as lists."""

    verdict: str
    margin: float
    box: bool
    steps: int
    first: int
    dt: float
    said: dict[str, Any]
    start: Any
    half: Any
    lines: tuple[str, ...] = field(default=(), compare=False)


def vector(text: str) -> Any:
    return np.array(ast.literal_eval(text), dtype=np.float64)


def printed(verdict: str, margin: float, lines: tuple[str, ...]) -> SpacePrinted:
    """What the lines claim; fails on a line that it cannot read, and on one that contradicts another."""
    said: dict[str, Any] = {kind: [] for kind in _MANY}
    for line in lines:
        found = [(kind, m.groupdict()) for kind, p in _LINES.items() if (m := re.fullmatch(p, line))]
        assert len(found) == 1, line
        kind, groups = found[0]
        if kind in _MANY:
            said[kind].append(groups)
        else:
            assert kind not in said, line
            said[kind] = groups
    word, box = _WHO[said["who"]["found"]]
    assert word == verdict, lines
    asked = said.get("synchronize") or said["stay"]
    assert ("synchronize" in said) is ("end" in said) is not ("stay" in said), lines
    assert sum(kind in said for kind in ("spin", "free", "table")) == 1, lines
    assert ("free" in said) is ("turning" in said), lines
    assert ("table" in said) is bool(said["entry"]), lines
    assert sum(kind in said for kind in ("ball", "cube", "thrusters")) == 1, lines
    assert {"held", "orbit", "position", "velocity"} <= set(said), lines
    wide = [
        vector(said[key]["wide"]) if said[key]["wide"] else np.zeros(3) for key in ("position", "velocity")
    ]
    assert box is bool(np.any(wide)), lines
    assert "violated" not in said or verdict == "NO_GO", lines
    unknown = any(key in said for key in ("u_angle", "u_rate", "u_inertia", "u_push"))
    assert not unknown or ("members" if verdict == "GO" else "stated") in said, lines
    _terms(said)
    return SpacePrinted(
        verdict=verdict,
        margin=margin,
        box=box,
        steps=int(asked["steps"]),
        first=int(asked.get("first", asked["steps"])),
        dt=float(asked["dt"]),
        said=said,
        start=np.concatenate([vector(said[key]["at"]) for key in ("position", "velocity")]),
        half=np.concatenate(wide),
        lines=lines,
    )


def _terms(said: dict[str, Any]) -> None:
    """What the margin is made of is what is asked for."""
    wanted = ["the distance to the nearest face"]
    if "speed" in said:
        (scale,) = re.findall(rf"({_N}) s times the speed left to the limit", said["who"]["terms"])
        said["speed"]["scale"] = scale
        wanted.append(f"{scale} s times the speed left to the limit")
    if "end" in said:
        wanted.append("at the end the distance to the edge of the hold ball")
        wanted.append(f"{said['end']['radius']} / {said['end']['rest']} s times the speed left to rest")
    named = [ast.literal_eval(one["name"]) for one in [*said["sphere"], *said["box"]]]
    terms = said["who"]["terms"]
    assert terms.startswith(", ".join(wanted)), terms
    rest = terms[len(", ".join(wanted)) :]
    regions = re.findall(rf", distance to ({_NAME})", rest)
    assert "".join(f", distance to {one}" for one in regions) == rest, terms
    # Of boxes and spheres in turn, then the view.
    also = ["field_of_view"] if "view" in said else []
    assert sorted(ast.literal_eval(one) for one in regions) == sorted(named + also), terms
