"""Shards of a sweep: runs of cases that depend only on the inputs. Light to import: the service counts them."""

from __future__ import annotations

from typing import Any

from safestart.campaign.cuts import packed, runs
from safestart.processes.sweep.inputs import SweepInputs

# Cases per shard: a tenth of a second to a second of work. Very large sweeps have larger shards instead of more:
# scheduler and store take a millisecond for each (benchmarks/scaling.py).
FAST, SLOW = 10_000, 50
MOST_SHARDS = 8_000
# Cases per random draw. It affects the answer; a shard holds whole draws.
DRAWN, DRAWN_OWN = 50, 100


def split(inputs: SweepInputs) -> list[dict[str, Any]]:
    """Parts ``{"inputs", "number", "pieces"}``; a piece ``[cell, first, count]`` is a run of cases.

    ``first`` counts within the cell (grid) or over all cases. Operating points vary slowest; one is cut only when it
    has more cases than a shard holds.
    """
    if inputs.distribution != "grid":
        shards = [[[0, first, count]] for first, count in runs(inputs.cases, DRAWN_OWN)]
    else:
        points = len(inputs.omega_t_deg_s) * len(inputs.a_max_m_s2)
        draws = -(-inputs.total // (MOST_SHARDS * DRAWN))
        most = SLOW if inputs.one_by_one else max(FAST, draws * DRAWN)
        shards = packed(points, len(inputs.r0_m), inputs.cases_per_cell, most)
    dumped = inputs.model_dump(mode="json")
    return [{"inputs": dumped, "number": number, "pieces": pieces} for number, pieces in enumerate(shards)]
