"""A day of a commit timeline: a chaser that hovers some 40 m ahead of a slowly turning target, both files every 10 s.

``python -m benchmarks.timeline_day [--hours 24] [--workers 2]``. No peer answers this question. The wall time is to
stay within 60 s on two cores; the time of one core tells what the machine's other work took.
"""

from __future__ import annotations

import argparse
import resource
import time

import numpy as np
from scipy.spatial.transform import Rotation

from safestart.attitude.spin import Spin
from safestart.interchange.attitude_course import AttitudeCourse
from safestart.interchange.ephemeris import Ephemeris
from safestart.interchange.epochs import SECOND
from safestart.interchange.flights import BEGIN, CREATED
from safestart.interchange.relative import lvlh_axes, to_inertial
from safestart.interchange.write import course_bytes
from safestart.model.orbit import MU, KeplerOrbit
from safestart.model.scenario import Floats
from safestart.processes.side_by_side import execute_side_by_side

RADIUS, ECCENTRICITY = 7.0e6, 0.0005
STEP_S = 10.0
SLOW = 2e-4
"""Rate of the target against LVLH, rad/s: its corridor sweeps past the chaser three times a day."""


def target_states(seconds: Floats) -> Floats:
    """States (K, 6) on a Kepler orbit over the equator."""
    orbit = KeplerOrbit.of(RADIUS, ECCENTRICITY)
    angle = orbit.turned(seconds)
    parameter = RADIUS * (1.0 - ECCENTRICITY**2)
    distance = parameter / (1.0 + ECCENTRICITY * np.cos(angle))
    speed = np.sqrt(MU / parameter)
    zero = np.zeros(len(seconds))
    place = (distance * np.cos(angle), distance * np.sin(angle), zero)
    return np.stack([*place, -speed * np.sin(angle), speed * (ECCENTRICITY + np.cos(angle)), zero], axis=1)


def inputs_for(hours: float) -> dict[str, object]:
    """The three files, and what is asked."""
    seconds = np.arange(0.0, hours * 3600.0 + 0.5 * STEP_S, STEP_S)
    longer = np.arange(0.0, hours * 3600.0 + 100.0, STEP_S)
    relative = np.zeros((len(seconds), 6))
    for axis, size, period, middle in ((0, 6.0, 3000.0, 0.0), (1, 5.0, 5400.0, 40.0)):
        rate = 2.0 * np.pi / period
        relative[:, axis] = middle + size * np.sin(rate * seconds)
        relative[:, 3 + axis] = size * rate * np.cos(rate * seconds)
    target = target_states(seconds)
    turns = Spin(SLOW).rotation(longer) @ lvlh_axes(target_states(longer))[0]
    quaternions = np.roll(Rotation.from_matrix(turns.swapaxes(1, 2)).as_quat(), 1, axis=1)

    def epochs(times: Floats) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
        return BEGIN + np.rint(times * SECOND).astype(np.int64)

    courses = {
        "chaser": Ephemeris("CHASER", "1", "GCRF", "UTC", epochs(seconds), to_inertial(relative, target)),
        "target": Ephemeris("TARGET", "2", "GCRF", "UTC", epochs(seconds), target),
        "attitude": AttitudeCourse("TARGET", "2", "GCRF", "BODY", "UTC", epochs(longer), quaternions),
    }
    texts: dict[str, object] = {
        name: course_bytes(one, "kvn", CREATED).decode() for name, one in courses.items()
    }
    return texts | {"a_max_m_s2": 0.05, "horizon_s": 60, "step_s": STEP_S}


def main() -> None:
    """Ask, and print the times and the intervals."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--hours", type=float, default=24.0)
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    inputs = inputs_for(options.hours)
    began = time.perf_counter()
    result = execute_side_by_side("commit-timeline", inputs, workers=options.workers)
    wall = time.perf_counter() - began
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    outputs = result.document["outputs"]
    for one in outputs["intervals"]:
        print(f"{one['begin']} .. {one['end']}  {one['verdict']}  {one['instants']} instants")
    asked = sum(one["instants"] for one in outputs["intervals"])
    spent = sum(one.ru_utime + one.ru_stime for one in used)
    print(
        f"{outputs['steps']} steps, {asked} questions: {wall:.1f} s on {options.workers} cores, {spent:.1f} s of CPU"
    )


if __name__ == "__main__":
    main()
