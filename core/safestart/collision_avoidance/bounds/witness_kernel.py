"""Compiled kernel: find controls that keep away from the origin by ascent, and certify them between samples."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from safestart.model.scenario import Floats
from safestart.runtime.kernels.compiled import compiled

Whole = NDArray[np.int64]


@compiled(error_model="numpy")
def _fly(
    start: Floats, step: Floats, push: Floats, controls: Floats, sag: Floats, path: Floats, near: Floats
) -> float:
    """Fly piecewise constant ``controls`` (J, m); returns a lower bound of the distance over all times.

    ``near`` (J, 2 + m): distance to the chord of every piece, the place on it, and its unit direction. Between samples
    the path is within a h^2 / 8 of the chord, a the largest acceleration there: ``sag`` (share per speed, per distance,
    constant), already times h^2 / 8.
    """
    pieces, m = controls.shape
    n = 2 * m
    for i in range(n):
        path[0, i] = start[i]
    bound = np.inf
    for j in range(pieces):
        for i in range(n):
            value = 0.0
            for k in range(n):
                value += step[i, k] * path[j, k]
            for k in range(m):
                value += push[i, k] * controls[j, k]
            path[j + 1, i] = value
        along, length, distance, speed = 0.0, 0.0, 0.0, 0.0
        for i in range(m):
            chord = path[j + 1, i] - path[j, i]
            along -= chord * path[j, i]
            length += chord * chord
            distance += path[j, i] * path[j, i]
            speed += path[j, m + i] * path[j, m + i]
        share = min(max(along / length, 0.0), 1.0) if length > 0.0 else 0.0
        size = 0.0
        for i in range(m):
            near[j, 2 + i] = (1.0 - share) * path[j, i] + share * path[j + 1, i]
            size += near[j, 2 + i] * near[j, 2 + i]
        size = np.sqrt(size)
        for i in range(m):
            near[j, 2 + i] = near[j, 2 + i] / size if size > 0.0 else 0.0
        near[j, 0], near[j, 1] = size, share
        low = size - (sag[0] * np.sqrt(speed) + sag[1] * np.sqrt(distance) + sag[2])
        bound = min(bound, low)
    return bound


@compiled(error_model="numpy")
def _turn(
    step: Floats, push: Floats, near: Floats, blur: float, parts: Whole, radii: Floats, slope: Floats,
    costate: Floats, spare: Floats,
) -> None:  # fmt: skip
    """``slope`` (J, m) becomes the inputs that raise the softened least distance most: the ascent's target."""
    pieces, m = slope.shape
    n = 2 * m
    least = near[:, 0].min()
    total = 0.0
    for j in range(pieces):
        total += np.exp((least - near[j, 0]) / blur)
    for i in range(n):
        costate[i] = 0.0
    for j in range(pieces - 1, -1, -1):
        weight = np.exp((least - near[j, 0]) / blur) / total
        for i in range(m):
            costate[i] += weight * near[j, 1] * near[j, 2 + i]
        for k in range(m):
            slope[j, k] = 0.0
            for i in range(n):
                slope[j, k] += push[i, k] * costate[i]
        for k in range(n):
            spare[k] = 0.0
            for i in range(n):
                spare[k] += step[i, k] * costate[i]
        for k in range(n):
            costate[k] = spare[k]
        for i in range(m):
            costate[i] += weight * (1.0 - near[j, 1]) * near[j, 2 + i]
        for g in range(len(radii)):
            # Scale by the largest entry first: squares of short slopes would underflow.
            largest = 0.0
            for k in range(parts[g, 0], parts[g, 1]):
                largest = max(largest, abs(slope[j, k]))
            size = 0.0
            for k in range(parts[g, 0], parts[g, 1]):
                slope[j, k] = slope[j, k] / largest if largest > 0.0 else 0.0
                size += slope[j, k] * slope[j, k]
            size = np.sqrt(size)
            for k in range(parts[g, 0], parts[g, 1]):
                slope[j, k] = radii[g] * slope[j, k] / size if size > 0.0 else 0.0


@compiled(error_model="numpy")
def _admissible(controls: Floats, parts: Whole, limits: Floats) -> bool:
    """Whether all ``controls`` (J, m) are certainly in their balls: compares sums of squares with ``limits``."""
    for j in range(len(controls)):
        for g in range(len(limits)):
            square = 0.0
            for k in range(parts[g, 0], parts[g, 1]):
                square += controls[j, k] * controls[j, k]
            if not square <= limits[g]:
                return False
    return True


@compiled(error_model="numpy")
def _hold(guess: Floats, controls: Floats) -> None:
    for j in range(controls.shape[0]):
        for i in range(controls.shape[1]):
            controls[j, i] = guess[i]


@compiled(error_model="numpy")
def _keep(controls: Floats, best: Floats) -> None:
    for j in range(controls.shape[0]):
        for i in range(controls.shape[1]):
            best[j, i] = controls[j, i]


@compiled(error_model="numpy")
def farthest(
    states: Floats,
    step: Floats,
    push: Floats,
    sag: Floats,
    guesses: Floats,
    parts: Whole,
    radii: Floats,
    limits: Floats,
    pieces: int,
    goal: Floats,
    effort: int,
    blur: float,
    out: Floats,
    best: Floats,
) -> None:
    """``out`` (N,): certified distance of the best controls found; ``best`` (N or 0, J, m): those controls.

    Constant ``guesses`` (G, m) first, then from the best few of them ``effort`` steps of conditional-gradient ascent
    each (steps 2 / (k + 2), so that controls stay in the convex set of ``parts`` and ``radii``) on the softened
    least distance, with ``blur`` (m) falling. The search for a state ends as soon as it keeps ``goal``. Controls count
    only if they are within their balls (``limits``, squared, minus an allowance for rounding).
    """
    m = guesses.shape[1]
    n = 2 * m
    path, near = np.empty((pieces + 1, n)), np.empty((pieces, 2 + m))
    controls, target = np.empty((pieces, m)), np.empty((pieces, m))
    costate, spare = np.empty(n), np.empty(n)
    scores = np.empty(len(guesses))
    for p in range(len(states)):
        found = -np.inf
        for g in range(len(guesses)):
            _hold(guesses[g], controls)
            scores[g] = _fly(states[p], step, push, controls, sag, path, near)
            if scores[g] > found and _admissible(controls, parts, limits):
                found = scores[g]
                if len(best) > 0:
                    _keep(controls, best[p])
            if found >= goal[p]:
                break
        if found < goal[p]:
            for _ in range(min(3, len(guesses))):
                g = int(np.argmax(scores))
                scores[g] = -np.inf
                _hold(guesses[g], controls)
                _fly(states[p], step, push, controls, sag, path, near)
                for k in range(effort):
                    _turn(
                        step, push, near, blur / (1.0 + k) ** 2 + 1e-4, parts, radii, target, costate, spare
                    )
                    share = 2.0 / (k + 2.0)
                    for j in range(pieces):
                        for i in range(m):
                            controls[j, i] += share * (target[j, i] - controls[j, i])
                    value = _fly(states[p], step, push, controls, sag, path, near)
                    if value > found and _admissible(controls, parts, limits):
                        found = value
                        if len(best) > 0:
                            _keep(controls, best[p])
                    if found >= goal[p]:
                        break
                if found >= goal[p]:
                    break
        out[p] = found
