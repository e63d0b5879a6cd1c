"""One shard of a sweep: draw, certify, fly, count."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Any

from safestart.campaign.part import Part
from safestart.campaign.table import Table
from safestart.processes.sweep import judge
from safestart.processes.sweep.cases import Cases, cases_of
from safestart.processes.sweep.fleet import JudgedFlights, fly_all
from safestart.processes.sweep.inputs import SweepInputs
from safestart.processes.sweep.judge import UNASKED, Verdicts
from safestart.processes.sweep.outcomes import table_of
from safestart.processes.sweep.study import study_of
from safestart.runtime.progress import Context


def shard(part: dict[str, Any], context: Context) -> Part:
    """Run one shard."""
    begin = time.perf_counter()
    inputs = SweepInputs.model_validate(part["inputs"])
    study = study_of(inputs)
    groups = cases_of(inputs, part["pieces"])
    count = sum(len(cases.points) for cases in groups)
    total = count * len(inputs.controllers)
    exact_left = math.ceil(inputs.exact_cases * count / inputs.total)
    tables = []
    done = 0
    for cases in groups:
        flown: dict[str, JudgedFlights] = {}
        for controller in inputs.controllers:
            flown[controller] = fly_all(inputs, controller, cases, _poll(context, done, total, controller))
            done += len(cases.points)
        asked = len(cases.points) if inputs.distribution == "grid" else min(exact_left, len(cases.points))
        exact_left -= asked
        tables.append(table_of(study, cases, _verdicts(inputs, cases, flown, asked), flown))
    table = Table.joined(study.columns, tables)
    return study.part(part["number"], table, time.perf_counter() - begin)


def _poll(context: Context, done: int, total: int, label: str) -> Callable[[int], None]:
    return lambda count: context.step(done + count, total, label)


def _verdicts(
    inputs: SweepInputs, cases: Cases, flown: dict[str, JudgedFlights], asked: int
) -> dict[str, Verdicts]:
    out: dict[str, Verdicts] = {}
    for certificate in inputs.certificates:
        if certificate != "exact":
            out[certificate] = judge.closed_form(certificate, cases)
            continue
        known = [outcome.verdict for outcome in flown.values() if (outcome.verdict != UNASKED).all()]
        out[certificate] = known[0] if known else judge.exact(cases, inputs.steps, asked)
    return out
