"""A course of states in a named frame, read from an OEM, an OPM, an OCM or a table."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from safestart.errors import invalid
from safestart.interchange.attitude_course import Window
from safestart.interchange.covariance import Covariance
from safestart.interchange.epochs import Nanoseconds, system_of, text_of
from safestart.interchange.frames import frame_of
from safestart.model.orbit import EARTH_RADIUS
from safestart.model.plain_text import require_line
from safestart.model.scenario import Floats

MOST_STATES = 1_000_000
_NEAREST, _FURTHEST, _FASTEST = 0.9 * EARTH_RADIUS, 1e9, 2e4


@dataclass(frozen=True)
class Ephemeris:
    """``states`` (K, 6), m and m/s, in ``frame`` at ascending TAI ``epochs`` (K,), ns.

    ``time_system`` is that of the file's epochs; ``covariances`` have their own epochs. ``pieces`` (S,) are
    the indices at which a new segment begins, 0 first: nothing is interpolated from one to the next. Where one begins
    at the epoch at which the last ends (a burn), both states are there. ``useable`` has the first and last useable
    epoch of each segment, or None, or is empty: states outside only help to interpolate. ``left_out``
    names what the file holds besides. Raises ``InvalidInput`` for
    epochs that do not rise, non-finite states, and states of no orbit of the Earth (wrong units).
    """

    name: str
    object_id: str
    frame: str
    time_system: str
    epochs: Nanoseconds
    states: Floats
    covariances: tuple[Covariance, ...] = ()
    pieces: tuple[int, ...] = (0,)
    center: str = field(default="EARTH")
    useable: tuple[Window | None, ...] = ()
    left_out: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for item, text in (("OBJECT_NAME", self.name), ("OBJECT_ID", self.object_id)):
            require_line(item, text)
        object.__setattr__(self, "frame", frame_of(self.frame))
        system_of(self.time_system)
        if self.center.upper() != "EARTH":
            raise invalid("CENTER_NAME", "EARTH", self.center)
        count = len(self.epochs)
        if not 1 <= count <= MOST_STATES or self.states.shape != (count, 6):
            raise invalid(
                "states", f"1 to {MOST_STATES} epochs and as many states of 6 numbers", self.states.shape
            )
        steps = np.diff(self.epochs)
        joints = [piece - 1 for piece in self.pieces[1:]]
        steps[joints] += steps[joints] == 0
        if (steps <= 0).any():
            k = int(np.argmax(steps <= 0))
            before, after = text_of(self.epochs[k : k + 2], self.time_system)
            raise invalid("epochs", "epochs that rise", f"{after} after {before}")
        if not np.isfinite(self.states).all():
            raise invalid("states", "finite numbers", "others")
        distance = np.sqrt(np.square(self.states[:, :3]).sum(axis=1))
        speed = np.sqrt(np.square(self.states[:, 3:]).sum(axis=1))
        wrong = (distance < _NEAREST) | (distance > _FURTHEST) | (speed > _FASTEST) | (speed < 10.0)
        if wrong.any():
            k = int(np.argmax(wrong))
            raise invalid(
                "states",
                f"an orbit of the Earth: {_NEAREST:g} to {_FURTHEST:g} m from its centre, 10 to {_FASTEST:g} m/s "
                "(files hold km and km/s)",
                f"{distance[k]:g} m and {speed[k]:g} m/s at {text_of(self.epochs[k : k + 1], self.time_system)[0]}",
            )
