"""Compiled bounds of linear rows over the segments of a tube; :meth:`Tube.upper` explains the method."""

from __future__ import annotations

import numpy as np

from safestart.model.scenario import Floats
from safestart.runtime.kernels.compiled import compiled


@compiled()
def _support(row: Floats, centre: Floats, gens: Floats) -> tuple[float, float]:
    """Value at the centre and half-width of ``row`` (4,) over one zonotope: ``centre`` (4,), ``gens`` (g, 4)."""
    wide = 0.0
    for g in range(len(gens)):
        wide += abs(row[0] * gens[g, 0] + row[1] * gens[g, 1] + row[2] * gens[g, 2] + row[3] * gens[g, 3])
    middle = row[0] * centre[0] + row[1] * centre[1] + row[2] * centre[2] + row[3] * centre[3]
    return middle, wide


@compiled()
def _weighed(terms: Floats, sizes: Floats) -> float:
    """|terms| . sizes, each (4,)."""
    total = 0.0
    for i in range(4):
        total += abs(terms[i]) * sizes[i]
    return float(total)


@compiled()
def _over(
    k: int,
    row: int,
    derivatives: Floats,
    terms: Floats,
    centre: Floats,
    gens: Floats,
    size: Floats,
    sway: float,
    h: float,
    slack: float,
) -> float:
    """Tighter bound on a row's excess over its greater end of segment ``k``; ``sway`` bounds its third derivative."""
    low, high = np.empty((2, 2)), np.empty((2, 2))
    for order in range(2):
        for end in range(2):
            middle, wide = _support(derivatives[order, row], centre[k + end], gens[k + end])
            wide += slack * _weighed(terms[order, row], size[k + end])
            low[order, end], high[order, end] = middle - wide, middle + wide
    bow, turn = h * h / 8.0 * sway, 0.5 * h * sway
    steep = h * (min(max(high[0, 0], high[0, 1]), -min(low[0, 0], low[0, 1])) + bow)
    chord = h * h / 8.0 * (turn - min(low[1, 0], low[1, 1]))
    least = min(steep, chord)
    concave = -max(high[1, 0], high[1, 1]) - turn
    if concave > 0.0:
        leaves = max(0.0, min(high[0, 0], -low[0, 1]))
        least = min(least, leaves * leaves / (2.0 * concave))
    return float(max(0.0, least))


@compiled()
def upper(
    rows: Floats,
    derivatives: Floats,
    terms: Floats,
    centre: Floats,
    gens: Floats,
    noise: Floats,
    bend: Floats,
    third: Floats,
    h: float,
    notable: float,
    slack: float,
) -> Floats:
    """Bounds (n, r) of ``rows`` (r, 4) over the n segments between the sets ``centre`` (n+1, 4), ``gens`` (n+1, g, 4).

    ``derivatives`` (2, r, 4): rows of the first and second derivative; ``terms`` (2, r, 4): the sums of absolute values
    behind their entries. ``noise`` (n+1, 4), ``bend`` and ``third`` (n, 4): see ``Tube``; ``h``: step, min.
    ``notable``: share of the width above which the chord's error gets a tighter bound; ``slack``: relative round-off.
    """
    nodes, count = len(centre), len(rows)
    up = 1.0 + slack
    size = np.abs(centre)
    for k in range(nodes):
        for g in range(gens.shape[1]):
            for i in range(4):
                size[k, i] += abs(gens[k, g, i])
    out = np.empty((nodes - 1, count))
    for r in range(count):
        before, rough_before = 0.0, 0.0
        for k in range(nodes):
            middle, wide = _support(rows[r], centre[k], gens[k])
            rough = _weighed(rows[r], noise[k]) + slack * _weighed(rows[r], size[k])
            value = middle + wide
            if k > 0:
                over = up * _weighed(rows[r], bend[k - 1])
                if over > notable * (wide + 0.5 * abs(value - before)):
                    sway = up * _weighed(rows[r], third[k - 1])
                    closer = _over(k - 1, r, derivatives, terms, centre, gens, size, sway, h, slack)
                    over = min(over, up * up * closer)
                out[k - 1, r] = max(before, value) + up * (max(rough_before, rough) + over)
            before, rough_before = value, rough
    return out
