"""Plans as text: burns in CSV, and what a message of manoeuvres must say; light to import.

CSV holds ``time_s``, ``dv_x_m_s``, ``dv_y_m_s``, ``dv_z_m_s`` (LVLH) and, where burns last, ``duration_s``; the columns
that the approach designer's burns have besides are passed over.
"""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass

import numpy as np

from safestart.errors import invalid
from safestart.interchange.ccsds.parameters import Manoeuvre
from safestart.interchange.ccsds.tokens import number
from safestart.interchange.ephemeris import Ephemeris
from safestart.interchange.epochs import SECOND
from safestart.interchange.read import ephemeris_from, manoeuvres_from
from safestart.missed_burn.plan import Burn
from safestart.model.scenario import Floats

LONGEST_COAST_S = 86_400.0
"""A state so long before the first burn says too little about it."""
_DV = ("dv_x_m_s", "dv_y_m_s", "dv_z_m_s")
_PASSED_OVER = ("burn", "distance_m", "x_m", "y_m", "z_m")
_MOST_ROWS = 1000


@dataclass(frozen=True, slots=True)
class Elements:
    """Osculating elements, m and rad; the node does not count, as the Earth with J2 is round about its axis."""

    semi_major_axis: float
    eccentricity: float
    inclination: float
    perigee: float
    anomaly: float


@dataclass(frozen=True, slots=True)
class Filed:
    """``burns`` in LVLH, the first at 0 s in a message; a message also gives the LVLH ``start`` (6,) before the first
    burn and the target's elements then."""

    burns: tuple[Burn, ...]
    start: Floats | None = None
    target: Elements | None = None


def is_message(text: str) -> bool:
    """Whether a text is a CCSDS message; otherwise it is read as CSV."""
    return text.lstrip("\ufeff \t\r\n").startswith(("CCSDS_", "<"))


def burns_in_csv(text: str) -> Filed:
    """Raises ``InvalidInput`` for missing and unknown columns, short rows and values that are not numbers."""
    rows = [row for row in csv.reader(io.StringIO(text.lstrip("\ufeff"), newline="")) if row]
    head = [name.strip() for name in rows[0]] if rows else []
    needed = [name for name in ("time_s", *_DV) if name not in head]
    unknown = [name for name in head if name not in ("time_s", *_DV, "duration_s", *_PASSED_OVER)]
    if needed or unknown or len(set(head)) != len(head):
        asked = f"columns time_s, {', '.join(_DV)}, each once, and if burns last duration_s"
        raise invalid("plan", asked, ", ".join(head)[:200] or "an empty file")
    if not 2 <= len(rows) <= 1 + _MOST_ROWS:
        raise invalid("plan", f"1 to {_MOST_ROWS} burns", len(rows) - 1)
    burns = []
    for line, row in enumerate(rows[1:], 2):
        if len(row) != len(head):
            raise invalid(f"plan line {line}", f"{len(head)} values", f"{len(row)} (truncated)")
        cells = dict(zip(head, row, strict=True))
        time, x, y, z = (number(cells[name].strip(), line, name) for name in ("time_s", *_DV))
        lasts = number(cells["duration_s"].strip(), line, "duration_s") if "duration_s" in cells else 0.0
        burns.append(Burn(time, (x, y, z), lasts))
    return Filed(tuple(burns))


def courses_of(plan: bytes, target: bytes) -> tuple[list[Manoeuvre], int, Ephemeris, Ephemeris]:
    """The manoeuvres, the epoch of the first one and both courses, which have a state before it; raises
    ``InvalidInput``."""
    found = list(manoeuvres_from(plan))
    if not found:
        raise invalid("plan", "manoeuvres of the chaser", "none")
    begin = min(one.epoch for one in found)
    for one in found:
        if one.frame.upper().startswith("ITRF"):
            raise invalid("MAN_REF_FRAME", "RTN, RSW, TNW or inertial axes", one.frame)
    ours, theirs = ephemeris_from(plan), ephemeris_from(target)
    last_before(ours, begin, "plan"), last_before(theirs, begin, "target")
    return found, begin, ours, theirs


def last_before(course: Ephemeris, epoch: int, name: str) -> tuple[int, float]:
    """The number of a course's last state before an epoch, or at it where none is earlier, and the seconds between."""
    before = np.flatnonzero(course.epochs < epoch)
    at = np.flatnonzero(course.epochs == epoch)
    if not len(before) and not len(at):
        raise invalid(name, "a state at or before the first manoeuvre", "later ones only")
    k = int(before[-1]) if len(before) else int(at[0])
    seconds = (epoch - int(course.epochs[k])) / SECOND
    if seconds > LONGEST_COAST_S:
        raise invalid(name, f"a state at most {LONGEST_COAST_S:g} s before the first manoeuvre", seconds)
    return k, seconds
