"""The record of flights: the outcome of each, and its history if kept."""

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
    """One flight at its T recorded times, and its K control intervals.

    ``times`` (T,) s; ``states`` (T, 6) LVLH, m and m/s; ``thrust`` (K, 3) m/s^2 as delivered, each held over an
    interval; ``commands`` (K): the controller's commands, empty if not kept; ``impulses`` (K, 3) m/s as delivered, each
    at the start of an interval, empty without impulses.
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
    """The outcomes of M flights.

    ``margin`` (M,): least checked distance of any constraint, m, NaN if the state became non-finite; a flight ends at
    its first violation, so a negative margin is the distance by which it was first seen outside. ``violated_at`` (M,):
    seconds, infinite without a violation. ``delta_v`` (M,): m/s spent. ``peak`` (M,): largest thrust acceleration
    delivered, m/s^2. ``steps`` (M,): control intervals begun. ``fallbacks`` (M,): intervals in which the controller
    found no admissible command. ``paths`` (M), or empty.
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
        """True where the state stayed finite, (M,)."""
        return np.asarray(~np.isnan(self.margin))

    @property
    def safe(self) -> Bools:
        """True where every check held and the state stayed finite, (M,)."""
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
