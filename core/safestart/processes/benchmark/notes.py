"""Notes that a reader needs to interpret a benchmark's numbers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from safestart.model.scenario import SetKind
from safestart.processes.benchmark.spec import BenchmarkQuestion

_OUTSIDE = {
    "certified": ("the certified cells", ", although continuous thrust keeps them there"),
    "analytical": ("the cells of the paper's conditions", ", so the conditions are wrong there"),
}


def notes(inputs: BenchmarkQuestion, rows: Sequence[dict[str, Any]], contained: float | None) -> list[str]:
    """Sentences about the compared sets, derived from the result."""
    by_engine = {row["engine"]: row for row in rows}
    out: list[str] = []
    if inputs.set is SetKind.TUBE:
        out.append(
            "The tube contains its target: restricted to the corridor it is the whole corridor (reached at t = 0), "
            "so IoU against it is the certificate's share of the corridor."
        )
    else:
        out.append(
            f"Reachable sets are fixed-time: in the rotated corridor at exactly {inputs.horizon_s:g} s, with any "
            "velocity. The certificate asks to stay inside and to match the rotation, with no horizon."
        )
    for engine, (whose, why) in _OUTSIDE.items():
        outside = by_engine.get(engine, {}).get("violation_vs_exact")
        if outside:
            out.append(
                f"{100 * outside:.1f} % of {whose} are outside the exact set: no thrust held over the intervals "
                f"brings them to the corridor at {inputs.horizon_s:g} s{why}."
            )
    if contained is not None and contained > inputs.horizon_s:
        out.append(f"At {contained:g} s the exact set holds every certified start.")
    if "analytical" in by_engine:
        out.append("analytical, the paper's conditions, is not sound: no GO of it is a proof. certified is.")
    hj = by_engine.get("hamilton_jacobi", {})
    if hj.get("iou_vs_exact") is not None and hj["iou_vs_exact"] < 1.0:
        out.append(
            f"The level set's own error on this grid: IoU {hj['iou_vs_exact']:.3f} against the exact set "
            "(no grid); compare areas against exact where it is there."
        )
    out.extend(f"{row['engine']}: {row['code']}, {row['message']}" for row in rows if row["code"] != "ok")
    return out
