"""Random questions in space, and an independent answer: an integrator and a dense linear program."""

from __future__ import annotations

import math
import time
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation, Slerp

from safestart.attitude.in_lvlh import InLvlh, torque_free
from safestart.attitude.quaternion import quaternion_of
from safestart.attitude.spin import Spin
from safestart.attitude.table import Table
from safestart.attitude.turning import SmoothAttitude
from safestart.constraints.thrust_limit import ThrustLimit
from safestart.exact.space.question import Face, SpaceQuestion, five_faces, starts_in_lvlh
from safestart.model.orbit import MU, KeplerOrbit
from safestart.model.scenario import CorridorShape

ATTITUDES, THRUSTS = ("torque_free", "spin", "inertial_spin", "table"), ("ball", "box", "thrusters")


def drawn(seed: int, steps: int = 20) -> tuple[SpaceQuestion, np.ndarray]:
    """A question and a start (6,) near the limit of feasibility."""
    rng = np.random.default_rng([15, seed])
    orbit = KeplerOrbit(1.1e-3)
    if rng.random() < 0.6:
        e = rng.uniform(0.0, 0.8)
        orbit = KeplerOrbit.of(rng.uniform(6.6e6, 9e6) / (1.0 - e), e, rng.uniform(-3.1, 3.1))
    attitude = _attitude(ATTITUDES[int(rng.integers(4))], rng, orbit)
    thrust = _thrust(THRUSTS[int(rng.integers(3))], rng)
    axis = rng.normal(size=3) if rng.random() < 0.5 else np.array([0.0, 1.0, 0.0])
    axis /= np.linalg.norm(axis)
    faces = five_faces(CorridorShape(), tuple(axis.tolist()))
    if rng.random() < 0.4:
        # A berthing box or cone in LVLH as well.
        normals = rng.normal(size=(3, 3))
        faces += tuple(
            Face(
                f"lvlh_{k}",
                tuple(normal.tolist()),
                float(np.linalg.norm(normal) * rng.uniform(30.0, 80.0)),
                "lvlh",
            )
            for k, normal in enumerate(normals)
        )
    question = SpaceQuestion(orbit, attitude, faces, thrust, 2.0, steps)
    across = np.linalg.qr(np.column_stack([axis, rng.normal(size=(3, 2))]))[0][:, 1:]
    away = rng.uniform(3.0, 45.0)
    position = away * axis + across @ rng.uniform(-0.8, 0.8, 2) * away
    velocity = rng.normal(size=3) * 0.5
    return question, starts_in_lvlh(attitude, position[None], velocity[None])[0]


def torque_free_case(seed: int) -> tuple[SpaceQuestion, np.ndarray]:
    """A torque-free body on a circular orbit, the paper's faces, a ball of thrusts, 60 s."""
    rng = np.random.default_rng([16, seed])
    orbit = KeplerOrbit(1.1e-3)
    attitude = _attitude("torque_free", rng, orbit)
    thrust = ThrustLimit("ball", (float(rng.uniform(0.02, 0.1)),))
    question = SpaceQuestion(orbit, attitude, five_faces(CorridorShape()), thrust)
    y = rng.uniform(5.0, 100.0)
    position = np.array([rng.uniform(-1.0, 1.0) * y, y, rng.uniform(-1.0, 1.0) * y])
    return question, starts_in_lvlh(attitude, position[None], np.zeros((1, 3)))[0]


def _attitude(kind: str, rng: np.random.Generator, orbit: KeplerOrbit) -> SmoothAttitude:
    axis, rate = tuple(rng.normal(size=3).tolist()), float(rng.uniform(-0.09, 0.09))
    if kind == "spin":
        return Spin(rate, axis, float(rng.uniform(-3.0, 3.0)))
    if kind == "inertial_spin":
        return InLvlh(Spin(rate, axis, float(rng.uniform(-3.0, 3.0))), orbit)
    shares = rng.uniform(0.2, 1.0, 3)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    inertia = turn @ np.diag(shares.sum() - shares) @ turn.T * 1000.0
    inertia = 0.5 * (inertia + inertia.T)
    free = torque_free(
        tuple(map(tuple, inertia.tolist())),
        tuple(rng.normal(size=4).tolist()),
        tuple((rng.normal(size=3) * 0.045).tolist()),
        "inertial",
        orbit,
    )
    if kind == "torque_free":
        return free
    at = np.arange(0.0, 75.0, 7.3)
    return Table(tuple(at.tolist()), tuple(_quaternions(free.rotation(at))))


def _quaternions(matrices: np.ndarray) -> Any:
    return [tuple(quaternion_of(matrix).tolist()) for matrix in matrices]


def _thrust(kind: str, rng: np.random.Generator) -> ThrustLimit:
    frame = "body" if rng.random() < 0.5 else "lvlh"
    if kind == "ball":
        return ThrustLimit("ball", (float(rng.uniform(0.01, 0.1)),))
    if kind == "box":
        return ThrustLimit("box", tuple(rng.uniform(0.005, 0.08, 3).tolist()), frame=frame)
    count = int(rng.integers(4, 9))
    directions = tuple(tuple(e) for e in rng.normal(size=(count, 3)).tolist())
    return ThrustLimit("thrusters", tuple(rng.uniform(0.02, 0.12, count).tolist()), directions, frame)


def transitions(question: SpaceQuestion, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Phi(t, 0) (T, 6, 6) by DOP853 from the equations of motion, and nu(t) - nu(0)."""
    orbit = question.orbit
    e, n = orbit.eccentricity, orbit.mean_motion
    a = (MU / n**2) ** (1.0 / 3.0)
    p = a * (1.0 - e * e)
    h = math.sqrt(MU * p)

    def rates(_: float, y: np.ndarray) -> np.ndarray:
        r = p / (1.0 + e * math.cos(y[0]))
        w, g = h / r**2, MU / r**3
        change = -2.0 * w * MU / h * e * math.sin(y[0]) / r
        m = np.zeros((6, 6))
        m[:3, 3:] = np.eye(3)
        m[3, 0], m[3, 1], m[3, 4] = w * w + 2.0 * g, change, 2.0 * w
        m[4, 0], m[4, 1], m[4, 3], m[5, 2] = -change, w * w - g, -2.0 * w, -g
        return np.concatenate([[w], (m @ y[1:].reshape(6, 6)).ravel()])

    begin = np.concatenate([[orbit.true_anomaly], np.eye(6).ravel()])
    found = solve_ivp(rates, (0.0, times[-1]), begin, "DOP853", times, rtol=1e-12, atol=1e-14)
    return found.y[1:].T.reshape(-1, 6, 6), found.y[0] - orbit.true_anomaly


def dense_margin(
    question: SpaceQuestion, state: np.ndarray, checks: int = 8, times_s: list[float] | None = None
) -> tuple[float, ...]:
    """Margins with thrusts from inside and from outside the set (equal but for a ball), ``checks`` times a step.

    ``times_s`` takes the seconds of each solve. The input's matrix is the integral of Phi(t, s) by Simpson's rule over
    the integrated transitions.
    """
    dt, steps = question.dt, question.steps
    fine = 2 * checks
    times = np.linspace(0.0, dt * steps, steps * fine + 1)
    phi, angle = transitions(question, times)
    inverse = np.linalg.inv(phi)[:, :, 3:]
    width = dt / fine
    pieces = np.zeros((steps, checks + 1, 6, 3))
    for k in range(steps):
        part = inverse[k * fine : (k + 1) * fine + 1]
        for c in range(checks):
            a, b, d = part[2 * c], part[2 * c + 1], part[2 * c + 2]
            pieces[k, c + 1] = pieces[k, c] + width / 3.0 * (a + 4.0 * b + d)
    vertices, facets = _directions(question)
    rows, offsets = [], []
    seen = turns(question, times[::2], angle[::2])
    for i in range(steps * checks + 1):
        moved = phi[2 * i][:3]
        k = min(i // checks, steps - 1)
        push = np.zeros((3, steps, 3))
        for j in range(k):
            push[:, j] = moved @ pieces[j, checks]
        push[:, k] = moved @ pieces[k, i - k * checks]
        for face in question.faces:
            normal = np.array(face.normal) / np.linalg.norm(face.normal)
            if face.frame == "body":
                normal = seen[i].T @ normal
            rows.append(normal @ push.reshape(3, -1))
            offsets.append(face.offset / np.linalg.norm(face.normal) - normal @ moved @ state)
    return tuple(
        _program(np.array(rows), np.array(offsets), question, cone, seen[::checks], times_s)
        for cone in (vertices, facets)[: 1 + (question.thrust.kind == "ball")]
    )


def turns(question: SpaceQuestion, times: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """C(t) (T, 3, 3) from LVLH to the body by SciPy: Rotation, Slerp, Euler's equations integrated.

    ``angle`` (T,) is what LVLH has turned.
    """
    attitude: Any = question.attitude
    inner = attitude.inertial if isinstance(attitude, InLvlh) else attitude
    if isinstance(inner, Spin):
        vectors = (inner.phase + inner.rate * times)[:, None] * np.array(inner.axis)
        found = Rotation.from_rotvec(vectors).inv().as_matrix()
    elif isinstance(inner, Table):
        entries = Rotation.from_quat(np.roll(np.array(inner.quaternions), -1, axis=1))
        found = Slerp(inner.times, entries)(times).inv().as_matrix()
    else:
        inertia = np.array(inner.inertia)
        first = Rotation.from_quat(np.roll(np.array(inner.attitude), -1)).inv().as_matrix()

        def rates(_: float, y: np.ndarray) -> np.ndarray:
            w = y[:3]
            change = np.linalg.solve(inertia, np.cross(inertia @ w, w))
            return np.concatenate([change, -np.cross(w, y[3:].reshape(3, 3), axisb=0, axisc=0).ravel()])

        begin = np.concatenate([inner.body_rate, first.ravel()])
        path = solve_ivp(rates, (0.0, times[-1]), begin, "DOP853", times, rtol=1e-11, atol=1e-12)
        found = path.y[3:].T.reshape(-1, 3, 3)
    if isinstance(attitude, InLvlh):
        found = found @ Rotation.from_rotvec(angle[:, None] * np.array([0.0, 0.0, 1.0])).as_matrix()
    return np.asarray(found)


def _directions(question: SpaceQuestion) -> tuple[Any, Any]:
    limit = question.thrust
    if limit.kind != "ball":
        return None, None
    count = 64
    points = np.arange(count) + 0.5
    polar, round_ = np.arccos(1.0 - 2.0 * points / count), math.pi * (1.0 + 5.0**0.5) * points
    sphere = np.column_stack([np.cos(round_) * np.sin(polar), np.sin(round_) * np.sin(polar), np.cos(polar)])
    # Every direction has a cosine of at least 0.9423 with one of the 64: so much of the polytope fits inside the ball.
    return (sphere, 0.942), (sphere, 1.0)


def _program(
    rows: np.ndarray,
    offsets: np.ndarray,
    question: SpaceQuestion,
    cone: Any,
    seen: np.ndarray,
    times_s: list[float] | None,
) -> float:
    """Maximise m with offsets - rows u >= m, by HiGHS."""
    steps, limit = question.steps, question.thrust
    if limit.kind == "ball":
        maps, more, bound = np.broadcast_to(np.eye(3), (steps, 3, 3)), cone[0], cone[1] * limit.a_max[0]
        bounds: Any = [(-limit.a_max[0], limit.a_max[0])] * (3 * steps)
    else:
        own = np.array(limit.directions).T if limit.kind == "thrusters" else np.eye(3)
        own = own / np.linalg.norm(own, axis=0) * np.array(limit.a_max)
        maps = np.array([turn.T @ own if limit.frame == "body" else own for turn in seen[:steps]])
        count = own.shape[1]
        more, bound = (np.ones((1, count)), 1.0) if limit.kind == "thrusters" else (np.zeros((0, count)), 1.0)
        bounds = [(0.0, 1.0) if limit.kind == "thrusters" else (-1.0, 1.0)] * (count * steps)
    count = maps.shape[2]
    through = np.einsum("rka,kab->rkb", rows.reshape(len(rows), steps, 3), maps).reshape(len(rows), -1)
    top = np.column_stack([through, np.ones(len(rows))])
    extra = np.column_stack([np.kron(np.eye(steps), more), np.zeros(steps * len(more))])
    begin = time.process_time()
    found = linprog(
        np.concatenate([np.zeros(count * steps), [-1.0]]),
        np.concatenate([top, extra]),
        np.concatenate([offsets, np.full(steps * len(more), bound)]),
        bounds=[*bounds, (None, None)],
        method="highs",
    )
    if times_s is not None:
        times_s.append(time.process_time() - begin)
    return -float(found.fun)
