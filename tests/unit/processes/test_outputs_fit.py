"""A result is stored only if it matches its process description exactly, as JSON."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from distributed import Client
from pydantic import Field

from safestart.errors import UnfitResult
from safestart.model.scenario import Rest
from safestart.processes import registry
from safestart.processes.base import ProcessOutput, ProcessSpec, WireModel
from safestart.processes.execute import execute
from safestart.processes.sharding import Part, Sharding
from safestart.runtime.progress import Context
from safestart_worker.cluster.task import run_job

HERE = __name__


class Inputs(WireModel):
    """What the outputs are to differ in, by name."""

    change: dict[str, Any] = Field(default_factory=dict)


class Row(WireModel):
    """A row."""

    name: str
    share: float | None


class Outputs(WireModel):
    """One of each."""

    count: int
    margin_m: list[float | None]
    rest: Rest
    rows: list[Row]
    note: str | None = None


FIT: dict[str, Any] = {
    "count": 2,
    "margin_m": [1.5, None, 2],
    "rest": "lvlh",
    "rows": [{"name": "a", "share": 0.5}],
}
UNFIT: dict[str, tuple[Any, str]] = {
    "text for a number": ({"margin_m": ["1.5"]}, "outputs.margin_m.0"),
    "not a number": ({"margin_m": [1.0, float("nan")]}, "outputs.margin_m.1"),
    "infinity": ({"rows": [{"name": "a", "share": float("inf")}]}, "outputs.rows.0.share"),
    "a fraction for a count": ({"count": 2.0}, "outputs.count"),
    "a truth value for a number": ({"margin_m": [True]}, "outputs.margin_m.0"),
    "an unknown word": ({"rest": "inertial"}, "outputs.rest"),
    "a field too many": ({"verdict": "GO"}, "outputs.verdict"),
    "a member too few": ({"rows": [{"name": "a"}]}, "outputs.rows.0.share"),
    "no JSON": ({"count": np.int64(2)}, ""),
}
RETURNED: dict[str, Any] = {}


def run(inputs: Inputs, context: Context) -> ProcessOutput:
    """The outputs that fit, changed as asked, or whatever a test put into ``RETURNED``."""
    context.step(1, 1)
    return ProcessOutput(FIT | inputs.change | RETURNED)


def split(_: Inputs) -> list[dict[str, Any]]:
    return [{}]


def shard(_: dict[str, Any], __: Context) -> Part:
    return Part({})


def merged(inputs: Inputs, _: list[Part], context: Context) -> ProcessOutput:
    return run(inputs, context)


PLAIN = ProcessSpec("unfit", "Unfit", "May not fit.", Inputs, Outputs, run=f"{HERE}:run")
SHARDED = ProcessSpec(
    "unfit",
    "Unfit",
    "May not fit.",
    Inputs,
    Outputs,
    sharding=Sharding(f"{HERE}:split", f"{HERE}:shard", f"{HERE}:merged", f"{HERE}:split"),
)


@pytest.fixture(params=[PLAIN, SHARDED], ids=["plain", "sharded"])
def spec(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> ProcessSpec:
    """The process, known by its id."""
    monkeypatch.setitem(registry._SPECS, "unfit", HERE)
    monkeypatch.setattr(f"{HERE}.SPEC", request.param, raising=False)
    registry.process.cache_clear()
    monkeypatch.setattr(f"{HERE}.RETURNED", {})
    yield request.param
    registry.process.cache_clear()


def test_what_fits_is_kept_as_it_is(spec: ProcessSpec) -> None:
    outputs = execute(spec.id, {}).document["outputs"]
    assert json.dumps(outputs) == json.dumps(FIT), "2 stays 2, and no default is added"


@pytest.mark.parametrize("what", UNFIT)
def test_what_does_not_fit_is_named(spec: ProcessSpec, what: str) -> None:
    change, field = UNFIT[what]
    RETURNED.update(change)
    with pytest.raises(UnfitResult, match=field or "JSON") as refused:
        execute(spec.id, {})
    assert (refused.value.field or "") == field
    assert refused.value.required


def test_its_job_fails_with_a_problem_that_says_so(spec: ProcessSpec) -> None:
    with Client(processes=False, n_workers=1, threads_per_worker=1, dashboard_address=None) as client:
        good = client.submit(run_job, spec.id, {}, "one", "topic").result()
        bad = client.submit(run_job, spec.id, {"change": {"count": "two"}}, "two", "topic").result()
    assert (good.problem, good.document["outputs"]) == (None, FIT)
    assert (bad.document, bad.artifacts) == (None, ())
    assert bad.problem["type"] == "urn:safestart:problem:unfit-result"
    assert bad.problem["field"] == "outputs.count"
    assert bad.problem["required"] == "an integer"
    assert bad.problem["received"] == "'two'"
