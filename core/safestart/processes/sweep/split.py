"""Shards of a sweep: runs of cases that depend on the inputs alone. Light: the service counts them."""

from __future__ import annotations

from typing import Any

from safestart.processes.sweep.spec import SweepInputs

# Cases per shard: a second or so of work.
FAST, SLOW = 10_000, 50
# Cases drawn together, whatever is flown: part of the answer. A shard holds whole draws.
DRAWN, DRAWN_OWN = 50, 100


def split(inputs: SweepInputs) -> list[dict[str, Any]]:
    """Parts ``{"inputs", "number", "pieces"}``; a piece ``[cell, first, count]`` is a run of cases.

    ``first`` counts within the cell (grid) or over all cases. Operating points vary slowest; one is cut only where it
    has more cases than a shard holds.
    """
    dumped = inputs.model_dump(mode="json")
    slow = "sequence" in inputs.controllers or inputs.truth.model != "cwh"
    if inputs.distribution != "grid":
        shards = [
            [[0, first, min(DRAWN_OWN, inputs.cases - first)]] for first in range(0, inputs.cases, DRAWN_OWN)
        ]
    else:
        most = SLOW if slow else FAST
        points = len(inputs.omega_t_deg_s) * len(inputs.a_max_m_s2)
        ranges = len(inputs.r0_m)
        shards = []
        shard: list[list[int]] = []
        room = most
        for point in range(points):
            if ranges * inputs.cases_per_cell > room < most:
                shards.append(shard)
                shard, room = [], most
            for cell in range(point * ranges, (point + 1) * ranges):
                for first in range(0, inputs.cases_per_cell, most):
                    count = min(most, inputs.cases_per_cell - first)
                    if count > room:
                        shards.append(shard)
                        shard, room = [], most
                    shard.append([cell, first, count])
                    room -= count
        shards.append(shard)
    return [{"inputs": dumped, "number": number, "pieces": pieces} for number, pieces in enumerate(shards)]
