"""What is known at an instant: the chaser in the target's LVLH, the orbit, and how the target turns from then on."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from safestart.attitude.in_lvlh import InLvlh
from safestart.attitude.quaternion import conjugate, matrix_of, product, quaternion_of
from safestart.attitude.spin import Spin
from safestart.attitude.table import LARGEST_STEP, Table
from safestart.attitude.turning import SmoothAttitude
from safestart.errors import invalid
from safestart.interchange.attitude_course import AttitudeCourse, turns_of
from safestart.interchange.ephemeris import Ephemeris
from safestart.interchange.epochs import SECOND, Nanoseconds, seconds_since, text_of
from safestart.interchange.frames import (
    require_comparable,
    rotation_to_gcrf,
    to_gcrf,
    turns_with_the_earth,
)
from safestart.interchange.relative import Relative, relative_states
from safestart.interchange.sampling import quaternions_at
from safestart.model.orbit import MU, KeplerOrbit
from safestart.model.scenario import Floats
from safestart.timeline.spread import StartBoxes, start_boxes

RATE_GRID = 1e-7
"""Circular orbits turn at multiples of this, rad/s, so that few tables serve a day: 6e-6 rad in a minute."""
MODEL_ERROR_M = 0.01
"""An orbit is taken as circular where that moves the chaser by at most so much, m, within the horizon."""
SMALLEST_RANGE_M = 10.0


@dataclass(frozen=True)
class Encounter:
    """Two courses, and an attitude: a course of its own, or a steady ``spin`` against LVLH from ``begin`` on.

    With a ``confidence`` the chaser's state is uncertain, by the covariances of the two courses.

    Raises ``InvalidInput`` for an attitude that turns by more than 90 degrees between two entries, and for one against
    inertial axes beside courses in ITRF.
    """

    chaser: Ephemeris
    target: Ephemeris
    attitude: AttitudeCourse | Spin
    begin: int
    horizon: float
    confidence: float | None = None
    boxes: StartBoxes | None = field(init=False, default=None)

    def __post_init__(self) -> None:
        require_comparable(self.chaser.frame, self.target.frame)
        attitude = self.attitude
        if isinstance(attitude, AttitudeCourse):
            if attitude.reference != "RTN" and turns_with_the_earth(self.target.frame):
                raise invalid("REF_FRAME", "courses in an inertial frame beside an inertial attitude", "ITRF")
            turns, seconds = turns_of(attitude.quaternions), np.diff(attitude.epochs)
            # A step as long as others must not turn too far; in a hole, or from segment to segment, nothing is known.
            turns[[piece - 1 for piece in attitude.pieces[1:]]] = 0.0
            if len(turns):
                turns[seconds > 1.5 * np.median(seconds)] = 0.0
            if float(turns.max(initial=0.0)) > LARGEST_STEP:
                k = int(np.argmax(turns))
                at = text_of(attitude.epochs[k : k + 1], attitude.time_system)[0]
                raise invalid("attitude", "at most 90 degrees between two entries", f"more after {at}")
        covariances = self.chaser.covariances, self.target.covariances
        for name in ("chaser", "target"):
            course: Ephemeris = getattr(self, name)
            states = to_gcrf(course.frame, course.epochs, course.states)
            object.__setattr__(self, name, replace(course, frame="GCRF", states=states, covariances=()))
        if self.confidence is not None:
            boxes = start_boxes(self.chaser, self.target, covariances, self.confidence)
            object.__setattr__(self, "boxes", boxes)

    @cached_property
    def _course(self) -> AttitudeCourse | None:
        """The attitude's course against GCRF, or as it is against RTN; None for a spin."""
        attitude = self.attitude
        if isinstance(attitude, Spin):
            return None
        if attitude.reference == "RTN":
            return attitude
        back = rotation_to_gcrf(attitude.reference, attitude.epochs).swapaxes(1, 2)
        # Axes that stay are turned once for all entries.
        steady = attitude.reference != "TEME"
        first = np.array([quaternion_of(turn) for turn in (back[:1] if steady else back)])
        return replace(attitude, reference="GCRF", quaternions=product(first, attitude.quaternions))

    def seen(self, epochs: Nanoseconds) -> Relative:
        """The chaser in the target's LVLH at TAI ``epochs`` (K,)."""
        return relative_states(self.chaser, self.target, epochs)

    def covered(self, epochs: Nanoseconds) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
        """(K,): whether the attitude is known from each epoch to the end of its horizon."""
        course = self._course
        if course is None:
            return np.ones(len(epochs), dtype=bool)
        spans = self._spans
        own = np.searchsorted(spans[:, 0], epochs, side="right") - 1
        last = spans[np.maximum(own, 0), 1] - round(self.horizon * SECOND) if len(spans) else epochs - 1
        return np.asarray((own >= 0) & (epochs <= last))

    @cached_property
    def _spans(self) -> Nanoseconds:
        """(S, 2): where the attitude is known."""
        assert self._course is not None
        return self._course.spans()

    def turns(self, seen: Relative) -> Floats:
        """(K, 3, 3): LVLH coordinates to body coordinates at the epochs of ``seen``, all :meth:`covered`."""
        course = self._course
        if course is None:
            assert isinstance(self.attitude, Spin)
            return self.attitude.rotation(seconds_since(seen.epochs, self.begin))
        turned = matrix_of(quaternions_at(course, seen.epochs))
        return turned if course.reference == "RTN" else turned @ seen.axes.swapaxes(1, 2)

    def orbit(self, seen: Relative, k: int) -> KeplerOrbit:
        """The target's orbit around the ``k``-th epoch: circular where that is good enough, else osculating."""
        e, rate = float(seen.eccentricities()[k]), float(seen.rates[k])
        distance = max(SMALLEST_RANGE_M, float(np.linalg.norm(seen.states[k, :3])))
        # nu'' = 2 e n^2 at most: so far does an ellipse turn LVLH ahead of a circle.
        if e * (rate * self.horizon) ** 2 * distance <= MODEL_ERROR_M:
            return KeplerOrbit(RATE_GRID * round(rate / RATE_GRID))
        position, velocity = seen.target[k, :3], seen.target[k, 3:]
        radial = float(position @ velocity) / float(np.linalg.norm(position))
        momentum = float(np.linalg.norm(np.cross(position, velocity)))
        # r = p / (1 + e cos nu) and r' = (h / p) e sin nu.
        n = float(seen.mean_motions()[k])
        parameter = momentum * momentum / MU
        anomaly = math.atan2(parameter * radial / momentum, parameter / float(np.linalg.norm(position)) - 1.0)
        return KeplerOrbit(n, e, anomaly)

    def attitude_from(self, seen: Relative, k: int, orbit: KeplerOrbit) -> SmoothAttitude:
        """How the body turns from the ``k``-th epoch to the end of its horizon, as LVLH sees it."""
        course, at = self._course, int(seen.epochs[k])
        if course is None:
            spin = self.attitude
            assert isinstance(spin, Spin)
            return Spin(spin.rate, spin.axis, spin.phase + spin.rate * (at - self.begin) / SECOND)
        end = at + round(self.horizon * SECOND)
        inside = course.epochs[(course.epochs > at) & (course.epochs < end)]
        # The end is rounded to a nanosecond: the table goes on a little further.
        times = np.concatenate([[at], inside, [end]])
        turns = quaternions_at(course, times)
        seconds = seconds_since(times, at)
        seconds[-1] = math.nextafter(max(seconds[-1], self.horizon), math.inf)
        if course.reference == "RTN":
            return _table(seconds, turns)
        axes = quaternion_of(seen.axes[k])
        return InLvlh(_table(seconds, product(conjugate(axes)[None, :], turns)), orbit)


def _table(seconds: Floats, turns: Floats) -> Table:
    entries = tuple((s, x, y, z) for s, x, y, z in turns.tolist())
    return Table(tuple(seconds.tolist()), entries)
