"""Plans from messages: the manoeuvres of a chaser's OPM or OCM beside the course of its target.

A message's manoeuvres may be in the chaser's own RTN
(RSW), TNW or inertial axes: the plan is flown about the Earth with J2, and each burn is turned into the target's LVLH
where the chaser is when it begins.
"""

from __future__ import annotations

import math

import numpy as np

from safestart.dynamics.two_body_kernel import STAGES, WEIGHTS, drifted, placed
from safestart.errors import invalid
from safestart.interchange.ccsds.parameters import Manoeuvre
from safestart.interchange.ephemeris import Ephemeris
from safestart.interchange.epochs import SECOND
from safestart.interchange.frames import rotation_to_gcrf, to_gcrf
from safestart.interchange.relative import in_lvlh, lvlh_axes
from safestart.missed_burn.earth.motion import burnt
from safestart.missed_burn.plan import Burn
from safestart.missed_burn.plan_text import Elements, Filed, courses_of, last_before
from safestart.model.orbit import MU
from safestart.model.scenario import Floats


def plan_in_message(plan: bytes, target: bytes) -> Filed:
    """From a chaser's OPM or OCM and the target's OEM, OPM, OCM or table; raises ``InvalidInput``.

    A course's state at the last epoch before the first burn counts, one at the burn itself where none is earlier; both
    craft are flown on from there. Burns come in the order of the file, which must be that of their times.
    """
    found, begin, ours, theirs = courses_of(plan, target)
    chaser, about = _state_at(ours, begin, "plan"), _state_at(theirs, begin, "target")
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
        flight, now = burnt(flight, np.array([x, y, z]), one.duration), time + one.duration
    return Filed(tuple(burns), start, elements_of(about))


def _state_at(course: Ephemeris, epoch: int, name: str) -> Floats:
    """GCRF state (6,) at an epoch, flown from the last one before it."""
    k, seconds = last_before(course, epoch, name)
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
