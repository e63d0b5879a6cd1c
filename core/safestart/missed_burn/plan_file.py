"""Plans from files: burns in CSV, or the manoeuvres of a chaser's OPM or OCM beside the course of its target.

CSV holds ``time_s``, ``dv_x_m_s``, ``dv_y_m_s``, ``dv_z_m_s`` (LVLH) and, where burns last, ``duration_s``; the columns
that the approach designer's burns have besides are passed over. A message's manoeuvres may be in the chaser's own RTN
(RSW), TNW or inertial axes: the plan is flown about the Earth with J2, and each burn is turned into the target's LVLH
where the chaser is when it begins.
"""

from __future__ import annotations

import csv
import io
import math
from dataclasses import dataclass

import numpy as np

from safestart.dynamics.two_body_kernel import STAGES, WEIGHTS, drifted, placed, pushed
from safestart.errors import invalid
from safestart.interchange.ccsds.parameters import Manoeuvre
from safestart.interchange.ccsds.tokens import number
from safestart.interchange.ephemeris import Ephemeris
from safestart.interchange.epochs import SECOND
from safestart.interchange.frames import rotation_to_gcrf, to_gcrf
from safestart.interchange.read import ephemeris_from, manoeuvres_from
from safestart.interchange.relative import in_lvlh, lvlh_axes
from safestart.missed_burn.plan import Burn
from safestart.model.orbit import MU
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


def plan_in_message(plan: bytes, target: bytes) -> Filed:
    """From a chaser's OPM or OCM and the target's OEM, OPM, OCM or table; raises ``InvalidInput``.

    A course's state at the last epoch before the first burn counts, one at the burn itself where none is earlier; both
    craft are flown on from there. Burns come in the order of the file, which must be that of their times.
    """
    found = manoeuvres_from(plan)
    if not found:
        raise invalid("plan", "manoeuvres of the chaser", "none")
    begin = min(one.epoch for one in found)
    chaser = _state_at(ephemeris_from(plan), begin, "plan")
    about = _state_at(ephemeris_from(target), begin, "target")
    (axes,), (rate,) = lvlh_axes(about[None])
    (start,) = in_lvlh(chaser[None], about[None], axes[None], np.array([rate]))
    flight, now, burns = placed(about, start), 0.0, []
    for one in found:
        time = (one.epoch - begin) / SECOND
        if time > now:
            flight, now = drifted(flight, time - now, STAGES, WEIGHTS)[0], time
        (axes,), _ = lvlh_axes(flight[None, :6])
        x, y, z = (axes @ _inertial(one, flight[:6] + flight[6:])).tolist()
        burns.append(Burn(time, (x, y, z), one.duration))
        pushed(flight, np.array([x, y, z]))
    return Filed(tuple(burns), start, elements_of(about))


def _state_at(course: Ephemeris, epoch: int, name: str) -> Floats:
    """GCRF state (6,) at an epoch, flown from the last one before it."""
    before = np.flatnonzero(course.epochs < epoch)
    at = np.flatnonzero(course.epochs == epoch)
    if not len(before) and not len(at):
        raise invalid(name, "a state at or before the first manoeuvre", "later ones only")
    k = int(before[-1]) if len(before) else int(at[0])
    seconds = (epoch - int(course.epochs[k])) / SECOND
    if seconds > LONGEST_COAST_S:
        raise invalid(name, f"a state at most {LONGEST_COAST_S:g} s before the first manoeuvre", seconds)
    state = to_gcrf(course.frame, course.epochs[k : k + 1], course.states[k : k + 1])[0]
    if seconds == 0.0:
        return np.array(state)
    whole, _ = drifted(np.concatenate([state, np.zeros(6)]), seconds, STAGES, WEIGHTS)
    out: Floats = whole[:6]
    return out


def _inertial(burn: Manoeuvre, chaser: Floats) -> Floats:
    """The burn's change of velocity (3,) in GCRF."""
    name = burn.frame.upper().removesuffix("_INERTIAL").removesuffix("_ROTATING")
    if name.startswith("ITRF"):
        raise invalid("MAN_REF_FRAME", "RTN, RSW, TNW or inertial axes", burn.frame)
    if name in ("RTN", "RSW", "RIC"):
        axes = lvlh_axes(chaser[None])[0][0].T
    elif name == "TNW":
        along = chaser[3:] / np.linalg.norm(chaser[3:])
        out_of_plane = np.cross(chaser[:3], chaser[3:])
        out_of_plane /= np.linalg.norm(out_of_plane)
        axes = np.array([along, np.cross(out_of_plane, along), out_of_plane]).T
    else:
        axes = rotation_to_gcrf(burn.frame, np.array([burn.epoch]))[0]
    turned: Floats = axes @ np.array(burn.delta_v)
    return turned


def elements_of(state: Floats) -> Elements:
    """Osculating elements of an inertial state (6,); raises ``InvalidInput`` for no ellipse.

    Without a node (equator) angles count from the x axis; on a circle perigee lies on the node.
    """
    r, v = state[:3], state[3:]
    size = float(np.linalg.norm(r))
    energy = 0.5 * float(v @ v) - MU / size
    if not energy < 0.0:
        raise invalid("target", "a closed orbit", f"energy {energy:g} m^2/s^2")
    h = np.cross(r, v)
    momentum = float(np.linalg.norm(h))
    pole = h / momentum
    tilt = math.atan2(math.hypot(float(h[0]), float(h[1])), float(h[2]))
    node = np.array([-h[1], h[0], 0.0]) if math.sin(tilt) > 1e-12 else np.array([1.0, 0.0, 0.0])
    node /= np.linalg.norm(node)
    bulge = np.cross(v, h) / MU - r / size
    eccentricity = float(np.linalg.norm(bulge))

    def angle(v: Floats) -> float:
        return math.atan2(float(v @ np.cross(pole, node)), float(v @ node))

    latitude = angle(r)
    perigee = angle(bulge) if eccentricity > 1e-12 else 0.0
    return Elements(-MU / (2.0 * energy), eccentricity, tilt, perigee, latitude - perigee)
