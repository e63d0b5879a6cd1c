"""A chaser near a target on one orbit, and attitude files that say the same as a spin."""

import numpy as np

from safestart.attitude.spin import Spin
from safestart.interchange.attitude_course import AttitudeCourse
from safestart.interchange.ephemeris import Ephemeris
from safestart.interchange.epochs import SECOND
from safestart.interchange.relative import lvlh_axes, to_inertial
from safestart.interchange.write import course_bytes
from tests.unit.interchange.sample import BEGIN, CREATED, kepler

Orbit = tuple[float, float, tuple[float, float, float], float]
ORBIT: Orbit = (7.0e6, 0.0002, (0.4, 0.9, 1.3), 0.3)


def states(seconds: np.ndarray) -> np.ndarray:
    """Known states (K, 6) of the chaser, LVLH: around 40 m ahead."""
    out = np.zeros((len(seconds), 6))
    out[:, 0], out[:, 3] = 6.0 * np.sin(0.02 * seconds), 0.12 * np.cos(0.02 * seconds)
    out[:, 1], out[:, 2] = 40.0, 1.0
    return out


def epochs(seconds: np.ndarray) -> np.ndarray:
    return BEGIN + np.rint(seconds * SECOND).astype(np.int64)


def pair(
    span: float = 300.0, step: float = 10.0, orbit: Orbit = ORBIT, system: str = "UTC"
) -> tuple[Ephemeris, Ephemeris]:
    """Chaser and target."""
    seconds = np.arange(0.0, span + 0.5 * step, step)
    target = kepler(*orbit, seconds)
    chaser = to_inertial(states(seconds), target)
    at = epochs(seconds)
    return (
        Ephemeris("CHASER", "2026-001A", "GCRF", system, at, chaser),
        Ephemeris("TARGET", "2020-001A", "GCRF", system, at, target),
    )


def attitude(
    spin: Spin, span: float, step: float = 1.0, orbit: Orbit = ORBIT, reference: str = "GCRF"
) -> AttitudeCourse:
    """The spin as a file against inertial axes or RTN."""
    from scipy.spatial.transform import Rotation

    seconds = np.arange(0.0, span + 0.5 * step, step)
    turns = spin.rotation(seconds)
    if reference != "RTN":
        turns = turns @ lvlh_axes(kepler(*orbit, seconds))[0]
    found = np.roll(Rotation.from_matrix(turns.swapaxes(1, 2)).as_quat(), 1, axis=1)
    return AttitudeCourse("TARGET", "2020-001A", reference, "SC_BODY_1", "UTC", epochs(seconds), found)


def text(course: Ephemeris | AttitudeCourse, form: str = "kvn") -> str:
    return course_bytes(course, form, CREATED).decode()
