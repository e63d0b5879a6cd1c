"""Merge a sweep: sums, records, the worst flights flown again with their trajectories, pictures."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np

from safestart.attitude.spin import spin_of
from safestart.campaign.part import Part
from safestart.campaign.records import MEDIA_TYPE
from safestart.exact.decide import decide
from safestart.exact.prove import proof_of
from safestart.exact.question import Question
from safestart.model.scenario import Floats
from safestart.processes.base import Artifact, ProcessOutput
from safestart.processes.plotting import npz
from safestart.processes.sweep.cases import Cases, scenario_of
from safestart.processes.sweep.fleet import fly_one
from safestart.processes.sweep.inputs import SweepInputs
from safestart.processes.sweep.plots import Path, confusion_picture, table_picture, worst_picture
from safestart.processes.sweep.study import study_of, summary
from safestart.processes.wire import DT_S
from safestart.runtime.progress import Context


def merge(inputs: SweepInputs, parts: Sequence[Part], context: Context) -> ProcessOutput:
    """Outputs and artifacts of a sweep."""
    document = summary(inputs, [part.document for part in parts])
    context.step(1, 4, "sums")
    paths = {name: [_path(inputs, name, case) for case in cases] for name, cases in document["worst"].items()}
    document["false_go"], proof = _proved(inputs, document["false_go"])
    context.step(2, 4, "worst flights")
    artifacts = [confusion_picture(inputs, document["confusion"])]
    if document["cells"]:
        artifacts.append(table_picture(inputs, document["cells"]))
    if any(paths.values()):
        artifacts.append(worst_picture(inputs, paths))
        artifacts.append(npz("trajectories.npz", _arrays(paths)))
    context.step(3, 4, "pictures")
    records = study_of(inputs).recorded(parts)
    if records:
        artifacts.append(Artifact("cases.parquet", MEDIA_TYPE, records))
    if proof is not None:
        artifacts.append(Artifact("false_go_proof.json", "application/json", proof))
    return ProcessOutput(document, tuple(artifacts))


def _path(inputs: SweepInputs, controller: str, case: dict[str, Any]) -> Path:
    """Fly a case again, as in its shard."""
    cases = _single(inputs, case)
    path = fly_one(inputs, controller, cases, 0).paths[0]
    return case, path.times, path.seen_from(spin_of(cases.scenario.target))[:, :2]


def _single(inputs: SweepInputs, case: dict[str, Any]) -> Cases:
    scenario = scenario_of(inputs, case["omega_t_deg_s"], case["a_max_m_s2"])
    point = np.array([[case["x_m"], case["y_m"]]])
    number, none = np.array([case["case"]]), np.full(1, -1)
    return Cases(case["omega_t_deg_s"], case["a_max_m_s2"], scenario, number, none, point)


def _proved(inputs: SweepInputs, false_go: list[dict[str, Any]]) -> tuple[list[dict[str, Any]], bytes | None]:
    """The false GOs with their proved bounds, worst first, and the worst one's proof."""
    found = []
    for case in false_go:
        cases = _single(inputs, case)
        question = Question(cases.scenario, DT_S, inputs.steps)
        state = np.array([case["x_m"], case["y_m"], 0.0, 0.0])
        answer = decide(question, state)
        found.append(({**case, "margin_m": answer.margin_m}, question, state, answer))
    found.sort(key=lambda entry: (entry[0]["margin_m"], entry[0]["case"]))
    proof = None
    if found:
        _, question, state, answer = found[0]
        proof = json.dumps(proof_of(question, state, answer), indent=1).encode()
    return [entry[0] for entry in found], proof


def _arrays(paths: dict[str, list[Path]]) -> dict[str, Floats]:
    arrays: dict[str, Floats] = {}
    for name, flights in paths.items():
        for case, times, body in flights:
            key = f"{name}_{case['case']}"
            arrays[f"{key}_time_s"], arrays[f"{key}_body_m"] = times, body
    return arrays
