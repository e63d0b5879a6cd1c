"""The record of flights: what became of each, and its history where that is kept."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from safestart.attitude.attitude import Attitude, to_body
from safestart.constraints.constraint import Constraint
from safestart.control.controller import Command
from safestart.model.scenario import Bools, Floats

Counts = np.ndarray[tuple[int], np.dtype[np.int64]]


@dataclass(frozen=True, slots=True)
class Path:
    """One flight at the T times at which it was written down, and its K control intervals.

    ``times`` (T,) s; ``states`` (T, 6) LVLH, m and m/s; ``thrust`` (K, 3) m/s^2 as delivered, each held over an
    interval; ``commands`` (K): what the controller asked for, empty where that is not kept; ``impulses`` (K, 3) m/s as
    delivered, each at the start of an interval, empty where there was none.
    """

    times: Floats
    states: Floats
    thrust: Floats
    commands: tuple[Command, ...] = ()
    impulses: Floats = field(default_factory=lambda: np.empty((0, 3)))

    def seen_from(self, attitude: Attitude) -> Floats:
        """States (T, 6) in the body frame."""
        return to_body(attitude, self.times, self.states)

    def distances(self, constraint: Constraint, attitude: Attitude) -> Floats:
        """Distances (T, F) of a constraint, m."""
        return constraint.room(self.times, self.states, attitude)[0]


@dataclass(frozen=True, slots=True)
class Record:
    """What became of M flights.

    ``margin`` (M,): least distance of any constraint over what was checked, m, NaN where the state left the
    floating-point numbers; a flight ends at its first violation, so a negative margin is the distance by which it was
    first seen outside. ``violated_at`` (M,): seconds, infinite without a violation. ``delta_v`` (M,): m/s spent.
    ``peak`` (M,): largest thrust acceleration delivered, m/s^2. ``steps`` (M,): control intervals begun.
    ``fallbacks`` (M,): those in which the controller found no admissible command. ``paths`` (M), or empty.
    """

    margin: Floats
    violated_at: Floats
    delta_v: Floats
    peak: Floats
    steps: Counts
    fallbacks: Counts
    paths: tuple[Path, ...] = ()

    def __len__(self) -> int:
        return len(self.margin)

    @property
    def finite(self) -> Bools:
        """Flown with numbers throughout, (M,)."""
        return np.asarray(~np.isnan(self.margin))

    @property
    def safe(self) -> Bools:
        """Never outside a constraint where it was checked, and a number throughout, (M,)."""
        return np.asarray((self.margin >= 0.0) & np.isinf(self.violated_at))

    @classmethod
    def joined(cls, records: Sequence[Record]) -> Record:
        """The flights of several records, in order."""
        return cls(
            np.concatenate([record.margin for record in records]),
            np.concatenate([record.violated_at for record in records]),
            np.concatenate([record.delta_v for record in records]),
            np.concatenate([record.peak for record in records]),
            np.concatenate([record.steps for record in records]),
            np.concatenate([record.fallbacks for record in records]),
            tuple(path for record in records for path in record.paths),
        )
