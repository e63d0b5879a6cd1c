"""Run sweep-in-space: draw the starts, ask the exact question of each, fly it, compare."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from safestart.campaign.case import Case
from safestart.campaign.rates import Confusion
from safestart.engines.space.monte_carlo import FlownInSpace
from safestart.errors import UnfitResult
from safestart.exact.answer import Verdict
from safestart.exact.space.decide import decide_in_space
from safestart.exact.space.question import SpaceQuestion, starts_in_lvlh
from safestart.exact.space.watch import space_watch_of
from safestart.model.scenario import Floats
from safestart.processes.base import ProcessOutput
from safestart.processes.start_in_space.question import stay_in
from safestart.processes.sweep_in_space.plots import margins
from safestart.processes.sweep_in_space.spec import SweepInSpaceInputs
from safestart.processes.wire import finite
from safestart.runtime.progress import Context

MOST_WORST = 10


def run(inputs: SweepInSpaceInputs, context: Context) -> ProcessOutput:
    """Decide and fly every start that lies inside the faces."""
    question = stay_in(inputs, inputs.horizon_s)
    states = drawn(inputs, question)
    watch = space_watch_of(question)
    inside = (watch.offsets - states[:, :3] @ watch.normals.T >= 0.0).all(axis=1)
    flown = FlownInSpace(question, (inputs.position_sigma_m, inputs.velocity_sigma_m_s), inputs.seed)
    rows: list[dict[str, Any]] = []
    for case in np.nonzero(inside)[0].tolist():
        answer = decide_in_space(question, states[case])
        flight = flown.fly(states[case], case)
        if not math.isfinite(float(flight.margin[0])):
            raise UnfitResult(f"case {case}: the flight left the floating-point numbers", required="numbers")
        rows.append(
            {
                "case": case,
                "position_m": states[case, :3].tolist(),
                "velocity_m_s": states[case, 3:].tolist(),
                "exact": answer.verdict.value,
                "exact_margin_m": finite(answer.proved_m),
                "flown_margin_m": float(flight.margin[0]),
                "violated_at_s": finite(float(flight.violated_at[0])),
                "delta_v_m_s": float(flight.delta_v[0]),
            }
        )
        context.step(case + 1, inputs.cases, "starts")
    go = [row["exact"] == Verdict.GO.value for row in rows]
    stayed = [row["flown_margin_m"] >= 0.0 and row["violated_at_s"] is None for row in rows]
    decided = [row["exact"] != Verdict.UNDECIDED.value for row in rows]
    counts = [
        sum(d and g is claim and s is fact for d, g, s in zip(decided, go, stayed, strict=True))
        for claim, fact in ((True, True), (True, False), (False, True), (False, False))
    ]
    # Lost flights from starts with a proof first, then the narrowest.
    order = sorted(range(len(rows)), key=lambda k: (not (go[k] and not stayed[k]), rows[k]["flown_margin_m"]))
    return ProcessOutput(
        {
            "cases": inputs.cases,
            "outside": int(np.count_nonzero(~inside)),
            "undecided": decided.count(False),
            "confusion": {
                "exact": {name: Confusion("exact", name).said(counts) for name in inputs.controllers}
            },
            "flown_cases": [row["case"] for row in rows],
            "exact_go": go,
            "stayed": stayed,
            "flown_margin_m": [row["flown_margin_m"] for row in rows],
            "delta_v_m_s": [row["delta_v_m_s"] for row in rows],
            "worst": [rows[k] for k in order[:MOST_WORST]],
        },
        (margins(rows),),
    )


def drawn(inputs: SweepInSpaceInputs, question: SpaceQuestion) -> Floats:
    """The starts (cases, 6), LVLH, m and m/s; a case's depends on its number and the seed alone."""
    middle = np.array(inputs.centre.position_m + inputs.centre.velocity_m_s)
    half = np.array(inputs.position_half_width_m + inputs.velocity_half_width_m_s)
    shares = np.array([Case(k, inputs.seed).generator().uniform(-1.0, 1.0, 6) for k in range(inputs.cases)])
    states: Floats = middle + shares * half
    if inputs.centre.frame == "body":
        return starts_in_lvlh(question.attitude, states[:, :3], states[:, 3:])
    return states
