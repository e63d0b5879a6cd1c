"""The end of a sweep: sums, records, the worst flights once more with their trajectories, pictures."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np

from safestart.exact.decide import decide
from safestart.exact.prove import proof_of
from safestart.exact.question import Question
from safestart.model.scenario import Floats
from safestart.processes.base import Artifact, ProcessOutput
from safestart.processes.plotting import npz
from safestart.processes.sharding import Part
from safestart.processes.sweep.aggregate import Total, public
from safestart.processes.sweep.cases import Cases, scenario_of
from safestart.processes.sweep.fleet import fly_one
from safestart.processes.sweep.plots import confusion_picture, table_picture, worst_picture
from safestart.processes.sweep.records import MEDIA_TYPE, joined
from safestart.processes.sweep.spec import SweepInputs
from safestart.processes.wire import DT_S
from safestart.runtime.progress import Context

Path = tuple[dict[str, Any], Floats, Floats]
"""A worst case with the times (T,) and body-frame positions (T, 2) of its flight."""


def merge(inputs: SweepInputs, parts: Sequence[Part], context: Context) -> ProcessOutput:
    """Outputs and artifacts of a sweep."""
    total = Total(inputs)
    for part in parts:
        total.add(part.document)
    context.step(1, 4, "sums")
    paths = {name: [_path(inputs, name, case) for case in cases] for name, cases in total.worst.items()}
    proof = _false_go(inputs, total)
    document = total.outputs()
    context.step(2, 4, "worst flights")
    artifacts = [confusion_picture(inputs, document["confusion"])]
    if document["cells"]:
        artifacts.append(table_picture(inputs, document["cells"]))
    if any(paths.values()):
        artifacts.append(worst_picture(inputs, paths))
        artifacts.append(npz("trajectories.npz", _arrays(paths)))
    context.step(3, 4, "pictures")
    if any(part.data for part in parts):
        records = joined(inputs, (part.data for part in parts))
        artifacts.append(Artifact("cases.parquet", MEDIA_TYPE, records))
    if proof is not None:
        artifacts.append(Artifact("false_go_proof.json", "application/json", proof))
    return ProcessOutput(document, tuple(artifacts))


def _path(inputs: SweepInputs, controller: str, case: dict[str, Any]) -> Path:
    """Fly a case once more, as in its shard."""
    cases = _single(inputs, case)
    flown = fly_one(inputs, controller, cases, 0)
    times, states = np.array(flown.times), np.array(flown.states)
    angle = cases.scenario.target.tumble_rate * times
    x, y = states[:, 0], states[:, 1]
    body = np.stack([np.cos(angle) * x + np.sin(angle) * y, np.cos(angle) * y - np.sin(angle) * x], axis=1)
    return case, times, body


def _single(inputs: SweepInputs, case: dict[str, Any]) -> Cases:
    scenario = scenario_of(inputs, case["omega_t_deg_s"], case["a_max_m_s2"])
    point = np.array([[case["x_m"], case["y_m"]]])
    number, none = np.array([case["case"]]), np.full(1, -1)
    return Cases(case["omega_t_deg_s"], case["a_max_m_s2"], scenario, number, none, point)


def _false_go(inputs: SweepInputs, total: Total) -> bytes | None:
    """Put the proved bound into each false GO, worst first, and return the worst one's proof."""
    found = []
    for case in total.false_go:
        cases = _single(inputs, case)
        question = Question(cases.scenario, DT_S, inputs.steps)
        state = np.array([case["x_m"], case["y_m"], 0.0, 0.0])
        answer = decide(question, state)
        found.append(({**public(case), "margin_m": answer.margin_m}, question, state, answer))
    found.sort(key=lambda entry: (entry[0]["margin_m"], entry[0]["case"]))
    total.false_go = [entry[0] for entry in found]
    if not found:
        return None
    _, question, state, answer = found[0]
    return json.dumps(proof_of(question, state, answer), indent=1).encode()


def _arrays(paths: dict[str, list[Path]]) -> dict[str, Floats]:
    arrays: dict[str, Floats] = {}
    for name, flights in paths.items():
        for case, times, body in flights:
            key = f"{name}_{case['case']}"
            arrays[f"{key}_time_s"], arrays[f"{key}_body_m"] = times, body
    return arrays
