"""Random questions in space with an end, a speed limit or a box of starts, and an independent dense program.

The end is fixed. Norms are bounded from inside and outside by directions, so a question has two margins between which
the true one lies but for what fits between two checks.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import csr_matrix, hstack, kron, vstack

from benchmarks.peers.space_cases import drawn, transitions, turns
from safestart.exact.question import SPEED_SCALE, Goal
from safestart.exact.space.question import SpaceQuestion

CHECKS = 4
_COUNT = 150
KINDS = ("synchronize", "speed", "both", "box")


def wide(seed: int, steps: int = 16) -> tuple[SpaceQuestion, np.ndarray, np.ndarray]:
    """A question, a start (6,) and half-widths (6,), which are 0 but for a box."""
    question, state = drawn(seed, steps)
    rng = np.random.default_rng([17, seed])
    kind, half = KINDS[seed % len(KINDS)], np.zeros(6)
    if kind in ("synchronize", "both"):
        plane = question.faces[0]
        normal = -np.array(plane.normal)
        hold = tuple((normal * (-plane.offset + rng.uniform(5.0, 25.0)) / (normal @ normal)).tolist())
        goal = Goal(float(rng.uniform(0.5, 6.0)), float(rng.uniform(0.05, 1.0)), hold, steps)
        question = replace(question, goal=goal)
    if kind in ("speed", "both"):
        fast = float(np.linalg.norm(state[3:]))
        question = replace(question, speed_limit=fast * rng.uniform(0.9, 1.6) + 0.2)
    if kind == "box":
        half = np.concatenate([rng.uniform(0.0, 1.5, 3), rng.uniform(0.0, 0.1, 3)])
    return question, state, half


class Dense:
    """The rows of one question: ``margin`` (two bounds) and ``kept`` (what a history keeps at the checks).

    A history must suit every start of the box; with ``free`` the program chooses the start, too.
    """

    def __init__(
        self, question: SpaceQuestion, state: np.ndarray, half: np.ndarray, *, free: bool = False
    ) -> None:
        dt, steps, fine = question.dt, question.steps, 4 * CHECKS
        self.question = question
        times = np.linspace(0.0, dt * steps, steps * fine + 1)
        phi, angle = transitions(question, times)
        seen = turns(question, times, angle)
        inverse = np.linalg.inv(phi)[:, :, 3:]
        width = dt / fine
        # The integral of Phi(t, s) over an interval up to every second time, by Simpson's rule.
        moved = np.zeros((len(times), 6, steps, 3))
        for k in range(steps):
            part = inverse[k * fine : (k + 1) * fine + 1]
            piece = np.zeros((6, 3))
            for c in range(fine // 2):
                a, b, d = part[2 * c], part[2 * c + 1], part[2 * c + 2]
                piece = piece + width / 3.0 * (a + 4.0 * b + d)
                here = k * fine + 2 * c + 2
                moved[here:, :, k] = piece
        self.moved = np.einsum("tij,tjkl->tikl", phi, moved).reshape(len(times), 6, -1)
        self.free = phi @ state
        own = np.eye(3)
        limit = question.thrust
        if limit.kind == "thrusters":
            own = np.array(limit.directions).T
        if limit.kind != "ball":
            own = own / np.linalg.norm(own, axis=0) * np.array(limit.a_max)
        self.maps = np.array(
            [turn.T @ own if limit.frame == "body" else own for turn in seen[: steps * fine : fine]]
        )
        # Each row: offset + gain . u >= m.
        offsets, gains, moves = [], [], []
        for i in range(0, len(times), 4):
            for face in question.faces:
                normal = np.array(face.normal) / np.linalg.norm(face.normal)
                if face.frame == "body":
                    normal = seen[i].T @ normal
                along = normal @ phi[i][:3]
                taken = 0.0 if free else float(np.abs(along) @ half)
                moves.append(-along * half if free else np.zeros(6))
                offsets.append(face.offset / np.linalg.norm(face.normal) - along @ state - taken)
                gains.append(-normal @ self.moved[i][:3])
        self.offsets, self.gains, self.moves = np.array(offsets), np.array(gains), np.array(moves)
        # Norms: limit - |at + gain u|.
        self.norms: list[tuple[float, np.ndarray, np.ndarray]] = []
        goal = question.goal
        if goal is not None:
            hold = seen[-1] @ np.column_stack([self.free[-1][:3], self.moved[-1][:3]])
            self.norms.append((goal.radius, hold[:, 0] - np.array(goal.hold), hold[:, 1:]))
            # d/dt (C r) by differences of three points backwards.
            h = times[1]
            change = (3.0 * seen[-1] - 4.0 * seen[-2] + seen[-3]) / (2.0 * h)
            rest = goal.scale * (
                change @ np.column_stack([self.free[-1][:3], self.moved[-1][:3]])
                + seen[-1] @ np.column_stack([self.free[-1][3:], self.moved[-1][3:]])
            )
            self.norms.append((goal.radius, rest[:, 0], rest[:, 1:]))
        if question.speed_limit is not None:
            for i in range(0, len(times), fine // 2):
                self.norms.append(
                    (
                        SPEED_SCALE * question.speed_limit,
                        SPEED_SCALE * self.free[i][3:],
                        SPEED_SCALE * self.moved[i][3:],
                    )
                )

    def kept(self, history: np.ndarray) -> float:
        """The least margin at the checks of a history (N, channels) as the answers hold it."""
        u = np.einsum("kab,kb->ka", self.maps, history).ravel()
        rooms = [limit - float(np.linalg.norm(at + gain @ u)) for limit, at, gain in self.norms]
        return min(float((self.offsets + self.gains @ u).min()), *rooms, math.inf)

    def margin(self, *, inside: bool) -> float:
        """The largest margin with norms and thrusts bounded from inside, or from outside, by HiGHS."""
        question, steps = self.question, self.question.steps
        sphere, share = _sphere(_COUNT)
        cut = share if inside else 1.0
        offsets, gains = [self.offsets], [self.gains]
        for limit, at, gain in self.norms:
            offsets.append(limit - sphere @ at / cut)
            gains.append(-sphere @ gain / cut)
        through = np.concatenate(gains)
        count = self.maps.shape[2]
        mapped = np.einsum("rka,kab->rkb", through.reshape(-1, steps, 3), self.maps).reshape(len(through), -1)
        kind = question.thrust.kind
        bounds = [{"ball": (None, None), "box": (-1.0, 1.0), "thrusters": (0.0, 1.0)}[kind]] * (count * steps)
        more, most = {
            "ball": (sphere, cut * question.thrust.a_max[0]),
            "box": (np.zeros((0, count)), 1.0),
            "thrusters": (np.ones((1, count)), 1.0),
        }[kind]
        moves = np.concatenate([self.moves, np.zeros((len(through) - len(self.moves), 6))])
        top = csr_matrix(np.column_stack([-mapped, -moves, np.ones(len(mapped))]))
        extra = hstack([kron(np.eye(steps), more), csr_matrix((steps * len(more), 7))])
        found = linprog(
            np.concatenate([np.zeros(count * steps + 6), [-1.0]]),
            vstack([top, extra]),
            np.concatenate([*offsets, np.full(steps * len(more), most)]),
            bounds=[*bounds, *[(-1.0, 1.0)] * 6, (None, None)],
            method="highs",
        )
        return -float(found.fun)


def _sphere(count: int) -> tuple[np.ndarray, float]:
    """Directions, and the least cosine of any direction with the nearest of them (a bit less than measured)."""
    points = np.arange(count) + 0.5
    polar, round_ = np.arccos(1.0 - 2.0 * points / count), math.pi * (1.0 + 5.0**0.5) * points
    sphere = np.column_stack([np.cos(round_) * np.sin(polar), np.sin(round_) * np.sin(polar), np.cos(polar)])
    rng = np.random.default_rng(1).normal(size=(20_000, 3))
    rng /= np.linalg.norm(rng, axis=1)[:, None]
    return sphere, float((rng @ sphere.T).max(axis=1).min()) - 0.002
