"""Whether a printed claim in space is true: its document's history flown, and cone programs against a NO_GO."""

from __future__ import annotations

import math
from dataclasses import replace
from random import Random
from typing import Any, Literal

import clarabel
import numpy as np

from tests.fuzzing.cone import largest
from tests.fuzzing.space.flown import (
    NONE,
    admissible,
    attitude,
    least,
    members,
    motion_of,
    name_of,
    states,
    unit_thrusts,
)
from tests.fuzzing.space.printed import SpacePrinted, vector

Truth = Literal["true", "false", "open"]
_TOLERANCE = 2e-6
_MEMBERS = 12


def truth_in_space(claim: SpacePrinted, document: Any, rng: Random) -> Truth:
    """ "true" means: nothing was found against it; "open": the program has no answer."""
    if (claim.margin > 0.0) is not (claim.verdict == "GO"):
        return "false"
    return _go(claim, document, rng) if claim.verdict == "GO" else _no_go(claim)


def _slack(claim: SpacePrinted) -> float:
    far = np.linalg.norm(claim.start[:3]) + claim.dt * claim.steps * np.linalg.norm(claim.start[3:])
    return _TOLERANCE * (1.0 + 1e-3 * float(far) + abs(claim.margin))


def _go(claim: SpacePrinted, document: Any, rng: Random) -> Truth:
    history = np.array(document["thrust_m_s2" if "ball" in claim.said else "throttle"], dtype=np.float64)
    if not claim.first <= len(history) <= claim.steps or not admissible(claim, history):
        return "false"
    plain, _ = attitude(claim, NONE)
    pushes = [m @ u for m, u in zip(unit_thrusts(claim, plain), history, strict=False)]
    for member in members(claim, rng, _MEMBERS):
        turns, rates = attitude(claim, member)
        flown = states(claim, pushes, member)
        if least(claim, flown, turns, rates, pushes) < claim.margin - _slack(claim):
            return "false"
    return "true"


def _no_go(claim: SpacePrinted) -> Truth:
    turns, rates = attitude(claim, NONE)
    if "violated" in claim.said:
        return "true" if _start_margin(claim, turns) <= claim.margin + _slack(claim) else "false"
    for end in range(claim.first, claim.steps + 1):
        found = _best(claim, turns, rates, end)
        if found is None:
            return "open"
        history, moved = found
        pushes = [m @ u for m, u in zip(unit_thrusts(claim, turns), history, strict=False)]
        member = replace(NONE, offset=moved)
        kept = least(claim, states(claim, pushes, member), turns, rates, pushes)
        # Between samples h apart a distance falls by h^2 / 8 of its curvature at most.
        if kept - _between(claim, turns) > claim.margin + _slack(claim):
            return "false"
    return "true"


def _between(claim: SpacePrinted, turns: Any) -> float:
    _, phi, _, _ = motion_of(claim)
    h = claim.dt / (phi.shape[1] - 1)
    spin = float(np.linalg.norm(turns[:, 1:] - turns[:, :-1], axis=(-2, -1)).max()) / h
    far = float(np.linalg.norm(claim.start[:3])) + claim.dt * claim.steps * (
        float(np.linalg.norm(claim.start[3:])) + 1.0
    )
    return h * h / 8.0 * (spin**2 * far + 2.0 * spin * (float(np.linalg.norm(claim.start[3:])) + 1.0) + 1.0)


def _start_margin(claim: SpacePrinted, turns: Any) -> float:
    name, at = name_of(claim.said["violated"]["name"]), claim.start[:3]
    seen = {"LVLH": at, "the body frame": turns[0, 0] @ at}
    for ball in claim.said["sphere"]:
        if name_of(ball["name"]) == name:
            away = np.linalg.norm(seen[ball["frame"]] - vector(ball["centre"]))
            return float(away - float(ball["radius"]))
    for box in claim.said["box"]:
        if name_of(box["name"]) == name:
            return float((abs(seen[box["frame"]] - vector(box["centre"])) - vector(box["half"])).max())
    view = claim.said["view"]
    assert name == "field_of_view"
    axis, sight = vector(view["axis"]), vector(view["point"]) - seen[view["frame"]]
    along = float(sight @ axis / np.linalg.norm(axis))
    across = math.sqrt(max(float(sight @ sight) - along**2, 0.0))
    angle = float(view["angle"])
    return along * math.sin(angle) - across * math.cos(angle)


def _best(claim: SpacePrinted, turns: Any, rates: Any, end: int) -> tuple[Any, Any] | None:
    """History (end, channels) and the start's offset (6,) with the largest margin at the samples."""
    said = claim.said
    _, phi, held, _ = motion_of(claim)
    units = unit_thrusts(claim, turns)
    channels = units[0].shape[1]
    size = end * channels
    carry, drive = np.eye(6), np.zeros((6, size))
    free, driven = [], []
    for k in range(end):
        for j in range(0 if k == 0 else 1, phi.shape[1]):
            free.append(phi[k, j] @ carry)
            now = phi[k, j] @ drive
            now[:, k * channels : (k + 1) * channels] += held[k, j] @ units[k]
            driven.append(now)
        carry, drive = free[-1], driven[-1]
    free, driven = np.array(free), np.array(driven)
    seen = np.concatenate([turns[0, :1], *(turns[k, 1:] for k in range(end))])
    wide = np.nonzero(claim.half)[0]
    columns = size + len(wide) + 1
    shift = claim.half[wide]
    left, right = [], []
    for face in said["face"]:
        normal = vector(face["normal"]) / np.linalg.norm(vector(face["normal"]))
        along = (
            seen.transpose(0, 2, 1) @ normal if face["frame"] != "LVLH" else np.tile(normal, (len(seen), 1))
        )
        a = np.einsum("ki,kij->kj", along, driven[:, :3])
        s = np.einsum("ki,kij->kj", along, free[:, :3])
        left.append(np.hstack([a, s[:, wide] * shift, np.ones((len(a), 1))]))
        right.append(float(face["offset"]) / np.linalg.norm(vector(face["normal"])) - s @ claim.start)
    rows = 0
    if len(wide):
        unit = np.zeros((2 * len(wide), columns))
        unit[: len(wide), size:-1], unit[len(wide) :, size:-1] = np.eye(len(wide)), -np.eye(len(wide))
        left.append(unit)
        right.append(np.ones(2 * len(wide)))
    if "cube" in said:
        unit = np.zeros((2 * size, columns))
        unit[:size, :size], unit[size:, :size] = np.eye(size), -np.eye(size)
        left.append(unit)
        right.append(np.ones(2 * size))
    if "thrusters" in said:
        unit = np.zeros((size + end, columns))
        unit[:size, :size] = -np.eye(size)
        for k in range(end):
            unit[size + k, k * channels : (k + 1) * channels] = 1.0
        left.append(unit)
        right.append(np.r_[np.zeros(size), np.ones(end)])
    rows = sum(len(block) for block in left)
    cones: list[Any] = [clarabel.NonnegativeConeT(rows)]

    def norm(limit: float, scale: float, f: Any, g: Any, offset: Any) -> None:
        """m <= limit - scale |f x0 + g u - offset|."""
        block = np.zeros((4, columns))
        block[0, -1] = 1.0
        block[1:, :size], block[1:, size:-1] = -scale * g, -scale * f[:, wide] * shift
        left.append(block)
        right.append(np.r_[limit, scale * (f @ claim.start - offset)])
        cones.append(clarabel.SecondOrderConeT(4))

    zero = np.zeros(3)
    if "speed" in said:
        scale, most = float(said["speed"]["scale"]), float(said["speed"]["most"])
        for f, g in zip(free, driven, strict=True):
            norm(scale * most, scale, f[3:], g[3:], zero)
    if "end" in said:
        radius, rest = float(said["end"]["radius"]), float(said["end"]["rest"])
        f, g, c, w = free[-1], driven[-1], seen[-1], rates[end - 1, -1]
        norm(radius, 1.0, c @ f[:3], c @ g[:3], vector(said["end"]["hold"]))
        spin = np.array([[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]])
        norm(radius, radius / rest, c @ f[3:] - spin @ c @ f[:3], c @ g[3:] - spin @ c @ g[:3], zero)
    bound = 1.0
    if "ball" in said:
        bound = float(said["ball"]["bound"])
        for k in range(end):
            block = np.zeros((4, columns))
            block[1:, k * 3 : k * 3 + 3] = -np.eye(3)
            left.append(block)
            right.append(np.r_[1.0, zero])
            cones.append(clarabel.SecondOrderConeT(4))
    a, b = np.vstack(left), np.concatenate(right)
    if "ball" in said:
        a[: len(a) - 4 * end, :size] *= bound
    found, well = largest(a, b, cones)
    if not well:
        return None
    x = np.array(found.x)
    u = x[:size].reshape(end, channels)
    if "ball" in said:
        u = bound * u / np.maximum(1.0, np.linalg.norm(u, axis=1))[:, None]
    elif "cube" in said:
        u = np.clip(u, -1.0, 1.0)
    else:
        u = np.maximum(u, 0.0)
        u /= np.maximum(1.0, u.sum(axis=1))[:, None]
    moved = np.zeros(6)
    moved[wide] = np.clip(x[size:-1], -1.0, 1.0)
    return u, moved
