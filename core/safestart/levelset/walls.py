"""Where every input makes a motion leave the box; the values beyond are unknown, so these states count as outside."""

from __future__ import annotations

import numpy as np

from safestart.levelset.dynamics import Ball, Box, Motion
from safestart.levelset.lattice import Boundary, Lattice
from safestart.model.scenario import Floats


def beyond_is_outside(lattice: Lattice, motion: Motion, values: Floats, times: list[float]) -> Floats:
    """Raise ``values`` of a set to be kept on walls of the lattice that a state must cross.

    Nodes whose value is not positive rise to the largest value (or a positive one). Otherwise the ghosts behind an
    ``EDGE`` wall, which repeat its value, would keep a state that has left in the set for ever.
    """
    lost = np.zeros(lattice.shape, dtype=np.bool_)
    for time in times if motion.varies else times[:1]:
        for axis, boundary in enumerate(lattice.boundary):
            if boundary is Boundary.PERIODIC:
                continue
            outward = _least_outward(lattice, motion, axis, time)
            for end, sign in ((0, -1), (-1, 1)):
                wall = [slice(None)] * lattice.ndim
                wall[axis] = slice(0, 1) if end == 0 else slice(-1, None)
                lost[tuple(wall)] |= outward[sign][tuple(wall)] > 0.0
    high, low = float(values.max()), float(values.min())
    top = high if high > 0.0 else -low if low < 0.0 else 1.0
    return np.where(lost & (values <= 0.0), top, values)


def _least_outward(lattice: Lattice, motion: Motion, axis: int, time: float) -> dict[int, Floats]:
    """For each direction of the axis, the speed along it that the minimising player cannot prevent."""
    rates = motion.rates(lattice, time)
    drift: Floats = np.broadcast_to(
        np.sum(np.broadcast_arrays(0.0, *rates.drift[axis]), axis=0), lattice.shape
    )
    out = {-1: -drift, 1: drift.copy()}
    for (bound, aim, _), columns in zip(motion.bounds, rates.gains, strict=True):
        gains = [np.zeros(1) if column[axis] is None else np.asarray(column[axis]) for column in columns]
        if not gains:
            continue
        middle = sum((g * m for g, m in zip(gains, bound.middle, strict=True)), np.zeros(1))
        reach = _reach(gains, bound)
        for sign in (-1, 1):
            out[sign] = out[sign] + sign * middle + (reach if aim == "max" else -reach)
    return out


def _reach(gains: list[Floats], bound: Box | Ball) -> Floats:
    """The largest effect of an input on a rate, on either side of its middle."""
    if isinstance(bound, Ball):
        return np.asarray(bound.radius * np.sqrt(sum((np.square(g) for g in gains), np.zeros(1))))
    return np.asarray(sum((np.abs(g) * h for g, h in zip(gains, bound.half, strict=True)), np.zeros(1)))
