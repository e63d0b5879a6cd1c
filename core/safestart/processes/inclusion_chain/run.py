"""Run inclusion-chain: compute the sets, compare every pair, show where they contradict the chain."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Any

import numpy as np

from safestart.constraints.corridor import corridor_of
from safestart.engines.base import ResultCode
from safestart.model.scenario import Bools, Floats
from safestart.processes.base import Artifact, ProcessOutput
from safestart.processes.inclusion_chain.containment import (
    FORMS,
    fine_atlas,
    in_exact_position,
    in_synchronize,
    sliver,
)
from safestart.processes.inclusion_chain.evidence import counter_example, fraction, pairs
from safestart.processes.inclusion_chain.notes import notes
from safestart.processes.inclusion_chain.plots import chain_map, violation_table
from safestart.processes.inclusion_chain.regions import Region, region_of
from safestart.processes.inclusion_chain.spec import CHAIN, PAPER_CHAIN, ChainInputs
from safestart.processes.output import Undrawn
from safestart.processes.plotting import npz
from safestart.runtime.progress import Context

# Shares of the progress bar, roughly those of the time.
_WEIGHTS = {"hj_match": 20.0, "hj_position": 20.0, "synchronize": 40.0}
_CONTAINMENT, _FINISH = 20.0, 4.0


def run(inputs: ChainInputs, context: Context) -> ProcessOutput:
    """Sets, table, counter-examples, containment, pictures. A failed set keeps its row, without measures."""
    scenario, grid = inputs.scenario(), inputs.grid.grid()
    points = grid.points(scenario.corridor)
    corridor = corridor_of(scenario.corridor).contains(points)
    total = sum(_WEIGHTS.get(name, 1.0) for name in inputs.sets) + _CONTAINMENT + _FINISH
    done = 0.0
    regions: dict[str, Region] = {}
    for name in inputs.sets:
        share = _WEIGHTS.get(name, 1.0)
        regions[name] = region_of(name, inputs, corridor, context.part(done, share, total, name))
        done += share
        context.step(done, total, f"{name} done")
    contained, thin = _containment(
        inputs, regions, points, context.part(done, _CONTAINMENT, total, "containment")
    )
    done += _CONTAINMENT
    context.step(done, total, "counter-examples")
    table = pairs(regions)
    examples = []
    for inner in regions.values():
        for outer in regions.values():
            found = (
                counter_example(inner, outer, points, matched=inputs.rest_speed_m_s <= inputs.match_m_s)
                if inner is not outer
                else None
            )
            examples += [found] if found else []
        context.step(done, total, "counter-examples")
    document = {
        "corridor_cells": int(corridor.sum()),
        "cell_area_m2": grid.cell_area(scenario.corridor),
        "sets": [_row(region, corridor, grid.cell_area(scenario.corridor)) for region in regions.values()],
        "chain": _links(regions),
        "violation_fraction": table,
        "counter_examples": examples,
        "horizon_contained_s": contained,
        "slivers": thin,
    }
    document["notes"] = notes(inputs, regions, document)
    context.step(total - 1.0, total, "pictures")
    return ProcessOutput(document, _artifacts(inputs, regions, document, points, corridor))


def _containment(
    inputs: ChainInputs, regions: Mapping[str, Region], points: Floats, context: Context
) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    forms = [name for name in FORMS if name in regions]
    out = []
    for k, name in enumerate(forms if inputs.containment_up_to_s > 0.0 else ()):
        starts = points[regions[name].inside]
        if "synchronize" in regions:
            out.append(in_synchronize(inputs, name, starts, context.part(k, 1, len(forms), name)))
        if "exact_position" in regions:
            out.append(in_exact_position(inputs, name, starts))
    if not forms:
        return out, []
    atlas = fine_atlas(inputs)
    return out, [sliver(inputs, name, atlas) for name in forms]


def _row(region: Region, corridor: Bools, cell_area: float) -> dict[str, Any]:
    ok = region.code is ResultCode.OK
    cells = int(region.inside.sum())
    return {
        "name": region.name,
        "code": region.code.value,
        "message": region.message,
        "cells": cells if ok else None,
        "undecided_cells": int((corridor & ~region.inside & ~region.outside).sum()) if ok else None,
        "area_m2": cells * cell_area if ok else None,
        "run_s": region.run_s,
        "detail": region.detail,
    }


def _links(regions: Mapping[str, Region]) -> list[dict[str, Any]]:
    claimed = {
        (whose, *link): None
        for whose, chain in (("ours", CHAIN), ("paper", PAPER_CHAIN))
        if whose == "ours" or not regions.keys().isdisjoint(("tube", "analytical"))
        for link in pairwise(name for name in chain if name in regions)
    }
    return [
        {
            "whose": whose,
            "inner": inner,
            "outer": outer,
            "violation_fraction": (share := fraction(regions[inner], regions[outer])),
            "cells": None if share is None else int((regions[inner].inside & regions[outer].outside).sum()),
        }
        for whose, inner, outer in claimed
    ]


def _artifacts(
    inputs: ChainInputs,
    regions: Mapping[str, Region],
    document: Mapping[str, Any],
    points: Floats,
    corridor: Bools,
) -> tuple[Artifact | Undrawn, ...]:
    arrays: dict[str, Any] = {"points_m": points, "inside": corridor}
    for name, region in regions.items():
        if region.code is ResultCode.OK:
            arrays[f"{name}_mask"] = region.inside
            arrays[f"{name}_undecided"] = corridor & ~region.inside & ~region.outside
            arrays[f"{name}_margin_m"] = region.margin
    names = list(regions)
    table = [[document["violation_fraction"][a][b] for b in names] for a in names]
    arrays["violation_fraction"] = np.array(table, dtype=np.float64)
    pictures = (chain_map(inputs, regions, document), violation_table(inputs, regions, document))
    return (*pictures, npz("chain.npz", arrays))
