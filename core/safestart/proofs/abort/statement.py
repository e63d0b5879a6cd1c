"""The statement of a missed-burn proof, read strictly: every number is a double, taken as an exact rational."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from flint import fmpq

from safestart.proofs.statement import check_seal
from safestart.proofs.strict import ProofRejected, exact, fields, number, part, shown, vector

SCHEMA, WIDER = "safestart-abort-proof/1", "safestart-abort-proof/2"
KINDS = ("start", "made", "cut", "partial", "misdirected", "late", "stuck")
_QUESTION = (
    *("model", "mean_motion_rad_s", "start", "burns", "keep_out_m", "horizon_s"),
    *("errors", "failures"),
)
_ERRORS = ("position_m", "velocity_m_s", "thrust_share", "thrust_rad", "at_each_burn")
_FAILURES = ("late_s", "partial", "stuck_s", "acceleration_m_s2", "misdirected_rad")
_CASE = ("kind", "burn", "first_s", "last_s", "cells")
_WIDER_CASE = (*_CASE, "on_first_s", "on_last_s", "zone")
_ZONE = ("kind", "centre_m", "axes_m")
_ZONES, _MOST_ZONES = ("sphere", "ellipsoid", "box"), 8
_MOST_BURNS, _MOST_CASES, _MOST_CELLS, _MOST_PARTS = 200, 40_000, 400_000, 1000
LONGEST_PHASE = fmpq(1, 2)
MODELS: dict[str, tuple[str, ...]] = {
    "linear": (),
    "nonlinear": ("semi_major_axis_m",),
    "earth": ("target", "before"),
}
_TARGET = ("position_m", "velocity_m_s", "mu_m3_s2", "j2", "earth_radius_m")


@dataclass(frozen=True, slots=True)
class Event:
    """One case of the document: its kind, burn (-1: none is made), piece of [0, tau], cells and trial radii; how long a
    burn with a duration lasts (0 and 0 otherwise), the number of the zone, and which share of the burn is in the flight
    near which the set is followed (model earth; any share is sound)."""

    kind: str
    burn: int
    first: fmpq
    last: fmpq
    cells: list[list[fmpq]]
    radii: list[fmpq]
    on: tuple[fmpq, fmpq] = (fmpq(0), fmpq(0))
    zone: int = 0
    share: fmpq | None = None

    @property
    def reference(self) -> fmpq:
        """The share that is named, or that of the kind."""
        if self.share is not None:
            return self.share
        return {"start": fmpq(0), "partial": fmpq(1, 2)}.get(self.kind, fmpq(1))


@dataclass(frozen=True, slots=True)
class Zone:
    """A body: its centre (3,), and blocks of columns (3,), m, whose images of unit balls are added to it."""

    kind: str
    centre: list[fmpq]
    blocks: list[list[list[fmpq]]]

    @property
    def axes(self) -> list[list[fmpq]]:
        """All columns."""
        return [axis for block in self.blocks for axis in block]

    @property
    def is_point(self) -> bool:
        """Whether it is the target itself."""
        return not any(self.centre) and not any(e for axis in self.axes for e in axis)


_POINT = Zone("sphere", [fmpq(0)] * 3, [])


@dataclass(frozen=True, slots=True)
class Target:
    """Inertial state (6,) of the target at the first burn, the Earth's constants, and LVLH states of the chaser before
    every burn."""

    state: list[fmpq]
    mu: fmpq
    j2: fmpq
    radius: fmpq
    before: list[list[fmpq]]


@dataclass(frozen=True, slots=True)
class Asked:
    """The statement in SI, all rational."""

    n: fmpq
    radius: fmpq | None
    earth: Target | None
    start: list[fmpq]
    times: list[fmpq]
    impulses: list[list[fmpq]]
    durations: list[fmpq]
    keep_out: fmpq
    zones: list[Zone]
    horizon: fmpq
    box: list[fmpq]
    ellipsoid: list[list[fmpq]]
    share: fmpq
    angle: fmpq
    anew: bool
    late: fmpq
    partial: bool
    stuck: fmpq
    acceleration: fmpq
    misdirected: fmpq
    least: fmpq
    events: list[Event]


def read(document: Any) -> Asked:
    """The statement of a document; raise ``ProofRejected`` when it is malformed or its digest is wrong."""
    wide = isinstance(document, dict) and document.get("schema") == WIDER
    check_seal(document, WIDER if wide else SCHEMA)
    fields(document, "document", ("schema", "digest", "verdict", "least_distance_m", "question", "cases"))
    if document["verdict"] != "PROVED":
        raise ProofRejected(f"verdict: required PROVED, received {shown(document['verdict'])}")
    question = part(document, "question", dict)
    model = part(question, "model", str)
    if model not in MODELS:
        raise ProofRejected(f"model: required {' or '.join(MODELS)}, received {shown(model)}")
    bent = model != "linear"
    fields(question, "question", (*_QUESTION, *MODELS[model], *(("zones",) if wide else ())))
    start = part(question, "start", dict)
    fields(start, "start", ("position_m", "velocity_m_s"))
    errors, failures = part(question, "errors", dict), part(question, "failures", dict)
    fields(errors, "errors", (*_ERRORS, "ellipsoid") if wide else _ERRORS)
    fields(failures, "failures", _FAILURES)
    n = number(question, "mean_motion_rad_s", 1e-9, 0.01)
    times, impulses, durations = _burns(part(question, "burns", list), wide)
    box = vector(errors["position_m"], "position_m", 3) + vector(errors["velocity_m_s"], "velocity_m_s", 3)
    if min(box) < 0:
        raise ProofRejected("errors: required half-widths >= 0")
    least, keep_out = number(document, "least_distance_m", 0.0), number(question, "keep_out_m", 1e-9)
    if least < keep_out:
        raise ProofRejected("least_distance_m: required at least keep_out_m")
    late, stuck = number(failures, "late_s", 0.0), number(failures, "stuck_s", 0.0)
    longest = max(late, stuck)
    if any(durations):
        longest = late + max(durations) + stuck
    acceleration = number(failures, "acceleration_m_s2", 0.0, 100.0)
    if acceleration > 0 and stuck == 0:
        raise ProofRejected("acceleration_m_s2: required 0 where no burn may be stuck on")
    if n * longest > LONGEST_PHASE:
        raise ProofRejected("late_s, duration_s, stuck_s: required at most half a radian of the orbit")
    zones = _zones(part(question, "zones", list)) if wide else [_POINT]
    anew = _flag(errors, "at_each_burn")
    if bent and not anew:
        raise ProofRejected("at_each_burn: required true for this model")
    vectors = vector(start["position_m"], "position_m", 3) + vector(start["velocity_m_s"], "velocity_m_s", 3)
    target = _target(question, len(times)) if model == "earth" else None
    if target is not None and vectors != target.before[0]:
        raise ProofRejected("start: required the state before the first burn")
    return Asked(
        n=n,
        radius=number(question, "semi_major_axis_m", 1e3, 1e9) if model == "nonlinear" else None,
        earth=target,
        start=vectors,
        times=times,
        impulses=impulses,
        durations=durations,
        keep_out=keep_out,
        zones=zones,
        horizon=number(question, "horizon_s", 1e-6),
        box=box,
        ellipsoid=_ellipsoid(errors["ellipsoid"]) if wide else [],
        share=number(errors, "thrust_share", 0.0, 0.99),
        angle=number(errors, "thrust_rad", 0.0, 1.5707963267948966),
        anew=anew,
        late=late,
        partial=_flag(failures, "partial"),
        stuck=stuck,
        acceleration=acceleration,
        misdirected=number(failures, "misdirected_rad", 0.0, 3.141592653589793),
        least=least,
        events=_events(part(document, "cases", list), len(times), bent, len(zones) if wide else 0),
    )


def _ellipsoid(columns: Any) -> list[list[fmpq]]:
    if not isinstance(columns, list) or len(columns) not in (0, 6):
        raise ProofRejected("errors.ellipsoid: required no columns, or 6")
    return [vector(column, "ellipsoid", 6) for column in columns]


def _zones(zones: list[Any]) -> list[Zone]:
    if not 1 <= len(zones) <= _MOST_ZONES:
        raise ProofRejected(f"zones: required 1 to {_MOST_ZONES}, received {len(zones)}")
    out = []
    for zone in zones:
        fields(zone, "zone", _ZONE)
        if zone["kind"] not in _ZONES or not isinstance(zone["axes_m"], list) or len(zone["axes_m"]) != 3:
            raise ProofRejected(f"zone: required a kind of {', '.join(_ZONES)} and three axes")
        axes = [vector(axis, "axes_m", 3) for axis in zone["axes_m"]]
        radius = axes[0][0]
        if zone["kind"] == "sphere" and axes != [[radius * (i == j) for j in range(3)] for i in range(3)]:
            raise ProofRejected("axes_m: required a sphere's radius along each axis of LVLH")
        if zone["kind"] == "sphere" and radius < 0:
            raise ProofRejected(f"axes_m: required a radius >= 0, received {shown(zone['axes_m'])}")
        blocks = [[axis] for axis in axes] if zone["kind"] == "box" else [axes]
        out.append(Zone(zone["kind"], vector(zone["centre_m"], "centre_m", 3), blocks))
    return out


def _target(question: Any, burns: int) -> Target:
    target, before = part(question, "target", dict), part(question, "before", list)
    fields(target, "target", _TARGET)
    for key in ("position_m", "velocity_m_s"):
        if len(part(target, key, list)) != 3:
            raise ProofRejected(f"target.{key}: required 3 numbers")
    if len(before) != burns:
        raise ProofRejected(f"before: required one state before each of {burns} burns")
    states = []
    for state in before:
        fields(state, "before", ("position_m", "velocity_m_s"))
        states.append(
            vector(state["position_m"], "position_m", 3) + vector(state["velocity_m_s"], "velocity_m_s", 3)
        )
    return Target(
        [exact(e, "target", -1e9, 1e9) for e in target["position_m"] + target["velocity_m_s"]],
        number(target, "mu_m3_s2", 1.0, 1e18),
        number(target, "j2", 0.0, 0.1),
        number(target, "earth_radius_m", 1.0, 1e9),
        states,
    )


def _flag(document: Any, key: str) -> bool:
    if not isinstance(document[key], bool):
        raise ProofRejected(f"{key}: required true or false, received {shown(document[key])}")
    return bool(document[key])


def _burns(burns: list[Any], wide: bool) -> tuple[list[fmpq], list[list[fmpq]], list[fmpq]]:
    if not 1 <= len(burns) <= _MOST_BURNS:
        raise ProofRejected(f"burns: required 1 to {_MOST_BURNS}, received {len(burns)}")
    times, impulses = [], []
    durations: list[fmpq] = []
    for burn in burns:
        fields(burn, "burn", ("time_s", "impulse_m_s", *(("duration_s",) if wide else ())))
        times.append(number(burn, "time_s", -1e7))
        impulses.append(vector(burn["impulse_m_s"], "impulse_m_s", 3))
        if not any(impulses[-1]):
            raise ProofRejected("impulse_m_s: required an impulse that is not zero")
        if len(times) > 1 and not (times[-1] > times[-2] and times[-1] >= times[-2] + durations[-1]):
            raise ProofRejected("time_s: required burns in order, each after the end of the one before")
        durations.append(number(burn, "duration_s", 0.0) if wide else fmpq(0))
    return times, impulses, durations


def _events(cases: list[Any], burns: int, bent: bool, zones: int) -> list[Event]:
    """The cases; ``zones``: how many there are in the wider schema, 0 in the other one."""
    names = _WIDER_CASE if zones else _CASE
    if len(cases) > _MOST_CASES:
        raise ProofRejected(f"cases: required at most {_MOST_CASES}, received {len(cases)}")
    out, total = [], 0
    for case in cases:
        near = ("reference",) if zones and bent else ()
        fields(case, "case", (*names, "radii_m") if bent else names, near)
        kind, burn, cells = part(case, "kind", str), part(case, "burn", int), part(case, "cells", list)
        if kind not in KINDS or not (burn == -1 if kind == "start" else 0 <= burn < burns):
            raise ProofRejected(
                f"case: required a kind and a burn of the plan, received {shown((kind, burn))}"
            )
        total += len(cells)
        if total > _MOST_CELLS:
            raise ProofRejected(f"cells: required at most {_MOST_CELLS}")
        first, last = number(case, "first_s", 0.0), number(case, "last_s", 0.0)
        radii = part(case, "radii_m", list) if bent else []
        on = (
            (number(case, "on_first_s", 0.0), number(case, "on_last_s", 0.0)) if zones else (fmpq(0), fmpq(0))
        )
        zone = part(case, "zone", int) if zones else 0
        if zones and not 0 <= zone < zones:
            raise ProofRejected(f"case: required a zone of the question, received {shown(zone)}")
        if bent and not 1 <= len(radii) <= _MOST_PARTS:
            raise ProofRejected(f"radii_m: required 1 to {_MOST_PARTS}")
        out.append(
            Event(
                kind,
                burn,
                first,
                last,
                [vector(cell, "cell", 5) for cell in cells],
                [exact(radius, "radii_m", 0.0, 1e9) for radius in radii],
                on,
                zone,
                number(case, "reference", 0.0, 1.0) if "reference" in case else None,
            )
        )
    return out
