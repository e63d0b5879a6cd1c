"""Run passive-safety: verify each window, bracket the critical abort time, draw the tubes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from safestart.passive_safety.critical import CriticalAbort, critical_abort
from safestart.passive_safety.model import NEWTON, Mode, gain
from safestart.passive_safety.question import Finding, Question
from safestart.passive_safety.verify import Verification, verify
from safestart.processes.base import ProcessOutput
from safestart.processes.passive_safety.plots import arrays, drift_picture, powered_picture
from safestart.processes.passive_safety.spec import PassiveSafetyInputs
from safestart.processes.passive_safety.system import MINUTE, system_of
from safestart.processes.plotting import npz
from safestart.runtime.progress import Context

_UNITS = {
    "separation": ("m", 1.0),
    "thrust": ("N", 1.0 / NEWTON),
    "los": ("m", 1.0),
    "velocity": ("m/s", 1.0 / MINUTE),
    "velocity_disc": ("m/s", 1.0 / MINUTE),
}
"""Requirement -> unit on the wire, and the size of one model unit in it."""

NOTES = [
    "SAFE is a proof for the chosen model; round-off is included, differences between model and spacecraft are not.",
    "velocity is the published octagon around the speed limit, velocity_disc the true disc.",
]


def question_of(inputs: PassiveSafetyInputs) -> Question:
    """The first question in the model's units (m, min), without a window."""
    c, h = inputs.centre, inputs.half_widths
    return Question(
        (c.x_m, c.y_m, c.vx_m_s * MINUTE, c.vy_m_s * MINUTE),
        (h.x_m, h.y_m, h.vx_m_s * MINUTE, h.vy_m_s * MINUTE),
        inputs.horizon_min,
        None,
        inputs.box_half_width_m,
        system_of(inputs),
    )


def run(inputs: PassiveSafetyInputs, context: Context) -> ProcessOutput:
    """Findings per window, the critical abort time, two pictures and the tubes as arrays."""
    base = question_of(inputs)
    windows: list[tuple[float, float] | None] = [(w[0], w[1]) for w in inputs.abort_windows_min] or [None]
    total = len(windows) + 3.0
    # The verifier cannot measure its progress, but it can be asked to stop.
    quiet = Context(cancelled=context.cancelled)
    answers: list[Verification] = []
    for window in windows:
        context.step(
            len(answers), total, "no failure" if window is None else f"window {window[0]:g}-{window[1]:g} min"
        )
        answers.append(verify(replace(base, window=window), quiet, inputs.seed))
    critical = None
    if inputs.critical_abort:
        context.step(len(answers), total, "critical abort time")
        longer = replace(base, horizon=inputs.horizon_min + inputs.critical_drift_min)
        critical = critical_abort(longer, 0.0, inputs.horizon_min, quiet)
    context.step(total - 1.0, total, "pictures")
    entry = answers[0].reach.entry
    document = {
        "gains": {mode.value: gain(base.system.motion(mode)).tolist() for mode in (Mode.FAR, Mode.NEAR)},
        "crossing_first_min": entry.first if math.isfinite(entry.first) else None,
        "crossing_last_min": entry.last if math.isfinite(entry.last) else None,
        "crossed_faces": [branch.name for branch in entry.branches],
        "windows": [_window(answer) for answer in answers],
        "critical": None if critical is None else _critical(critical),
        "notes": NOTES,
    }
    last = answers[-1]
    artifacts = [powered_picture(last), npz("tubes.npz", arrays(last))]
    if last.question.window is not None:
        artifacts.insert(1, drift_picture(answers))
    return ProcessOutput(document, tuple(artifacts))


def _window(answer: Verification) -> dict[str, Any]:
    window = answer.question.window
    return {
        "abort_window_min": None if window is None else list(window),
        "findings": [_finding(name, finding) for name, finding in answer.findings.items()],
        "run_s": answer.run_s,
    }


def _finding(name: str, finding: Finding) -> dict[str, Any]:
    unit, scale = _UNITS[name]

    def scaled(value: float | None) -> float | None:
        return None if value is None else value * scale

    example = finding.counter_example
    return {
        "requirement": name,
        "verdict": finding.verdict.value,
        "unit": unit,
        "limit": scaled(finding.limit),
        "bound": scaled(finding.bound),
        "margin": scaled(finding.margin),
        "reason": finding.reason,
        "counter_example": None if example is None else _example(example, scale),
    }


def _example(example: Mapping[str, Any], scale: float) -> dict[str, Any]:
    x, y, vx, vy = example["start"]
    drift = "abort_min" in example
    return {
        "x_m": x,
        "y_m": y,
        "vx_m_s": vx / MINUTE,
        "vy_m_s": vy / MINUTE,
        "abort_min": example["abort_min"] if drift else None,
        "time_min": example["contact_min" if drift else "time_min"],
        "value": scale * example["distance_m" if drift else "value"],
    }


def _critical(critical: CriticalAbort) -> dict[str, Any]:
    found = critical.example
    example: dict[str, Any] | None = (
        None
        if found is None
        else {
            "start": found.start,
            "abort_min": found.abort,
            "contact_min": found.time,
            "distance_m": found.max_norm,
        }
    )
    return {
        "proved_until_min": critical.proved_until,
        "counter_example": None if example is None else _example(example, 1.0),
        "reason": critical.reason,
    }
