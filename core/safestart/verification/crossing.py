"""From mode 1 to mode 2: every state on one plane of the guard at the first entry, with the time of crossing.

The flow is expanded about one time t*: with z = z(t*), f = A c*, delta = t_c - t* and e the remainder,

    z(t_c) = z + delta f + e,   |e| <= D |A G*| 1 + D^2/2 sup |A^2 z| + d,   |delta| <= D,

d the deviation of the nonlinear motion from its linear part, and h.z(t_c) = b - sag gives delta, affine in the symbols
of the start, in e and in the sag; then z(t_c) is the projection of z + e along f onto the plane, shifted by the sag.
So the crossing time is one more affine coordinate of the crossing set.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from safestart.scenario import Floats
from safestart.verification.flow import flow_at
from safestart.verification.model import Motion, matrix
from safestart.verification.rounding import SLACK, UP

_ROUNDS = 4


@dataclass(frozen=True, slots=True)
class Crossing:
    """Crossing set of one plane: ``centre`` (4,), ``gens`` (m, 4), the last four a box of remainders.

    Crossing time (min): ``time`` + ``time_gens`` (k,) . xi +- ``time_radius`` with xi those of the first k generators,
    and in [``first``, ``last``]. ``normal`` (2,) points out of the guard; ``name`` says where.
    """

    name: str
    normal: Floats
    centre: Floats
    gens: Floats
    time: float
    time_gens: Floats
    time_radius: float
    first: float
    last: float


@dataclass(frozen=True, slots=True)
class Passage:
    """What is known of the flight around the crossing: between ``first`` and ``last`` (min), expanded at ``middle``.

    ``centre`` (4,) and ``gens`` (g, 4) of mode 1 at time 0; ``second`` (4,) bounds |A^2 z| in between, ``strays`` (4,)
    the deviation from the linear motion.
    """

    motion: Motion
    centre: Floats
    gens: Floats
    first: float
    middle: float
    last: float
    second: Floats
    strays: Floats


def remainder(widest: float, rates: Floats, second: Floats) -> Floats:
    """Bound (4,) on e from the expansion in time: |delta| <= ``widest``, ``rates`` (g, 4) = A G*."""
    result: Floats = widest * np.abs(rates).sum(axis=0) + 0.5 * widest**2 * second
    return result


def cross_plane(passage: Passage, name: str, normal: Floats, limit: float, sag: float = 0.0) -> Crossing:
    """Crossing set of the plane ``normal`` . (x, y) in ``limit`` +- ``sag`` (m)."""
    row, a = np.concatenate([normal, np.zeros(2)]), matrix(passage.motion)
    low, middle, high = passage.first, passage.middle, passage.last
    phi, _ = flow_at(passage.motion, middle)
    nominal, spread = phi @ passage.centre, passage.gens @ phi.T
    flow = a @ nominal
    fall = float(row @ flow)
    size = np.abs(phi) @ (np.abs(passage.centre) + np.abs(passage.gens).sum(axis=0))
    size = size + np.abs(a) @ size * (1.0 + high - low)
    offset = (limit - float(row @ nominal)) / fall
    slopes = -(spread @ row) / fall
    shift = sag / fall
    widest = max(high - middle, middle - low)
    for _ in range(_ROUNDS):
        error = UP * (remainder(widest, spread @ a.T, passage.second) + passage.strays) + SLACK * size
        radius = UP * float(np.abs(row) @ error) / abs(fall) + SLACK * (1.0 + abs(middle) + widest)
        widest = min(widest, UP * (abs(offset) + float(np.abs(slopes).sum()) + abs(shift) + radius))
    project = np.eye(4) - np.outer(flow, row) / fall
    # A second helping of round-off for the projection itself, whose entries are |f| |h| / |h f| at most.
    stretch = np.abs(np.eye(4)) + np.outer(np.abs(flow), np.abs(row)) / abs(fall)
    box = UP * (np.abs(project) @ error) + SLACK * (stretch @ (size + abs(limit)))
    symbols, times = spread @ project.T, slopes
    if sag > 0.0:
        symbols, times = np.vstack([symbols, flow * shift]), np.append(slopes, shift)
    return Crossing(
        name,
        normal,
        nominal + flow * offset,
        np.vstack([symbols, np.diag(box)]),
        middle + offset,
        times,
        radius,
        low,
        high,
    )
