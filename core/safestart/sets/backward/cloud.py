"""Sampling: the paper's empirical set, and flights that count how often a chance-constrained start succeeds."""

from __future__ import annotations

import numpy as np

from safestart.model.scenario import Bools, Floats
from safestart.sets.backward.question import Question


def empirical(question: Question, draws: int, axes: tuple[int, int], seed: int) -> Floats:
    """Starts (P, n) from which one drawn noise and input history ends in the target: the paper's stochastic set.

    Each is a point of the target taken back through x(k) = A^-1 (x(k+1) - B u(k) - G g(k)); those that leave the limits
    are dropped. The inputs are those that go furthest in a random direction of the plane ``axes``, each component times
    a random share, so that the set is filled up to its boundary. Such a start succeeds for ITS noise; nothing is said
    of any other.
    """
    random = np.random.Generator(np.random.Philox(seed))
    n, m, steps = len(question.a), len(question.inputs), question.steps
    inverse = np.linalg.inv(question.a)
    angle = random.uniform(0.0, 2.0 * np.pi, draws)
    states = question.centre + question.half_widths * random.uniform(-1.0, 1.0, (draws, n))
    # Cube roots crowd the shares towards 1, the boundary.
    share = np.cbrt(random.uniform(0.0, 1.0, (draws, m))) * question.inputs
    inputs = np.empty((steps, draws, m))
    noise = random.standard_normal((steps, draws, question.noise.shape[1]))
    rows = np.zeros((draws, n))
    rows[:, axes[0]], rows[:, axes[1]] = np.cos(angle), np.sin(angle)
    for k in range(steps):
        rows = rows @ inverse
        inputs[k] = -np.sign(rows @ question.b) * share
    kept = np.ones(draws, dtype=np.bool_)
    for k in range(steps - 1, -1, -1):
        states = (states - inputs[k] @ question.b.T - noise[k] @ question.noise.T) @ inverse.T
        kept &= (np.abs(states) <= question.limits).all(axis=1)
    return states[kept]


def succeeded(question: Question, start: Floats, inputs: Floats, draws: int, seed: int) -> int:
    """How many of ``draws`` noisy flights from ``start`` (n,) under ``inputs`` (N, m) keep every limit and arrive."""
    random = np.random.Generator(np.random.Philox(seed))
    centres, halves = question.boxes()
    states = np.tile(start, (draws, 1))
    good: Bools = np.ones(draws, dtype=np.bool_)
    for k in range(question.steps):
        noise = random.standard_normal((draws, question.noise.shape[1]))
        states = states @ question.a.T + question.b @ inputs[k] + noise @ question.noise.T
        good &= (np.abs(states - centres[k + 1]) <= halves[k + 1]).all(axis=1)
    return int(good.sum())
