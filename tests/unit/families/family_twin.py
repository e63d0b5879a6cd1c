"""Members of a family flown by matrix exponentials: the plain twin of the bounds for all members."""

import numpy as np
from scipy.linalg import expm

from safestart.exact.question import Question
from safestart.families.members import Family
from safestart.model.scenario import CorridorShape, Floats

PARTS = 10
"""Samples per interval: 0.2 s apart a distance dips by at most |f''| h^2 / 8, about a millimetre."""


def draw(family: Family, state: Floats, count: int, seed: int) -> tuple[Floats, Floats, Floats]:
    """Tumble rates and mean motions (M,) and starts (M, 2 d): half of them at the ends of their intervals."""
    rng = np.random.default_rng(seed)
    share = rng.uniform(-1.0, 1.0, (count, 2 + len(state)))
    ends = rng.random(share.shape) < 0.5
    share = np.where(ends, np.sign(share), share)
    rates, motions = (
        0.5 * (a + b) + 0.5 * (b - a) * share[:, i] for i, (a, b) in enumerate((family.rates, family.motions))
    )
    return rates, motions, state + family.half * share[:, 2:]


def distances(question: Question, rates: Floats, motions: Floats, starts: Floats, thrust: Floats) -> Floats:
    """Smallest sampled face distance (M,) of members flown under thrust (N, d), or (M, N, d)."""
    d, h = question.dimensions, question.dt / PARTS
    thrust = np.broadcast_to(thrust, (len(rates), question.steps, d))
    move = expm(h * _generator(motions, d))
    held = np.concatenate([starts, thrust[:, 0]], axis=1)
    lowest = _nearest(question.scenario.corridor, held, rates, 0.0, d)
    for k in range(question.steps):
        held[:, 2 * d :] = thrust[:, k]
        for i in range(PARTS):
            held = (move @ held[:, :, None])[:, :, 0]
            time = question.dt * k + h * (i + 1)
            lowest = np.minimum(lowest, _nearest(question.scenario.corridor, held, rates, time, d))
    return lowest


def _generator(n: Floats, d: int) -> Floats:
    out = np.zeros((len(n), 3 * d, 3 * d))
    for i in range(d):
        out[:, i, d + i] = out[:, d + i, 2 * d + i] = 1.0
    out[:, d, 0], out[:, d, d + 1], out[:, d + 1, d] = 3.0 * n * n, 2.0 * n, -2.0 * n
    if d == 3:
        out[:, 5, 2] = -n * n
    return out


def _nearest(shape: CorridorShape, state: Floats, rates: Floats, time: float, d: int) -> Floats:
    c, s = np.cos(rates * time), np.sin(rates * time)
    x, y = c * state[:, 0] + s * state[:, 1], c * state[:, 1] - s * state[:, 0]
    ahead = y - shape.hold_radius
    room = (shape.x0 + shape.c_x * ahead - np.abs(x)) / np.hypot(1.0, shape.c_x)
    lowest = np.minimum(ahead, room)
    if d == 3:
        above = (shape.z0 + shape.c_z * ahead - np.abs(state[:, 2])) / np.hypot(1.0, shape.c_z)
        lowest = np.minimum(lowest, above)
    return lowest
