"""The flight of tracking-mpc as files: of the field (OEM, AEM, OPM, OCM, CZML), and what the page animates."""

from __future__ import annotations

import numpy as np

from safestart.interchange.flights import courses_of
from safestart.model.scenario import Floats
from safestart.processes.base import Artifact
from safestart.processes.course_files import course_files
from safestart.processes.plotting import npz
from safestart.processes.tracking_mpc.setup import Setup
from safestart.tracking.flight import TrackedFlight


def flight_files(setup: Setup, flight: TrackedFlight) -> tuple[Artifact, ...]:
    """The courses of both craft; states with impulses are those after the impulse of their time."""
    motion = setup.motion
    times = motion.period * np.arange(float(len(flight.states)))
    given = np.einsum("kji,kj->ki", setup.attitudes[: len(flight.inputs)], flight.inputs)
    still, attitude = np.zeros_like(given), setup.tumble.attitude
    if motion.held:
        courses = courses_of(times, flight.states, given / motion.period, motion.mean_motion, attitude)
    else:
        jumps = np.concatenate([np.zeros((1, 3)), given])
        courses = courses_of(times, flight.states, still, motion.mean_motion, attitude, jumps)
    return course_files(courses)


def scene(setup: Setup, flight: TrackedFlight) -> Artifact:
    """``scene.npz`` for the view of the same kind: the flight and the corridor's outline in the turning body."""
    count = len(flight.states)
    return npz(
        "scene.npz",
        {
            "time_s": setup.motion.period * np.arange(float(count)),
            "position_lvlh_m": flight.states[:, :3],
            "attitude": setup.attitudes[:count],
            "outline_m": _outline(setup, 1.1 * float(flight.body[:, 1].max()) + 0.2),
            "reference_m": np.array([plan.theta for plan in flight.plans]),
        },
    )


def _outline(setup: Setup, height: float) -> Floats:
    """(12, 2, 3): edges of the corridor cut at ``height`` m, body axes."""
    shape, rings = setup.shape, []
    for y in (shape.y0, height):
        x, z = shape.x0 + (y - shape.y0) / shape.c_x, shape.z0 + (y - shape.y0) / shape.c_z
        rings.append([(-x, y, -z), (x, y, -z), (x, y, z), (-x, y, z)])
    near, far = rings
    edges = [(ring[i], ring[(i + 1) % 4]) for ring in rings for i in range(4)]
    return np.array(edges + list(zip(near, far, strict=True)))
