"""Read the printed statement of a missed-burn proof back from its lines alone."""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass, field
from typing import Any

import numpy as np

_N = r"-?[0-9.]+(?:e[-+]?[0-9]+)?"
_V = rf"\[{_N}(?:, {_N})*\]"
_M = rf"\[{_V}(?:, {_V})*\]"
_ANGLE = rf"({_N}) rad \({_N} deg\)"


@dataclass(frozen=True, slots=True)
class Burn:
    time: float
    impulse: Any
    lasts: float


@dataclass(frozen=True, slots=True)
class Printed:
    """The claim; zones are (kind, centre (3,), columns (3, 3)), ``n`` and ``radius`` None about the Earth."""

    least: float
    keep_out: float
    zones: list[tuple[str, Any, Any]]
    n: float | None
    radius: float | None
    earth: dict[str, Any] | None
    horizon: float
    partial: bool
    late: float
    stuck: float
    acceleration: float
    misdirected: float
    early: bool
    box: Any
    anew: bool
    ellipsoid: Any
    share: float
    angle: float
    start: Any
    before: list[Any]
    burns: list[Burn] = field(default_factory=list)


def _taken(pattern: str, line: str) -> tuple[str, ...]:
    found = re.fullmatch(pattern, line)
    assert found, line
    return found.groups()


def printed(lines: tuple[str, ...]) -> Printed:
    """What the lines claim; fails on a line that it cannot read."""
    left = list(lines)
    keep, zones, least = _taken(
        rf"at all times the chaser stays ({_N}) m away from (.*), and more: ({_N}) m", left.pop(0)
    )
    model = left.pop(0)
    n = radius = None
    earth: dict[str, Any] | None = None
    if model.startswith("model: earth"):
        j2, mu, size, place, velocity = _taken(
            rf"model: earth, both bodies about the Earth with J2 = ({_N}) \(mu ({_N}) m\^3/s\^2, radius ({_N}) m\); "
            rf"the target at ({_V}) m, ({_V}) m/s, inertial, at the first burn; no drag, no other force",
            model,
        )
        state = np.array(ast.literal_eval(place) + ast.literal_eval(velocity))
        earth = {"j2": float(j2), "mu": float(mu), "size": float(size), "state": state}
    elif model.startswith("model: linear"):
        n = float(
            _taken(rf"model: linear \(CWH\) about a circular orbit, mean motion ({_N}) rad/s", model)[0]
        )
    else:
        radius, n = map(
            float,
            _taken(
                rf"model: nonlinear, two point masses, circular orbit of ({_N}) m, mean motion ({_N}) rad/s; the "
                r"plan's states before its burns are those of CWH motion from the start",
                model,
            ),
        )
    (horizon,) = _taken(rf"horizon: ({_N}) s after the end of the last burn that is made", left.pop(0))
    found: dict[str, Any] = _failures(left.pop(0))
    place, velocity, held = _taken(
        rf"states: within ({_V}) m and ({_V}) m/s of the plan (before every burn|before the first burn; the errors of "
        r"the burns add up)",
        left.pop(0),
    )
    ellipsoid = None
    if left[0].startswith("and off"):
        (columns,) = _taken(rf"and off by L b, \|b\| <= 1, columns of L: ({_M})", left.pop(0))
        ellipsoid = np.array(ast.literal_eval(columns), dtype=np.float64).T
    share, angle = _taken(
        rf"burns: size within a share of ({_N}) \({_N} %\), direction within {_ANGLE}", left.pop(0)
    )
    start, before = None, []
    if earth is None:
        (text,) = _taken(rf"start in LVLH: ({_V}) m, m/s", left.pop(0))
        start = np.array(ast.literal_eval(text), dtype=np.float64)
    while left[0].startswith("before burn"):
        k, text = _taken(rf"before burn (\d+) in LVLH: ({_V}) m, m/s", left.pop(0))
        assert int(k) == len(before)
        before.append(np.array(ast.literal_eval(text), dtype=np.float64))
    burns = []
    for line in left:
        k, time, impulse, lasts = _taken(
            rf"burn (\d+) at ({_N}) s: ({_V}) m/s(?:, evenly over ({_N}) s, its errors at any time of it)?",
            line,
        )
        assert int(k) == len(burns)
        burns.append(
            Burn(float(time), np.array(ast.literal_eval(impulse), dtype=np.float64), float(lasts or 0.0))
        )
    assert (earth is None) is not (len(before) == len(burns))
    return Printed(
        least=float(least),
        keep_out=float(keep),
        zones=_zones(zones),
        n=n,
        radius=radius,
        earth=earth,
        horizon=float(horizon),
        box=np.array(ast.literal_eval(place) + ast.literal_eval(velocity), dtype=np.float64),
        anew=held == "before every burn",
        ellipsoid=ellipsoid,
        share=float(share),
        angle=float(angle),
        start=start,
        before=before,
        burns=burns,
        **found,
    )


def _failures(line: str) -> dict[str, Any]:
    out: dict[str, Any] = {
        "partial": False,
        "early": False,
        **dict.fromkeys(("late", "stuck", "acceleration", "misdirected"), 0.0),
    }
    (said,) = _taken(r"any burn is (.*); no burn follows a failure", line)
    first, *rest = said.split("; or ")
    assert first == "missed, as all after it", line
    for one in rest:
        if one == "burnt in part, 0 to 100 %":
            out["partial"] = True
        elif one == "ended early, at any time, where it has a duration":
            out["early"] = True
        elif one.startswith("late"):
            out["late"] = float(_taken(rf"late by up to ({_N}) s", one)[0])
        elif one.startswith("stuck"):
            groups = _taken(rf"stuck on for up to ({_N}) s at ({_N}) m/s\^2(?: or its own thrust)?", one)
            out["stuck"], out["acceleration"] = map(float, groups)
        else:
            out["misdirected"] = float(_taken(rf"misdirected by up to {_ANGLE}", one)[0])
    return out


def _zones(text: str) -> list[tuple[str, Any, Any]]:
    out = []
    for one in text.split(" and from "):
        if one == "the target":
            out.append(("sphere", np.zeros(3), np.zeros((3, 3))))
        elif one.startswith("the sphere"):
            radius, centre = _taken(rf"the sphere of ({_N}) m about ({_V}) m, LVLH", one)
            out.append(("sphere", np.array(ast.literal_eval(centre)), float(radius) * np.eye(3)))
        else:
            kind, centre, what, axes = _taken(
                rf"the (ellipsoid|box) of ({_V}) m and (\[-1, 1\] times each|the unit ball times the columns) of "
                rf"({_M}) m, LVLH",
                one,
            )
            assert (kind == "box") is what.startswith("[-1"), one
            out.append((kind, np.array(ast.literal_eval(centre)), np.array(ast.literal_eval(axes)).T))
    return out
