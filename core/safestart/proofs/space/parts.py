"""Parts of a statement in space, read strictly: attitude, faces, set of thrusts. Part of the checker."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from flint import fmpq

from safestart.proofs.strict import LARGEST, ProofRejected, exact, fields, number, part, shown, vector

_MOST_FACES, _MOST_THRUSTERS = 32, 32
_FRAMES = ("lvlh", "body")


@dataclass(frozen=True, slots=True)
class Attitude:
    """How the body turns, and whether what it turns against is inertial; what its ``kind`` does not use is empty."""

    kind: str
    inertial: bool
    axis: list[fmpq]
    rate: fmpq
    phase: fmpq
    inertia: list[list[fmpq]]
    rate_vector: list[fmpq]
    times: list[fmpq]
    quaternions: list[list[fmpq]]


@dataclass(frozen=True, slots=True)
class Face:
    """normal . p <= offset in ``frame``."""

    normal: list[fmpq]
    offset: fmpq
    frame: str


@dataclass(frozen=True, slots=True)
class Thrust:
    """``kind`` ball, box or thrusters; bounds in m/s^2, ``directions`` of thrusters, axes of ``frame``."""

    kind: str
    bounds: list[fmpq]
    directions: list[list[fmpq]]
    frame: str

    @property
    def channels(self) -> int:
        """Numbers that make one thrust."""
        return len(self.directions) if self.kind == "thrusters" else 3


def frame_of(document: Any, name: str) -> str:
    """The frame of a part; raises :class:`ProofRejected`."""
    frame = part(document, "frame", str)
    if frame not in _FRAMES:
        raise ProofRejected(f"{name}: required the frame lvlh or body, received {shown(frame)}")
    return str(frame)


def faces_of(rows: list[Any]) -> dict[str, Face]:
    """The faces by name; raises :class:`ProofRejected`."""
    if not 1 <= len(rows) <= _MOST_FACES:
        raise ProofRejected(f"faces: required 1..{_MOST_FACES}, received {len(rows)}")
    out: dict[str, Face] = {}
    for row in rows:
        fields(row, "faces", ("name", "normal", "offset_m", "frame"))
        name, normal = part(row, "name", str), vector(row["normal"], "normal", 3)
        if name in out or not 0 < len(name) <= 40:
            raise ProofRejected(
                f"faces: required names of 1 to 40 characters, each once, received {shown(name)}"
            )
        if sum((e * e for e in normal), fmpq(0)) == 0:
            raise ProofRejected(f"faces: required a normal that is not 0 for {shown(name)}")
        out[name] = Face(normal, number(row, "offset_m", -1e12, 1e12), frame_of(row, "faces"))
    return out


def thrust_of(said: Any) -> Thrust:
    """The set of thrusts; raises :class:`ProofRejected`."""
    kind = part(said, "kind", str)
    names: tuple[str, ...] = ("kind", "a_max_m_s2")
    if kind in ("box", "thrusters"):
        names += ("frame",)
    if kind == "thrusters":
        names += ("directions",)
    elif kind not in ("ball", "box"):
        raise ProofRejected(f"thrust: required ball, box or thrusters, received {shown(kind)}")
    fields(said, "thrust", names)
    rows = part(said, "directions", list) if kind == "thrusters" else []
    if len(rows) > _MOST_THRUSTERS:
        raise ProofRejected(f"directions: required at most {_MOST_THRUSTERS}, received {len(rows)}")
    directions = [vector(row, "directions", 3) for row in rows]
    if any(sum((e * e for e in row), fmpq(0)) == 0 for row in directions):
        raise ProofRejected("directions: required vectors that are not 0")
    size = {"ball": 1, "box": 3}.get(kind, len(directions))
    given = part(said, "a_max_m_s2", list)
    if len(given) != size:
        raise ProofRejected(f"a_max_m_s2: required {size} numbers, received {len(given)}")
    bounds = [exact(value, "a_max_m_s2", 0.0, 1e3) for value in given]
    return Thrust(kind, bounds, directions, "lvlh" if kind == "ball" else frame_of(said, "thrust"))


def attitude_of(said: Any, horizon: fmpq) -> Attitude:
    """The attitude up to ``horizon`` s; raises :class:`ProofRejected`."""
    kind = part(said, "kind", str)
    zero = fmpq(0)
    if kind == "spin":
        fields(said, "attitude", ("kind", "axis", "axis_frame", "rate_rad_s", "phase_rad"))
        axis = vector(said["axis"], "axis", 3)
        if sum((e * e for e in axis), zero) == 0:
            raise ProofRejected("axis: required a vector that is not 0")
        rate, phase = number(said, "rate_rad_s", -10.0, 10.0), number(said, "phase_rad", -1e7, 1e7)
        return Attitude(kind, _inertial(said, "axis_frame"), axis, rate, phase, [], [], [], [])
    if kind == "torque_free":
        fields(said, "attitude", ("kind", "inertia_kg_m2", "attitude_wxyz", "body_rate_rad_s", "reference"))
        if not _inertial(said, "reference"):
            raise ProofRejected("reference: required inertial, received lvlh")
        rows = part(said, "inertia_kg_m2", list)
        if len(rows) != 3:
            raise ProofRejected("inertia_kg_m2: required three rows")
        inertia = [
            [exact(e, "inertia_kg_m2", -1e13, 1e13) for e in part({"row": r}, "row", list)] for r in rows
        ]
        _is_body(inertia)
        rate_vector = vector(said["body_rate_rad_s"], "body_rate_rad_s", 3)
        if sum((e * e for e in rate_vector), zero) > 100:
            raise ProofRejected("body_rate_rad_s: required at most 10 rad/s")
        quaternions = [_quaternion(said["attitude_wxyz"])]
        return Attitude(kind, True, [], zero, zero, inertia, rate_vector, [], quaternions)
    if kind != "table":
        raise ProofRejected(f"attitude: required spin, torque_free or table, received {shown(kind)}")
    fields(said, "attitude", ("kind", "times_s", "attitude_wxyz", "reference"))
    times = [exact(t, "times_s", -LARGEST) for t in part(said, "times_s", list)]
    quaternions = [_quaternion(entry) for entry in part(said, "attitude_wxyz", list)]
    rising = all(a < b for a, b in pairwise(times))
    if not 2 <= len(times) == len(quaternions) or not rising or times[0] > 0 or times[-1] < horizon:
        raise ProofRejected(
            "times_s: required rising times from 0 or before to the end, and as many quaternions"
        )
    for a, b in pairwise(quaternions):
        # At most 90 degrees: cos^2 of half of it is 1/2.
        along = sum((p * q for p, q in zip(a, b, strict=True)), zero)
        sizes = sum((e * e for e in a), zero) * sum((e * e for e in b), zero)
        if 2 * along * along < sizes * fmpq(999_999, 1_000_000):
            raise ProofRejected("attitude_wxyz: required at most 90 degrees between two entries")
    return Attitude(kind, _inertial(said, "reference"), [], zero, zero, [], [], times, quaternions)


def _inertial(said: Any, key: str) -> bool:
    reference = part(said, key, str)
    if reference not in ("inertial", "lvlh"):
        raise ProofRejected(f"{key}: required inertial or lvlh, received {shown(reference)}")
    return bool(reference == "inertial")


def _quaternion(value: Any) -> list[fmpq]:
    q = vector(value, "attitude_wxyz", 4)
    if sum((e * e for e in q), fmpq(0)) == 0:
        raise ProofRejected("attitude_wxyz: required four numbers, not all 0")
    return q


def _is_body(inertia: list[list[fmpq]]) -> None:
    """Symmetric and positive: what else it is does not matter to the equations."""
    if any(len(row) != 3 for row in inertia) or any(
        inertia[i][j] != inertia[j][i] for i in range(3) for j in range(i)
    ):
        raise ProofRejected("inertia_kg_m2: required a symmetric tensor of three rows")
    (a, b, c), (_, d, e), (_, _, f) = inertia
    minors = (a, a * d - b * b, a * (d * f - e * e) - b * (b * f - e * c) + c * (b * e - d * c))
    if not all(minor > 0 for minor in minors):
        raise ProofRejected("inertia_kg_m2: required a positive tensor")
