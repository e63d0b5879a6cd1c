"""One control interval of the truth: exact CWH under a held thrust, with checks of the rotating corridor.

Between sub-steps h seconds apart a face distance is enclosed by the cubic through value and slope at both: the true one
is at most h^4 / 384 times the largest |f''''| away, some 1e-5 m for the paper's sub-steps at 5 deg/s, 1e-7 m for h =
0.25 s. The cubic's minimum is closed-form; where it is negative, its root is the time of the violation.
"""

from __future__ import annotations

import math

from safestart.constraints.dip import dip
from safestart.runtime.kernels.compiled import compiled
from safestart.simulation.noise import AT_NODES, CONTINUOUS

_AT_NODES, _CONTINUOUS = AT_NODES, CONTINUOUS
_BISECTIONS = 50


@compiled(error_model="numpy", inline="always")
def distance(normals, offsets, x, d, count):  # type: ignore[no-untyped-def]
    """Least distance (m) of the position in x to the faces with unit normals (d, F) and offsets (F,)."""
    least = math.inf
    for i in range(count):
        value = offsets[i]
        for c in range(d):
            value -= normals[c, i] * x[c]
        # This form of the comparison passes a NaN distance on.
        if not value >= least:
            least = value
    return least


@compiled(error_model="numpy")
def slopes(normals, offsets, x, d, count, omega, step, out):  # type: ignore[no-untyped-def]
    """Distances ``out[0]`` to each face that turns at ``omega``, and their rates times ``step``, ``out[1]``."""
    for i in range(count):
        value = offsets[i]
        rate = omega * (normals[1, i] * x[0] - normals[0, i] * x[1])
        for c in range(d):
            value -= normals[c, i] * x[c]
            rate -= normals[c, i] * x[3 + c]
        out[0, i] = value
        out[1, i] = rate * step


@compiled(error_model="numpy")
def advance(  # type: ignore[no-untyped-def]
    k, x, ux, uy, uz, phi, gamma, faces, offsets, omega, step, check, before, after, log_state
):
    """Move ``x`` (6,) through interval ``k``; return the least distance (m) seen and when it first became negative.

    ``phi`` and ``gamma`` carry one sub-step of ``step`` seconds; ``faces`` (K, S, d, F). ``before`` (2, F) holds
    distances and scaled slopes at the interval's start when ``check`` is continuous, and at its end afterwards;
    ``after`` is scratch. The interval ends early at a violation; the time is seconds into it, infinite without one.
    """
    substeps, d, count = faces.shape[1], faces.shape[2], faces.shape[3]
    margin = math.inf
    for s in range(substeps):
        # Phi couples (x, y) and leaves z alone.
        a, b, c, p, q, w = x[0], x[1], x[2], x[3], x[4], x[5]
        for i in (0, 1, 3, 4):
            x[i] = (
                phi[i, 0] * a + phi[i, 1] * b + phi[i, 3] * p + phi[i, 4] * q
                + gamma[i, 0] * ux + gamma[i, 1] * uy
            )  # fmt: skip
        x[2] = phi[2, 2] * c + phi[2, 5] * w + gamma[2, 2] * uz
        x[5] = phi[5, 2] * c + phi[5, 5] * w + gamma[5, 2] * uz
        if len(log_state) > 0:
            for i in range(6):
                log_state[k * substeps + s, i] = x[i]
        if check == _CONTINUOUS:
            slopes(faces[k, s], offsets, x, d, count, omega, step, after)
            first = math.inf
            for i in range(count):
                left, right, begin, end = before[0, i], after[0, i], before[1, i], after[1, i]
                low, at = dip(left, right, begin, end)
                if at == 0.0:  # the left end was the right one of the sub-step before
                    low, at = right, 1.0
                if not low >= margin:
                    margin = low
                if low < 0.0:
                    first = min(first, cubic_root(left, begin, right, end, at))
                before[0, i], before[1, i] = right, end
            if first < math.inf:
                return margin, (s + first) * step
        elif check != _AT_NODES or s == substeps - 1:
            value = distance(faces[k, s], offsets, x, d, count)
            if not value >= margin:
                margin = value
            if value < 0.0:
                return margin, (s + 1) * step
        if not math.isfinite(x[0] + x[1] + x[2] + x[3] + x[4] + x[5]):
            return math.nan, math.inf
    return margin, math.inf


@compiled(error_model="numpy")
def cubic_root(left, begin, right, end, at):  # type: ignore[no-untyped-def]
    """Where in [0, at] the cubic through (left, begin) and (right, end) crosses zero; it is negative at ``at``."""
    rise = right - left
    square = 3.0 * rise - 2.0 * begin - end
    cube = begin + end - 2.0 * rise
    low, high = 0.0, at
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        if left + middle * (begin + middle * (square + middle * cube)) >= 0.0:
            low = middle
        else:
            high = middle
    return high
