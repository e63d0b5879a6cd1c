"""A thrust history flown by SciPy for one member of a printed statement in space; no code of the product.

Motion by DOP853 from the equations of LVLH on a Kepler orbit, attitudes by Rodrigues' turns, by Euler's equations, by
SciPy's slerp.
"""

from __future__ import annotations

import ast
import itertools
import math
from dataclasses import dataclass
from functools import lru_cache
from random import Random
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.spatial.transform import Rotation, Slerp

from tests.fuzzing.space.printed import SpacePrinted, vector

SAMPLES = 48
"""Of each step."""


@dataclass(frozen=True, slots=True)
class Member:
    """What differs from the statement: a turn (3,) of the body at t = 0 and a rate (3,), shares (3,) of the moments, a
    push (3,) that changes its sign at ``switch`` s, an offset (6,) of the start in half-widths."""

    turn: Any
    rate: Any
    shares: Any
    push: Any
    switch: float
    offset: Any


NONE = Member(np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3), math.inf, np.zeros(6))


def members(claim: SpacePrinted, rng: Random, number: int) -> list[Member]:
    """The statement's own member and some at the edges of what is not known."""
    said, gen = claim.said, np.random.default_rng(rng.randrange(2**32))

    def edge(key: str, name: str) -> Any:
        size = float(said[key][name]) if key in said else 0.0
        unit = gen.normal(size=3)
        return unit * size / np.linalg.norm(unit)

    wide = np.nonzero(claim.half)[0]
    corners = [np.zeros(6)]
    for signs in itertools.product((-1.0, 1.0), repeat=len(wide)):
        corner = np.zeros(6)
        corner[wide] = signs
        corners.append(corner)
    out = [NONE]
    if len(corners) == 2 and "members" not in said:
        return out
    for _ in range(number):
        share = float(said["u_inertia"]["share"]) if "u_inertia" in said else 0.0
        out.append(
            Member(
                edge("u_angle", "angle"),
                edge("u_rate", "rate"),
                share * gen.choice([-1.0, 1.0], 3),
                edge("u_push", "push"),
                gen.choice([math.inf, gen.uniform(0.0, claim.dt * claim.steps)]),
                rng.choice(corners),
            )
        )
    return out


@lru_cache(maxsize=64)
def motion(n: float, e: float, nu: float, dt: float, steps: int) -> tuple[Any, Any, Any, Any]:
    """Times (steps, S), Phi (steps, S, 6, 6) from each step's begin, held input (.., 6, 3), nu - nu(0) and its rate."""
    local = np.linspace(0.0, dt, SAMPLES + 1)
    phi, held = np.empty((steps, SAMPLES + 1, 6, 6)), np.empty((steps, SAMPLES + 1, 6, 3))
    angles = np.empty((steps, SAMPLES + 1, 2))
    k2 = n / (1.0 - e * e) ** 1.5
    if e == 0.0:
        a = np.zeros((9, 9))
        a[:3, 3:6] = np.eye(3)
        a[3, 0], a[3, 4], a[4, 3], a[5, 2] = 3.0 * n * n, 2.0 * n, -2.0 * n, -n * n
        a[3:6, 6:] = np.eye(3)
        one, whole = expm(a * dt / SAMPLES), [np.eye(9)]
        for _ in range(SAMPLES):
            whole.append(one @ whole[-1])
        phi[:], held[:] = np.array(whole)[:, :6, :6], np.array(whole)[:, :6, 6:]
        angles[..., 0], angles[..., 1] = n * (dt * np.arange(steps)[:, None] + local), n
        return dt * np.arange(steps)[:, None] + local, phi, held, angles

    def rates(_: float, y: Any) -> Any:
        rho = 1.0 + e * math.cos(y[0])
        w, g = k2 * rho * rho, k2 * k2 * rho**3
        change = -2.0 * k2 * rho * e * math.sin(y[0]) * w
        x = y[1:].reshape(6, 9)
        out = np.empty((6, 9))
        out[:3] = x[3:]
        out[3] = 2.0 * w * x[4] + change * x[1] + (w * w + 2.0 * g) * x[0]
        out[4] = -2.0 * w * x[3] - change * x[0] + (w * w - g) * x[1]
        out[5] = -g * x[2]
        out[3:, 6:] += np.eye(3)
        return np.concatenate([[w], out.ravel()])

    at = nu
    for k in range(steps):
        begin = np.concatenate([[at], np.hstack([np.eye(6), np.zeros((6, 3))]).ravel()])
        found = solve_ivp(rates, (0.0, dt), begin, "DOP853", local, rtol=1e-12, atol=1e-14).y.T
        whole = found[:, 1:].reshape(-1, 6, 9)
        phi[k], held[k] = whole[:, :, :6], whole[:, :, 6:]
        angles[k, :, 0] = found[:, 0] - nu
        angles[k, :, 1] = k2 * (1.0 + e * np.cos(found[:, 0])) ** 2
        at = found[-1, 0]
    return dt * np.arange(steps)[:, None] + local, phi, held, angles


def motion_of(claim: SpacePrinted) -> tuple[Any, Any, Any, Any]:
    orbit = claim.said["orbit"]
    return motion(float(orbit["n"]), float(orbit["e"]), float(orbit["nu"]), claim.dt, claim.steps)


def attitude(claim: SpacePrinted, member: Member) -> tuple[Any, Any]:
    """C (steps, S, 3, 3) from LVLH to the body, and the body's rate against LVLH in body axes (steps, S, 3)."""
    said = claim.said
    times, _, _, angles = motion_of(claim)
    flat = times.ravel()
    first = Rotation.from_rotvec(-member.turn).as_matrix()
    if "spin" in said:
        axis = vector(said["spin"]["axis"])
        axis /= np.linalg.norm(axis)
        w = float(said["spin"]["rate"]) * axis + member.rate
        start = first @ Rotation.from_rotvec(-float(said["spin"]["phase"]) * axis).as_matrix()
        own = Rotation.from_rotvec(-flat[:, None] * w).as_matrix() @ start
        rate = np.broadcast_to(w, (len(flat), 3))
        seen = said["spin"]["seen"] != "LVLH"
    elif "table" in said:
        own, rate = _tabulated(said["entry"], flat, member, first)
        seen = said["table"]["seen"] != "LVLH"
    else:
        own, rate = _free(said, flat, member, first)
        seen = True
    own = own.reshape(*times.shape, 3, 3)
    if seen:
        c, s = np.cos(angles[..., 0]), np.sin(angles[..., 0])
        back = np.zeros((*times.shape, 3, 3))
        # LVLH axes turned by the angle: inertial = R^T lvlh.
        back[..., 0, 0] = back[..., 1, 1] = c
        back[..., 0, 1], back[..., 1, 0], back[..., 2, 2] = -s, s, 1.0
        own = own @ back
    rate = rate.reshape(*times.shape, 3)
    if seen:
        rate = rate - angles[..., 1, None] * own[..., :, 2]
    return own, rate


def _tabulated(said: Any, flat: Any, member: Member, first: Any) -> tuple[Any, Any]:
    knots = np.array([float(one["time"]) for one in said])
    quaternions = np.array([vector(one["q"]) for one in said])
    active = Rotation.from_quat(quaternions[:, [1, 2, 3, 0]])
    plain = Slerp(knots, active)(np.clip(flat, knots[0], knots[-1])).as_matrix().transpose(0, 2, 1)
    turns = (active[:-1].inv() * active[1:]).as_rotvec() / np.diff(knots)[:, None]
    # The rate of the piece that ends at a knot.
    piece = np.clip(np.searchsorted(knots, flat, side="left") - 1, 0, len(turns) - 1)
    if not np.any(member.rate) and not np.any(member.turn):
        return plain, turns[piece]
    out, at, now = np.empty((len(flat), 3, 3)), 0.0, first @ plain[0]
    marks = sorted({*knots[(knots > 0.0) & (knots < flat[-1])].tolist(), *flat.tolist()})
    seen = {0.0: now}
    for until in marks:
        if until <= at:
            continue
        k = int(np.clip(np.searchsorted(knots, 0.5 * (at + until), side="right") - 1, 0, len(turns) - 1))
        now = Rotation.from_rotvec(-(turns[k] + member.rate) * (until - at)).as_matrix() @ now
        seen[until] = now
        at = until
    for i, t in enumerate(flat.tolist()):
        out[i] = seen[t]
    return out, turns[piece] + member.rate


def _free(said: Any, flat: Any, member: Member, first: Any) -> tuple[Any, Any]:
    inertia = np.array([vector(row) for row in said["free"]["rows"].split("; ")])
    inertia = inertia + np.diag(np.diag(inertia) * member.shares)
    q = vector(said["free"]["q"])
    start = first @ Rotation.from_quat(q[[1, 2, 3, 0]]).as_matrix().T

    def rates(_: float, y: Any) -> Any:
        w, c = y[:3], y[3:].reshape(3, 3)
        return np.concatenate(
            [np.linalg.solve(inertia, np.cross(inertia @ w, w)), -np.cross(w, c, axisb=0, axisc=0).ravel()]
        )

    begin = np.concatenate([vector(said["turning"]["w"]) + member.rate, start.ravel()])
    ordered, index = np.unique(flat, return_inverse=True)
    found = solve_ivp(rates, (0.0, ordered[-1]), begin, "DOP853", ordered, rtol=1e-11, atol=1e-13).y.T[index]
    return found[:, 3:].reshape(-1, 3, 3), found[:, :3]


def unit_thrusts(claim: SpacePrinted, turns: Any) -> list[Any]:
    """For each step the matrix (3, channels) from the numbers of a document's history to LVLH, m/s^2."""
    said = claim.said
    if "ball" in said:
        return [np.eye(3)] * claim.steps
    if "cube" in said:
        own, body = np.diag(vector(said["cube"]["bounds"])), said["cube"]["frame"] != "LVLH"
    else:
        arms = [one.split(" along ") for one in said["thrusters"]["arms"].split("; ")]
        columns = [float(bound) * vector(along) / np.linalg.norm(vector(along)) for bound, along in arms]
        own, body = np.array(columns).T.reshape(3, len(arms)), said["thrusters"]["frame"] != "LVLH"
    return [turns[k, 0].T @ own if body else own for k in range(claim.steps)]


def admissible(claim: SpacePrinted, history: Any) -> bool:
    tiny = 1e-12
    if "ball" in claim.said:
        return bool(
            (np.linalg.norm(history, axis=1) <= float(claim.said["ball"]["bound"]) * (1 + tiny)).all()
        )
    if "cube" in claim.said:
        return bool((abs(history) <= 1 + tiny).all())
    return bool((history >= 0.0).all() and (history.sum(axis=1) <= 1 + tiny).all())


def states(claim: SpacePrinted, pushes: Any, member: Member) -> Any:
    """(end, S, 6) under thrusts (end, 3), LVLH."""
    times, phi, held, _ = motion_of(claim)
    now, out = claim.start + member.offset * claim.half, []
    for k, push in enumerate(pushes):
        # A push that changes its sign within a step is taken as that at the step's begin.
        more = member.push * (1.0 if times[k, 0] < member.switch else -1.0)
        flown = phi[k] @ now + held[k] @ (push + more)
        out.append(flown)
        now = flown[-1]
    return np.array(out)


def least(claim: SpacePrinted, flown: Any, turns: Any, rates: Any, pushes: Any) -> float:
    """The least of all margins of a flight (end, S, 6) at its samples; -inf where the plume rule is broken."""
    said, end = claim.said, len(flown)
    turns, place = turns[:end], flown[..., :3]
    body = np.einsum("ksij,ksj->ksi", turns, place)
    seen = {"LVLH": place, "the body frame": body}
    out = []
    for face in said["face"]:
        normal = vector(face["normal"])
        out.append(((float(face["offset"]) - seen[face["frame"]] @ normal) / np.linalg.norm(normal)).min())
    if "speed" in said:
        fast = np.linalg.norm(flown[..., 3:], axis=-1).max()
        out.append(float(said["speed"]["scale"]) * (float(said["speed"]["most"]) - fast))
    if "end" in said:
        radius, rest = float(said["end"]["radius"]), float(said["end"]["rest"])
        out.append(radius - np.linalg.norm(body[-1, -1] - vector(said["end"]["hold"])))
        speed = turns[-1, -1] @ flown[-1, -1, 3:] - np.cross(rates[end - 1, -1], body[-1, -1])
        out.append(radius / rest * (rest - np.linalg.norm(speed)))
    for ball in said["sphere"]:
        away = np.linalg.norm(seen[ball["frame"]] - vector(ball["centre"]), axis=-1)
        out.append((away - float(ball["radius"])).min())
    for box in said["box"]:
        away = abs(seen[box["frame"]] - vector(box["centre"])) - vector(box["half"])
        out.append(away.max(axis=-1).min())
    if "view" in said:
        out.append(_view(said["view"], seen).min())
    if "plume" in said and _blown(said["plume"], seen, pushes, turns):
        out.append(-math.inf)
    return float(min(out))


def _view(said: Any, seen: Any) -> Any:
    """Distance to the edge of the cone of places from which the point is seen."""
    axis = vector(said["axis"]) / np.linalg.norm(vector(said["axis"]))
    sight, angle = vector(said["point"]) - seen[said["frame"]], float(said["angle"])
    along = sight @ axis
    across = np.sqrt(np.maximum((sight**2).sum(axis=-1) - along**2, 0.0))
    return along * math.sin(angle) - across * math.cos(angle)


def _blown(said: Any, seen: Any, pushes: Any, turns: Any) -> bool:
    """Whether at a sample exhaust goes at the point, by more than rounding."""
    frame, angle = said["frame"], float(said["angle"])
    push = np.broadcast_to(np.asarray(pushes)[:, None], seen[frame].shape)
    if frame != "LVLH":
        push = np.einsum("ksij,ksj->ksi", turns[: len(push)], push)
    away = seen[frame] - vector(said["point"])
    far, size = np.linalg.norm(away, axis=-1), np.linalg.norm(push, axis=-1)
    with np.errstate(invalid="ignore", divide="ignore"):
        # The exhaust is -push, the direction to the point -away.
        cosine = (push * away).sum(axis=-1) / (far * size)
    return bool(((far < float(said["reach"]) - 1e-6) & (cosine > math.cos(angle) + 1e-9)).any())


def name_of(text: str) -> str:
    return str(ast.literal_eval(text))
