"""The question of a request and its starts, in SI units; errors use the wire names."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np

from safestart.attitude.in_lvlh import InLvlh, torque_free
from safestart.attitude.spin import Spin
from safestart.attitude.table import Table
from safestart.attitude.turning import SmoothAttitude
from safestart.constraints.thrust_limit import ThrustLimit, ball
from safestart.errors import InvalidInput, invalid
from safestart.exact.question import Goal
from safestart.exact.space.question import Face, SpaceQuestion, five_faces, starts_in_lvlh
from safestart.exact.space.unknowns import Unknowns
from safestart.model.orbit import KeplerOrbit
from safestart.model.scenario import Floats
from safestart.processes.start_in_space.demand_parts import demands_of
from safestart.processes.start_in_space.parts import (
    BallThrust,
    BoxThrust,
    EllipticOrbit,
    Faces,
    SpaceStart,
    SpinAttitude,
    TorqueFreeAttitude,
)
from safestart.processes.start_in_space.space_scenario import SpaceScenario
from safestart.processes.start_in_space.spec import SpaceInputs
from safestart.processes.wire import DT_S

_ATTITUDE = {
    "inertia": "inertia_kg_m2",
    "attitude": "attitude_wxyz",
    "body_rate": "body_rate_deg_s",
    "axis": "axis",
    "rate": "rate_deg_s",
    "phase": "phase_deg",
    "times": "times_s",
}
_ORBIT = {
    "eccentricity": "eccentricity",
    "semi_major_axis": "semi_major_axis_m",
    "mean_motion": "mean_motion_rad_s",
}
_THRUST = {"directions": "directions", "a_max": "a_max_m_s2"}


def question_of(inputs: SpaceInputs) -> SpaceQuestion:
    """The question; raises ``InvalidInput`` for objects beside the short form, and for invalid parts."""
    orbit, attitude, thrust = _parts(inputs)
    goal, span = None, inputs.horizon_s
    if inputs.question == "synchronize":
        goal, span = Goal(inputs.ball_radius_m, inputs.rest_speed_m_s, _hold(inputs)), inputs.within_s
    demands = demands_of(inputs.keep_outs, inputs.field_of_view, inputs.plume)
    with _as_asked():
        return SpaceQuestion(
            orbit,
            attitude,
            _faces(inputs),
            thrust,
            DT_S,
            round(span / DT_S),
            goal,
            inputs.speed_limit_m_s,
            demands,
            unknowns_of(inputs),
        )


def unknowns_of(inputs: SpaceInputs) -> Unknowns:
    """What is not known beside the start, in SI units."""
    return Unknowns(
        math.radians(inputs.attitude_half_angle_deg),
        math.radians(inputs.body_rate_half_width_deg_s),
        inputs.inertia_half_width,
        inputs.disturbance_m_s2,
    )


def stay_in(scenario: SpaceScenario, horizon_s: float) -> SpaceQuestion:
    """`stay` in a scenario for some seconds; raises ``InvalidInput`` like :func:`question_of`."""
    orbit, attitude, thrust = _parts(scenario)
    with _as_asked():
        return SpaceQuestion(orbit, attitude, _faces(scenario), thrust, DT_S, round(horizon_s / DT_S))


def require_stay(inputs: Any) -> None:
    """Raise as :func:`stay_in` does for the scenario of a process that has a horizon, ``horizon_s``."""
    stay_in(inputs, inputs.horizon_s)


def _parts(inputs: SpaceScenario) -> tuple[KeplerOrbit, SmoothAttitude, ThrustLimit]:
    """Orbit, attitude and thrust; raises ``InvalidInput`` for objects beside the short form, and for invalid parts."""
    for name, short in (
        ("attitude", "omega_t_deg_s"),
        ("orbit", "mean_motion_rad_s"),
        ("thrust", "a_max_m_s2"),
    ):
        both = getattr(inputs, name) is not None and getattr(inputs, short) is not None
        neither = getattr(inputs, name) is None and getattr(inputs, short) is None and name != "orbit"
        if both or neither:
            raise invalid(name, f"either {name} or {short}", "both" if both else "neither")
    if inputs.phase_deg is not None and inputs.omega_t_deg_s is None:
        raise invalid("phase_deg", "omega_t_deg_s beside it; an attitude holds its own", inputs.phase_deg)
    with _named("orbit", _ORBIT):
        orbit = _orbit(inputs)
    with _named("attitude", _ATTITUDE):
        attitude = _attitude(inputs, orbit)
    with _named("thrust", _THRUST):
        thrust = _thrust(inputs)
    return orbit, attitude, thrust


@contextmanager
def _as_asked() -> Iterator[None]:
    """Report what is wrong with a question under its wire names."""
    try:
        yield
    except InvalidInput as error:
        places = {"hold": "hold_m", "inertia": "inertia_half_width", "times": "attitude.times_s"}
        field = str(error.field)
        place = places.get(field, field)
        if field.partition(".")[0] == "faces":
            place = f"corridor.{field.removesuffix('.offset')}" + ".offset_m" * field.endswith(".offset")
        raise invalid(place, str(error.required), error.received) from None


def states_of(inputs: SpaceInputs, question: SpaceQuestion) -> Floats:
    """The starts (S, 6), LVLH, m and m/s."""
    return states_in(question, inputs.starts)


def states_in(question: SpaceQuestion, starts: Sequence[SpaceStart]) -> Floats:
    """Starts (S, 6), LVLH, m and m/s."""
    positions = np.array([start.position_m for start in starts])
    velocities = np.array([start.velocity_m_s for start in starts])
    body = np.array([start.frame == "body" for start in starts])
    states: Floats = np.concatenate([positions, velocities], axis=1)
    if body.any():
        states[body] = starts_in_lvlh(question.attitude, positions[body], velocities[body])
    return states


@contextmanager
def _named(part: str, names: Mapping[str, str]) -> Iterator[None]:
    """Report a part's errors under its wire names."""
    try:
        yield
    except InvalidInput as error:
        field = str(error.field)
        raise invalid(f"{part}.{names.get(field, field)}", str(error.required), error.received) from None


def _orbit(inputs: SpaceScenario) -> KeplerOrbit:
    said = inputs.orbit
    if isinstance(said, EllipticOrbit):
        return KeplerOrbit.of(said.semi_major_axis_m, said.eccentricity, math.radians(said.true_anomaly_deg))
    if said is not None:
        return KeplerOrbit(said.mean_motion_rad_s)
    return KeplerOrbit(1.1e-3 if inputs.mean_motion_rad_s is None else inputs.mean_motion_rad_s)


def _attitude(inputs: SpaceScenario, orbit: KeplerOrbit) -> SmoothAttitude:
    said = inputs.attitude
    if said is None:
        phase = math.radians(inputs.phase_deg or 0.0)
        return Spin(math.radians(inputs.omega_t_deg_s or 0.0), phase=phase)
    made: SmoothAttitude
    if isinstance(said, SpinAttitude):
        made = Spin(math.radians(said.rate_deg_s), _three(said.axis), math.radians(said.phase_deg))
        return InLvlh(made, orbit) if said.axis_frame == "inertial" else made
    if isinstance(said, TorqueFreeAttitude):
        rows = said.inertia_kg_m2
        return torque_free(
            (_three(rows[0]), _three(rows[1]), _three(rows[2])),
            _four(said.attitude_wxyz),
            _three([math.radians(e) for e in said.body_rate_deg_s]),
            said.reference,
            orbit,
        )
    made = Table(tuple(said.times_s), tuple(_four(entry) for entry in said.attitude_wxyz))
    return InLvlh(made, orbit) if said.reference == "inertial" else made


def _faces(inputs: SpaceScenario) -> tuple[Face, ...]:
    said = inputs.corridor
    if isinstance(said, Faces):
        return tuple(Face(e.name, _three(e.normal), e.offset_m, e.frame) for e in said.faces)
    with _named("corridor", {}):
        return five_faces(said.shape(), _three(said.axis))


def _hold(inputs: SpaceInputs) -> tuple[float, float, float] | None:
    if inputs.hold_m is not None:
        return _three(inputs.hold_m)
    if isinstance(inputs.corridor, Faces):
        raise invalid("hold_m", "the hold point where the corridor is given by faces", None)
    plane = _faces(inputs)[0]
    length, away = math.hypot(*inputs.corridor.axis), inputs.corridor.r_h_m
    hold = _three([away * e / length for e in inputs.corridor.axis])
    if float(np.dot(plane.normal, hold)) > plane.offset:
        # Rounding of the turned normal put it outside: a hair further.
        hold = _three([(1.0 + 1e-12) * e for e in hold])
    return hold


def half_of(inputs: SpaceInputs) -> Floats | None:
    """Half-widths (6,) of the box of starts, m and m/s; None where the starts are known."""
    half = np.repeat([inputs.position_half_width_m, inputs.velocity_half_width_m_s], 3)
    return half if half.any() else None


def _thrust(inputs: SpaceScenario) -> ThrustLimit:
    said = inputs.thrust
    if said is None:
        return ball(inputs.a_max_m_s2 or 0.0)
    if isinstance(said, BallThrust):
        return ball(said.a_max_m_s2)
    if isinstance(said, BoxThrust):
        return ThrustLimit("box", tuple(said.a_max_m_s2), frame=said.frame)
    directions = tuple(_three(direction) for direction in said.directions)
    return ThrustLimit("thrusters", tuple(said.a_max_m_s2), directions, said.frame)


def _three(values: Sequence[float]) -> tuple[float, float, float]:
    x, y, z = (float(e) for e in values)
    return x, y, z


def _four(values: Sequence[float]) -> tuple[float, float, float, float]:
    s, x, y, z = (float(e) for e in values)
    return s, x, y, z
