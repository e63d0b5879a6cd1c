"""The files of the field of a flight, from its document."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from safestart.attitude.spin import Spin
from safestart.interchange.flights import FlightCourses, courses_of


def kept_courses(inputs: dict[str, Any], outputs: dict[str, Any]) -> FlightCourses | None:
    """:func:`courses` of a stored result; None for one from before flights had velocities."""
    return courses(inputs, outputs) if "lvlh_m_s" in outputs else None


def courses(inputs: dict[str, Any], outputs: dict[str, Any]) -> FlightCourses:
    """The courses of both craft; raises ``InvalidInput`` for a flight without a mean motion."""
    times = np.array(outputs["time_s"])
    states = np.zeros((len(times), 6))
    d = len(outputs["lvlh_m"][0])
    states[:, :d], states[:, 3 : 3 + d] = outputs["lvlh_m"], outputs["lvlh_m_s"]
    thrust = np.zeros((len(times) - 1, 3))
    thrust[:, :d] = outputs["thrust_m_s2"][:-1]
    spin = Spin(math.radians(inputs["omega_t_deg_s"]))
    return courses_of(times, states, thrust, inputs["mean_motion_rad_s"], spin)
