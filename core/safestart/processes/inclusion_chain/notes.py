"""Notes that a reader needs to interpret a chain's table."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from safestart.engines.base import ResultCode
from safestart.processes.inclusion_chain.regions import Region
from safestart.processes.inclusion_chain.spec import ChainInputs


def notes(inputs: ChainInputs, regions: Mapping[str, Region], document: Mapping[str, Any]) -> list[str]:
    """Sentences about the sets, derived from the result."""
    out = []
    for link in document["chain"]:
        share = link["violation_fraction"]
        if share is None:
            out.append(f"{link['inner']} in {link['outer']}: nothing to say, a set is empty or failed.")
        elif share > 0.0:
            out.append(
                f"{link['inner']} in {link['outer']} does NOT hold at {inputs.horizon_s:g} s: {100 * share:.1f} % "
                "of the inner cells are outside."
            )
    if "tube" in regions:
        out.append(
            "tube asks to stay for the horizon against every disturbance and is no subset of S_ana, which also "
            "asks to match the rotation; analytical_tube is S_ana of the tightened scenario and is one."
        )
    if "hj_position" in regions:
        out.append(
            "hj_position is a tube: restricted to the corridor it holds every start, reached at t = 0; exact_position "
            "is the exact set at the horizon itself."
        )
    if "hj_match" in regions:
        out.append(
            f"hj_match: in the corridor within {inputs.match_m_s:g} m/s of co-rotation at some time up to the horizon; "
            "its grid errs, mostly by losing starts."
        )
    for entry in document["horizon_contained_s"]:
        if entry["horizon_s"] is not None:
            out.append(f"Every start of {entry['inner']} is in {entry['outer']} at {entry['horizon_s']:g} s.")
        elif entry["cells_never"]:
            out.append(
                f"{entry['cells_never']} starts of {entry['inner']} are not in {entry['outer']} "
                f"at {entry['up_to_s']:g} s either."
            )
    for thin in document["slivers"]:
        if thin["inner"] == "analytical" and thin["cannot_stay"]:
            out.append(
                f"Of {thin['certified']} starts of a fine grid that meet the paper's conditions "
                f"{thin['cannot_stay']} are proved unable to stay {inputs.horizon_s:g} s: the conditions are not sound."
            )
        elif thin["inner"] == "certified":
            out.append(
                f"Of {thin['certified']} certified starts of a fine grid {thin['cannot_stay']} are proved unable to "
                f"stay {inputs.horizon_s:g} s."
            )
    out.extend(
        f"{r.name}: {r.code.value}, {r.message}" for r in regions.values() if r.code is not ResultCode.OK
    )
    return list(dict.fromkeys(out))
