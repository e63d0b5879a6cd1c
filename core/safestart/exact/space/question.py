"""The questions in space: a thrust history that keeps every face's distance positive at all times of [0, T], and
brings the chaser to rest against the turning body at T where it is asked to?

Faces are half-spaces normal . p <= offset, fixed in the turning body or in LVLH. The motion is linear, the attitude a
known function of time and the set of thrusts convex, so the largest margin is a convex problem, as for the planar
question (:mod:`safestart.exact.question`): only the rows differ.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar

import numpy as np
from scipy.optimize import linprog

from safestart.attitude.in_lvlh import InLvlh
from safestart.attitude.table import Table
from safestart.attitude.torque_free import TorqueFree
from safestart.attitude.turning import SmoothAttitude
from safestart.constraints.thrust_limit import Frame, ThrustLimit, Vector
from safestart.dynamics.cwh import Cwh
from safestart.dynamics.motion import RelativeMotion
from safestart.dynamics.yamanaka_ankersen import YamanakaAnkersen
from safestart.errors import invalid
from safestart.exact.limits import AT_END, SPEED
from safestart.exact.question import Goal, Spanned, check_steps
from safestart.exact.space.demands.rules import NONE, PLUME, VIEW, Demands
from safestart.exact.space.unknowns import KNOWN, Unknowns
from safestart.model.orbit import KeplerOrbit
from safestart.model.scenario import MAX_RANGE, CorridorShape, Floats, number
from safestart.optim.thrust_shapes import BALL, CUBE, SIMPLEX, UnitSet

MOST_FACES = 32
OTHERS = frozenset((*AT_END, SPEED, VIEW, PLUME))
"""Names of what proofs name beside faces, whether or not a question has it."""
_UNIT_SETS: dict[str, UnitSet] = {"ball": BALL, "box": CUBE, "thrusters": SIMPLEX}


@dataclass(frozen=True, slots=True)
class Face:
    """normal . p <= ``offset`` (m times the normal's length) for the position p in ``frame``."""

    name: str
    normal: Vector
    offset: float
    frame: Frame = "body"


@dataclass(frozen=True, slots=True)
class SpaceQuestion(Spanned):
    """``steps`` intervals of ``dt`` s; raises ``InvalidInput`` for an invalid question.

    Faces: 1 to 32 with different names, none of ``OTHERS``, and nonzero normals; the faces of each frame have a point
    in common. A table of attitudes reaches the horizon.

    ``goal`` makes it `synchronize`: at T, any number of intervals from ``goal.earliest`` to ``steps``, the chaser is at
    rest against the turning body in a ball around ``goal.hold`` (body frame, m). ``speed_limit`` (m/s) holds for the
    LVLH velocity at all times. ``demands`` hold beside the faces; no linear program answers them. ``unknowns`` make it
    a question about all members, for `stay` alone and thrusts whose set does not turn with the body.
    """

    orbit: KeplerOrbit
    attitude: SmoothAttitude
    faces: tuple[Face, ...]
    thrust: ThrustLimit
    dt: float = 2.0
    steps: int = 30
    goal: Goal | None = None
    speed_limit: float | None = None
    demands: Demands = NONE
    unknowns: Unknowns = KNOWN
    dimensions: ClassVar[int] = 3

    def __post_init__(self) -> None:
        self.check_span()
        _check_faces(self.faces)
        if self.goal is not None:
            _check_goal(self.goal, self.faces, self.steps)
        self.demands.check([*(face.name for face in self.faces), *AT_END, SPEED])
        if self.demands.plume is not None and self.thrust.kind != "ball":
            # A sum of thrusts away from the target may come from a thruster that blows at it.
            required = "thrust of kind ball: one exhaust, opposite to the thrust"
            raise invalid("plume", required, self.thrust.kind)
        inner = self.attitude.inertial if isinstance(self.attitude, InLvlh) else self.attitude
        if isinstance(self.attitude, InLvlh) and self.attitude.orbit != self.orbit:
            raise invalid("attitude", "one seen from LVLH on the question's orbit", "another orbit")
        if isinstance(inner, Table):
            inner.reaches(self.horizon)
        if self.unknowns:
            self._check_unknowns(inner)

    def _check_unknowns(self, inner: SmoothAttitude) -> None:
        if not self.plain:
            asked = ", ".join(self.demands.names) or (SPEED if self.goal is None else self.kind)
            required = (
                "stay without a speed limit or demands where attitude, rate, inertia or forces are not known"
            )
            raise invalid("question", required, asked)
        if self.thrust.kind != "ball" and self.thrust.frame == "body" and self.unknowns.turns:
            required = "axes of LVLH where the attitude is not known: the set of thrusts would turn with it"
            raise invalid("thrust.frame", required, "body")
        if self.unknowns.inertia and not isinstance(inner, TorqueFree):
            raise invalid("inertia", "0 unless the attitude is torque_free", self.unknowns.inertia)

    @property
    def plain(self) -> bool:
        """Whether this is `stay` without a speed limit or demands, so that only faces count."""
        return self.goal is None and self.speed_limit is None and not self.demands

    @property
    def motion(self) -> RelativeMotion:
        """CWH on a circular orbit, Yamanaka and Ankersen's on an elliptic one."""
        return Cwh(self.orbit.mean_motion) if self.orbit.circular else YamanakaAnkersen(self.orbit)

    @property
    def thrust_set(self) -> UnitSet:
        """The unit set of which the thrusts are an image."""
        return _UNIT_SETS[self.thrust.kind]

    @property
    def thrust_scale(self) -> float:
        """For a ball its radius, m/s^2; else 1: the rows hold the map."""
        return self.thrust.a_max[0] if self.thrust.kind == "ball" else 1.0

    @property
    def channels(self) -> int:
        """The number of components of one point."""
        return self.thrust.channels

    @property
    def largest_thrust(self) -> float:
        """Largest size of a thrust, m/s^2."""
        return self.thrust.largest


def five_faces(shape: CorridorShape, axis: Vector = (0.0, 1.0, 0.0)) -> tuple[Face, ...]:
    """The paper's corridor along ``axis`` (body frame), turned from +y by the shortest rotation."""
    x, y, z = axis
    turn = turned_from_y(axis)
    cx, cz, rh = shape.c_x, shape.c_z, shape.hold_radius
    rows = (
        ("hold_plane", (0.0, -1.0, 0.0), -rh),
        ("right", (1.0, -cx, 0.0), shape.x0 - cx * rh),
        ("left", (-1.0, -cx, 0.0), shape.x0 - cx * rh),
        ("top", (0.0, -cz, 1.0), shape.z0 - cz * rh),
        ("bottom", (0.0, -cz, -1.0), shape.z0 - cz * rh),
    )
    out = []
    for name, normal, offset in rows:
        turned = (turn @ np.array(normal)).tolist() if (x, z) != (0.0, 0.0) or y < 0.0 else list(normal)
        out.append(Face(name, (turned[0], turned[1], turned[2]), offset))
    return tuple(out)


def turned_from_y(axis: Vector) -> Floats:
    """The shortest rotation (3, 3) that turns +y into ``axis``; raises ``InvalidInput`` for an axis of length 0."""
    length = math.hypot(*axis)
    if not 0.0 < length < math.inf:
        raise invalid("axis", "three finite numbers, not all 0", axis)
    x, y, z = (float(e) / length for e in axis)
    if y > -1.0 + 1e-12:
        # I + [v]x + [v]x^2 / (1 + y) for v = (y axis) x axis = (z, 0, -x).
        share = 1.0 / (1.0 + y)
        turn = np.array(
            [[1.0 - share * x * x, x, -share * x * z], [-x, y, -z], [-share * x * z, z, 1.0 - share * z * z]]
        )
    else:
        turn = np.diag([1.0, -1.0, -1.0])
    return np.asarray(turn)


def _check_goal(goal: Goal, faces: Sequence[Face], steps: int) -> None:
    check_steps("earliest", goal.earliest, steps)
    hold = goal.hold
    if hold is None or len(hold) != 3 or not all(map(math.isfinite, hold)):
        raise invalid("hold", "three numbers: a point of the body frame", hold)
    outside = [
        face.name for face in faces if face.frame == "body" and np.dot(face.normal, hold) > face.offset
    ]
    if outside:
        raise invalid("hold", f"a point inside the faces {', '.join(outside)}", hold)


@lru_cache(maxsize=64)
def _check_faces(faces: tuple[Face, ...]) -> None:
    if not 1 <= len(faces) <= MOST_FACES:
        raise invalid("faces", f"1 to {MOST_FACES} faces", len(faces))
    names = [face.name for face in faces]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice or not all(isinstance(name, str) and 0 < len(name) <= 40 for name in names):
        raise invalid("faces", "names of 1 to 40 characters, each once", twice or names)
    if not OTHERS.isdisjoint(names):
        raise invalid("faces", f"names other than {', '.join(sorted(OTHERS))}", names)
    for k, face in enumerate(faces):
        if face.frame not in ("lvlh", "body"):
            raise invalid(f"faces.{k}.frame", "lvlh or body", face.frame)
        if len(face.normal) != 3 or not 1e-6 <= math.hypot(*face.normal) <= 1e6:
            raise invalid(f"faces.{k}.normal", "three numbers of a length in [1e-6, 1e6]", face.normal)
        number(f"faces.{k}.offset", face.offset, -MAX_RANGE * 1e6, MAX_RANGE * 1e6)
    for frame in ("lvlh", "body"):
        chosen = [face for face in faces if face.frame == frame]
        if chosen and not _meet(chosen):
            raise invalid("faces", f"faces in {frame} axes with a point in common", [f.name for f in chosen])


def _meet(faces: Sequence[Face]) -> bool:
    """Whether a point lies inside all of them."""
    normals = np.array([face.normal for face in faces])
    lengths = np.linalg.norm(normals, axis=1)
    rows = np.column_stack([normals / lengths[:, None], np.ones(len(faces))])
    offsets = np.array([face.offset for face in faces]) / lengths
    # The largest ball, of at most a metre, in the polyhedron.
    found = linprog([0.0, 0.0, 0.0, -1.0], rows, offsets, bounds=[(None, None)] * 3 + [(None, 1.0)])
    return found.x is not None and float(found.x[3]) >= 0.0


def starts_in_lvlh(attitude: SmoothAttitude, positions: Floats, velocities: Floats) -> Floats:
    """LVLH starts (S, 6) of body-frame positions (S, 3), m, and velocities (S, 3) relative to the turning body, m/s."""
    at = np.zeros(1)
    turn, omega = attitude.rotation(at)[0], attitude.angular_velocity(at)[0]
    out: Floats = np.concatenate([positions @ turn, (velocities + np.cross(omega, positions)) @ turn], axis=1)
    return out
