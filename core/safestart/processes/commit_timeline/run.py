"""Run commit-timeline: one part of the span, and all of them put together."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from safestart.exact.answer import Verdict
from safestart.interchange.epochs import SECOND, Nanoseconds, shortened, text_of
from safestart.interchange.tables.columns import csv_of
from safestart.processes.base import Artifact, ProcessOutput
from safestart.processes.commit_timeline.courses import encounter_of, judges_of
from safestart.processes.commit_timeline.plots import picture
from safestart.processes.commit_timeline.spec import CommitTimelineInputs
from safestart.processes.commit_timeline.split import PARTS
from safestart.processes.sharding import Part
from safestart.processes.wire import finite
from safestart.runtime.progress import Context
from safestart.timeline.encounter import Encounter
from safestart.timeline.verdicts import DT_S, Instant, Judge, joined

_AT_ONCE = 50


def shard(part: dict[str, Any], context: Context) -> Part:
    """Runs of one verdict among the part's instants, by corridor, and the proofs at their ends."""
    inputs = CommitTimelineInputs.model_validate(part["inputs"])
    encounter, steps = encounter_of(inputs)
    own = np.array_split(np.arange(len(steps)), PARTS)[part["part"]]
    runs: list[dict[str, Any]] = []
    proofs: dict[str, Any] = {}
    judges = judges_of(inputs, encounter)
    for index, judge in enumerate(judges):
        instants = _instants(
            inputs, judge, steps, own, context.part(index, 1.0, len(judges), judge.corridor.name)
        )
        for run in joined(instants):
            ends = []
            for one in (run[0], run[-1]):
                found = judge.proof(one.epoch) if inputs.proofs else None
                ends.append(None if found is None else found["digest"])
                if found is not None:
                    proofs[found["digest"]] = found
            runs.append(_run(judge.corridor.name, run, ends))
    return Part({"runs": runs}, json.dumps(proofs, allow_nan=False).encode())


def _instants(
    inputs: CommitTimelineInputs, judge: Judge, steps: Nanoseconds, own: Nanoseconds, context: Context
) -> list[Instant]:
    """The part's own instants, and those that close in on a change, the change to the next part's included."""
    if not len(own):
        return []
    out: list[Instant] = []
    asked = steps[own[0] : own[-1] + 2]
    for first in range(0, len(asked), _AT_ONCE):
        for one in judge.instants(asked[first : first + _AT_ONCE]):
            if out:
                out += judge.closed_in(out[-1], one, inputs.bracket_s)
            out.append(one)
        context.step(min(first + _AT_ONCE, len(asked)), len(asked), "instants")
    if len(asked) > len(own):
        out.pop()
    return out


def _run(corridor: str, run: Sequence[Instant], proofs: Sequence[str | None]) -> dict[str, Any]:
    decided = run[0].verdict != Verdict.UNDECIDED  # else the margin is a bracket's middle, and proves nothing
    bounds = [one.margin for one in run if decided and not math.isnan(one.margin)]
    return {
        "corridor": corridor,
        "verdict": run[0].verdict,
        "why": run[0].why,
        "begin": run[0].epoch,
        "end": run[-1].epoch,
        "instants": len(run),
        "margin_m": finite(min(bounds, key=abs)) if bounds else None,
        "model_error_m": max(one.error for one in run),
        "within_error": any(abs(one.margin) < one.error for one in run),
        "begin_proof": proofs[0],
        "end_proof": proofs[1],
    }


def merge(inputs: CommitTimelineInputs, parts: Sequence[Part], context: Context) -> ProcessOutput:
    """Intervals over the whole span, the picture, the proofs and the table."""
    encounter, steps = encounter_of(inputs)
    context.step(0, 1, "intervals")
    runs: list[dict[str, Any]] = []
    for name in [one.name for one in inputs.corridors]:
        for run in (run for part in parts for run in part.document["runs"] if run["corridor"] == name):
            last = runs[-1] if runs else None
            if last and [last[key] for key in ("corridor", "verdict", "why")] == [
                run[key] for key in ("corridor", "verdict", "why")
            ]:
                bounds = [one["margin_m"] for one in (last, run) if one["margin_m"] is not None]
                last |= {"end": run["end"], "end_proof": run["end_proof"]}
                last |= {
                    "instants": last["instants"] + run["instants"],
                    "margin_m": min(bounds, key=abs, default=None),
                    "model_error_m": max(last["model_error_m"], run["model_error_m"]),
                    "within_error": last["within_error"] or run["within_error"],
                }
            else:
                runs.append(dict(run))
    begin = int(steps[0])
    intervals = [_interval(inputs, run, begin) for run in runs]
    gos = [one for one in intervals if one["verdict"] == "GO"]
    eccentricities = encounter.seen(steps).eccentricities()
    known = eccentricities[np.isfinite(eccentricities)]
    document = {
        "start": _utc(begin),
        "stop": _utc(int(steps[-1])),
        "steps": len(steps),
        "chaser": encounter.chaser.name,
        "target": encounter.target.name,
        "go_s": math.fsum(one["end_s"] - one["begin_s"] for one in gos),
        "first_go": min((one["begin"] for one in gos), default=None),
        "largest_eccentricity": float(known.max()) if len(known) else None,
        "largest_half_width_m": _widest(encounter, steps),
        "intervals": intervals,
    }
    asked = {key for one in intervals for key in (one["begin_proof"], one["end_proof"]) if key}
    proofs = {key: found for part in parts for key, found in json.loads(part.data).items() if key in asked}
    artifacts = [picture(document), Artifact("intervals.csv", "text/csv", csv_of(_columns(intervals)))]
    if inputs.proofs:
        data = json.dumps(proofs, allow_nan=False, sort_keys=True).encode()
        artifacts.append(Artifact("proofs.json", "application/json", data))
    return ProcessOutput(document, tuple(artifacts))


def _widest(encounter: Encounter, steps: Nanoseconds) -> float | None:
    if encounter.boxes is None:
        return None
    half = encounter.boxes.half_widths(steps)[:, :3]
    known = half[np.isfinite(half)]
    return float(known.max()) if len(known) else None


def _interval(inputs: CommitTimelineInputs, run: dict[str, Any], begin: int) -> dict[str, Any]:
    return {
        "corridor": run["corridor"],
        "verdict": run["verdict"],
        "begin": _utc(run["begin"]),
        "end": _utc(run["end"]),
        "begin_s": (run["begin"] - begin) / SECOND,
        "end_s": (run["end"] - begin) / SECOND,
        "instants": run["instants"],
        "margin_m": run["margin_m"],
        "model_error_m": run["model_error_m"],
        "reason": _reason(run, inputs.horizon_s, inputs.confidence),
        "begin_proof": run["begin_proof"],
        "end_proof": run["end_proof"],
    }


def _reason(run: dict[str, Any], horizon: float, confidence: float | None) -> str:
    if run["verdict"] == "UNDECIDED":
        return f"undecided: {run['why']}"
    margin, error = run["margin_m"], ""
    if run["within_error"]:
        error = f"; at some instants the linear model itself may be off by more, up to {run['model_error_m']:.2g} m"
    if run["verdict"] == "GO":
        whom = "" if confidence is None else f" from the whole box that holds {confidence:.9g} of the starts"
        return (
            f"from every instant asked a thrust history stays for {horizon:g} s{whom}, "
            f"with {margin:.3g} m to spare{error}"
        )
    return (
        f"from no instant asked thrust held over steps of {DT_S:g} s stays for {horizon:g} s: each history is at some "
        f"time at least {-margin:.3g} m outside a face{error}"
    )


def _columns(intervals: Sequence[dict[str, Any]]) -> dict[str, list[Any]]:
    return {name: [one[name] for one in intervals] for name in intervals[0]}


def _utc(epoch: int) -> str:
    return shortened(text_of(np.array([epoch]), "UTC")[0])
