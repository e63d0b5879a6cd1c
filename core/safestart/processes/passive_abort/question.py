"""The question of passive-abort in SI, but for the target's course; light to import.

What no model can have is refused here, before a job waits for it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from safestart.attitude.quaternion import matrix_of, unit_quaternion
from safestart.errors import InvalidInput, Unavailable, invalid, named
from safestart.hopping.approach import mean_motion_of
from safestart.interchange.read import ephemeris_from, manoeuvres_from
from safestart.missed_burn.plan import Burn, Errors, Failures, Plan, Question
from safestart.missed_burn.plan_text import burns_in_csv, courses_of, is_message
from safestart.missed_burn.zone import POINT, Zone
from safestart.processes.passive_abort.spec import SPEC, PassiveAbortInputs
from safestart.processes.passive_abort.wire import ErrorsInput, FailuresInput, ZoneInput, radians

_LONGEST_S = 1e6


def require_possible(inputs: PassiveAbortInputs) -> None:
    """Raise ``InvalidInput`` for zones that are none, covariances that are none, plans that cannot be flown, files that
    say no plan."""
    if inputs.plan is not None and is_message(inputs.plan):
        if inputs.target is None:
            raise invalid("target", "the target's OEM, OPM or OCM beside a plan from a message", "none")
        _shared(inputs)
        _readable(inputs.plan.encode(), inputs.target.encode())
        return
    plain_question(with_burns(inputs))


def _readable(plan: bytes, target: bytes) -> None:
    """Raise ``InvalidInput`` for messages that say no plan; where the packages that read files are missing, the worker
    looks."""
    try:
        named("plan", manoeuvres_from, plan), named("target", ephemeris_from, target)
        named("plan", courses_of, plan, target)
    except Unavailable:
        return


def with_burns(inputs: PassiveAbortInputs) -> PassiveAbortInputs:
    """The inputs with the burns of a plan in CSV in their place."""
    if inputs.plan is None:
        return inputs
    if inputs.target is not None:
        raise invalid("target", "none beside a plan in CSV, which is in LVLH", "a file")
    return with_plan(inputs, named("plan", burns_in_csv, inputs.plan).burns, {})


def with_plan(inputs: PassiveAbortInputs, burns: Sequence[Burn], more: dict[str, Any]) -> PassiveAbortInputs:
    """The inputs with burns, and ``more`` fields, in the place of a file; raises ``InvalidInput``."""
    whole = inputs.model_dump(mode="json", exclude_unset=True, exclude={"plan", "target"})
    whole["burns"] = [
        {"time_s": burn.time, "impulse_m_s": list(burn.impulse), "duration_s": burn.duration}
        for burn in burns
    ]
    asked = SPEC.parse(whole | more)
    assert isinstance(asked, PassiveAbortInputs)
    return asked


def plain_question(inputs: PassiveAbortInputs) -> Question:
    """The question without the target's course about the Earth; raises ``InvalidInput``."""
    assert inputs.start is not None
    assert inputs.burns is not None
    horizon, errors, failures, zones = _shared(inputs)
    burns = tuple(
        Burn(b.time_s, (b.impulse_m_s[0], b.impulse_m_s[1], b.impulse_m_s[2]), b.duration_s)
        for b in inputs.burns
    )
    n = mean_motion_of(inputs.semi_major_axis_m)
    plan = Plan(n, (*inputs.start.position_m, *inputs.start.velocity_m_s), burns)
    radius = inputs.semi_major_axis_m if inputs.model == "nonlinear" else None
    return Question(plan, inputs.keep_out_m, horizon, errors, failures, radius, None, zones)


def _shared(inputs: PassiveAbortInputs) -> tuple[float, Errors, Failures, tuple[Zone, ...]]:
    """Horizon (s), errors, failures and zones."""
    horizon = inputs.abort_orbits * math.tau / mean_motion_of(inputs.semi_major_axis_m)
    if horizon > _LONGEST_S:
        raise invalid("abort_orbits", f"a drift of at most {_LONGEST_S:g} s", f"{horizon:.6g} s")
    return horizon, errors_of(inputs.errors), failures_of(inputs.failures), zones_of(inputs.zones)


def zones_of(zones: list[ZoneInput] | None) -> tuple[Zone, ...]:
    """Zones in SI; the target itself where none is given."""
    if zones is None:
        return (POINT,)
    out = []
    for k, zone in enumerate(zones):
        try:
            out.append(zone_of(zone))
        except InvalidInput as error:
            part = str(error.field).removeprefix("zones")
            raise invalid(f"zones.{k}{part}", str(error.required), error.received) from None
    return tuple(out)


def zone_of(zone: ZoneInput) -> Zone:
    """A zone in SI."""
    x, y, z = zone.centre_m
    if zone.kind == "sphere":
        if len(set(zone.half_m)) > 1 or zone.half_m[0] < 0.0:
            raise invalid("zones.half_m", "the radius three times, 0 or more, for a sphere", zone.half_m)
        return Zone.sphere(zone.half_m[0], (x, y, z))
    if min(zone.half_m) <= 0.0:
        raise invalid("zones.half_m", "three lengths above 0", zone.half_m)
    turned = matrix_of(np.array(unit_quaternion("zones.attitude_wxyz", zone.attitude_wxyz)))
    axes = np.array(zone.half_m)[:, None] * turned
    one, two, three = ((float(a), float(b), float(c)) for a, b, c in axes)
    return Zone(zone.kind, (x, y, z), (one, two, three))


def errors_of(errors: ErrorsInput) -> Errors:
    """The errors in SI."""
    at, fast = errors.position_m, errors.velocity_m_s
    angle = min(radians(errors.thrust_deg), 0.5 * math.pi)
    if errors.covariance is not None:
        still, columns = (0.0, 0.0, 0.0), ellipsoid_of(errors.covariance, errors.sigmas)
        return Errors(still, still, errors.thrust_share, angle, errors.at_each_burn, columns)
    return Errors((at, at, at), (fast, fast, fast), errors.thrust_share, angle, errors.at_each_burn)


def ellipsoid_of(covariance: list[list[float]], sigmas: float) -> tuple[tuple[float, ...], ...]:
    """Columns (6, 6) of L with L L' = sigmas^2 times the covariance.

    Raises ``InvalidInput`` unless it is a symmetric matrix of 6 x 6 that is positive semi-definite, up to 1e-9 of what
    its diagonal allows.
    """
    p = np.array(covariance, dtype=np.float64) if all(len(row) == 6 for row in covariance) else np.zeros(0)
    if p.shape != (6, 6) or not np.isfinite(p).all():
        raise invalid("errors.covariance", "6 rows of 6 finite numbers", covariance)
    # In units in which the diagonal is 1, as metres and metres per second have nothing in common.
    size = np.sqrt(np.maximum(np.diag(p), 0.0))
    scale = np.where(size > 0.0, size, 1.0)
    unit = p / np.outer(scale, scale)
    values, vectors = np.linalg.eigh(0.5 * (unit + unit.T))
    if np.abs(unit - unit.T).max() > 1e-9 or np.diag(p).min() < 0.0 or values.min() < -1e-9:
        raise invalid("errors.covariance", "a symmetric positive semi-definite matrix", covariance)
    columns = sigmas * scale[:, None] * vectors * np.sqrt(np.maximum(values, 0.0))
    return tuple(tuple(column) for column in columns.T.tolist())


def failures_of(failures: FailuresInput) -> Failures:
    """The failures in SI."""
    return Failures(
        failures.late_s,
        failures.partial,
        failures.stuck_s,
        failures.acceleration_m_s2,
        radians(failures.misdirected_deg),
    )
