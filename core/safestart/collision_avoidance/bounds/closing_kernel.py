"""Compiled kernel: the least distance within which every path can be held at one time (bound from above)."""

from __future__ import annotations

import numpy as np

from safestart.model.scenario import Floats
from safestart.runtime.kernels.compiled import compiled


@compiled(error_model="numpy")
def closest_certain(
    states: Floats,
    drift: Floats,
    supports: Floats,
    directions: Floats,
    widen: float,
    slack: Floats,
    kept: Floats,
    out: Floats,
) -> None:
    """``out`` (kept, N): min over times up to kept[c] of widen * max over k of (s_k . q(t) + sigma_k(t)) + slack.

    The first time is 0, where the distance is known without slack (N,) and without widening.

    ``drift`` (T, 1 + m, n): time, then the rows that give the drift position q of ``states`` (N, n); ``supports``
    (T, K) the support function sigma of the displacements in ``directions`` (K, m). ``kept`` ascends.
    """
    times, n = drift.shape[0], states.shape[1]
    m, count = directions.shape[1], directions.shape[0]
    q = np.empty((times, m))
    floor = np.empty(times)
    least = np.empty(times)
    for t in range(times):
        least[t] = supports[t].min()
    for p in range(len(states)):
        for t in range(times):
            square = 0.0
            for i in range(m):
                q[t, i] = 0.0
                for k in range(n):
                    q[t, i] += drift[t, 1 + i, k] * states[p, k]
                square += q[t, i] * q[t, i]
            # The directions cover the sphere: widen * max s . q >= |q|.
            floor[t] = np.sqrt(square) + widen * least[t] + (slack[p] if t > 0 else 0.0)
        first, best = 1, floor[0] - widen * least[0]
        for c in range(len(kept)):
            last = first
            while last < times and drift[last, 0, 0] <= kept[c]:
                last += 1
            if last > first:
                # The most promising time first; the floor then excludes most others.
                begin = first + int(np.argmin(floor[first:last]))
                for turn in range(first - 1, last):
                    t = begin if turn < first else turn
                    if floor[t] >= best:
                        continue
                    most = 0.0
                    for k in range(count):
                        reach = supports[t, k]
                        for i in range(m):
                            reach += directions[k, i] * q[t, i]
                        most = max(most, widen * reach + slack[p])
                        if most >= best:
                            break
                    best = min(best, most)
            first = last
            out[c, p] = best
