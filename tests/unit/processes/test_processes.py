"""Processes as pure functions: documents that fit their schema, artifacts that open, same seed same result."""

import io
import json

import numpy as np
import pytest
from PIL import Image

from safestart.errors import Cancelled, InvalidInput, NotFound
from safestart.processes.execute import execute
from safestart.processes.registry import PROCESS_IDS, process
from safestart.records.comparable import comparable
from safestart.runtime.progress import Context

QUICK = {
    "omega_t_deg_s": 3,
    "a_max_m_s2": 0.1,
    "grid": {"nx": 15, "ny": 13, "y_max_m": 80},
    "engines": ["analytical", "exact", "backward", "forward", "monte_carlo"],
}


@pytest.mark.parametrize("process_id", PROCESS_IDS)
def test_spec_is_complete(process_id: str) -> None:
    spec = process(process_id)
    assert spec.id == process_id
    assert spec.title
    assert spec.description
    parsed = spec.parse(spec.example)
    assert spec.parse(parsed.model_dump(mode="json")) == parsed
    json.dumps(spec.inputs.model_json_schema())
    json.dumps(spec.outputs.model_json_schema())


def test_benchmark_document_fits_its_schema_and_says_where_it_came_from() -> None:
    result = execute("benchmark", QUICK)
    process("benchmark").outputs.model_validate(result.document["outputs"])
    rows = {row["engine"]: row for row in result.document["outputs"]["rows"]}
    assert list(rows) == QUICK["engines"]
    assert rows["exact"]["iou_vs_exact"] == 1.0
    assert rows["exact"]["iou_vs_hj"] is None, "no HJ was asked for, so nothing is said about it"
    assert rows["analytical"]["confusion"]["precision"] == 1.0
    assert rows["analytical"]["violation_vs_exact"] == 0.0
    assert result.document["provenance"]["packages"]["numpy"]
    assert result.document["inputs"]["horizon_s"] == 40.0


def test_benchmark_artifacts_open_and_agree_with_the_document() -> None:
    result = execute("benchmark", QUICK)
    by_name = {a.name: a for a in result.artifacts}
    assert set(by_name) == {"overlay.png", "agreement.png", "maps.npz"}
    for name in ("overlay.png", "agreement.png"):
        with Image.open(io.BytesIO(by_name[name].data)) as picture:
            assert min(picture.size) > 300
    with np.load(io.BytesIO(by_name["maps.npz"].data)) as arrays:
        for row in result.document["outputs"]["rows"]:
            assert arrays[f"{row['engine']}_mask"].sum() == row["cells"]
        assert arrays["inside"].sum() == result.document["outputs"]["corridor_cells"]


def test_same_inputs_same_result_times_aside() -> None:
    one, two = execute("benchmark", QUICK), execute("benchmark", QUICK)
    assert comparable(one.document["outputs"]) == comparable(two.document["outputs"])
    assert [a.sha256 for a in one.artifacts] == [a.sha256 for a in two.artifacts]


def test_progress_is_monotone_and_ends() -> None:
    seen: list[float] = []
    execute("benchmark", QUICK, Context(lambda done, total, _: seen.append(done / total)))
    assert seen == sorted(seen)
    assert seen[-1] > 0.7
    assert len(seen) > 5


def test_dismissal_stops_the_process() -> None:
    with pytest.raises(Cancelled):
        execute("coverage", {}, Context(cancelled=lambda: True))


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"omega_t_deg_s": -1}, "omega_t_deg_s"),
        ({"omega_t_deg_s": "fast"}, "omega_t_deg_s"),
        ({"a_max_m_s2": 0}, "a_max_m_s2"),
        ({"a_max_m_s2": 100}, "a_max_m_s2"),
        ({"a_max_m_s2": float("nan")}, "a_max_m_s2"),
        ({"engines": []}, "engines"),
        ({"engines": ["oracle"]}, "engines.0"),
        ({"engines": ["exact", "exact"]}, "engines"),
        ({"grid": {"nx": 0, "ny": 31}}, "grid.nx"),
        ({"grid": {"nx": 100000, "ny": 31}}, "grid.nx"),
        ({"grid": {"nx": 500, "ny": 500}}, "grid"),
        ({"grid": {"y_max_m": 0.2}}, "grid.y_max_m"),
        ({"horizon_s": 41}, "horizon_s"),
        ({"horizon_s": float("inf")}, "horizon_s"),
        ({"mean_motion_rad_s": 0.063}, "mean_motion_rad_s"),
        ({"seed": -1}, "seed"),
        ({"omega": 3}, "omega"),
    ],
)
def test_bad_inputs_name_the_field(change: dict[str, object], field: str) -> None:
    with pytest.raises(InvalidInput) as error:
        execute("benchmark", QUICK | change)
    assert error.value.field == field
    assert "received" in error.value.detail


def test_unknown_process_names_the_known() -> None:
    with pytest.raises(NotFound, match="benchmark"):
        execute("oracle", {})


def test_no_tumble_no_limit() -> None:
    result = execute("certificate", {"omega_t_deg_s": 0, "a_max_m_s2": 0.1})
    assert result.document["outputs"]["r_sync_m"] is None
    assert result.document["outputs"]["safe_fraction"] == pytest.approx(1.0, abs=0.01)
