"""The collision-avoidance process: its document, pictures and arrays, refusals, and nothing to fly."""

import io
import math
from typing import Any

import numpy as np
import pytest
from PIL import Image

from safestart.errors import Cancelled, InvalidInput
from safestart.processes.execute import Execution, execute
from safestart.processes.registry import process
from safestart.records.comparable import comparable
from safestart.runtime.progress import Context

pytestmark = pytest.mark.slow

QUICK: dict[str, Any] = {
    "grid": {"nodes_position": 13, "nodes_speed": 9, "kept": 3},
    "encounters": 30,
    "supervised": 6,
    "supervised_s": 1500,
    "threat_s": 120,
    "pilots": ["certified", "coast"],
    "adversaries": ["worst", "mirror"],
    "slices_m_s": [[-4, 0]],
    "capture_radial_m_s": [0],
    "states": [
        [150, 0, -6, 0],
        [150, 0, 0, -6, 0, 0],
        [400, 300, 0, 0],
        [0, 0, 300, 0, 0, 0],
        [150, 0, 130, -6, 0, 0],
    ],
}


@pytest.fixture(scope="module")
def done() -> Execution:
    return execute("collision-avoidance", QUICK)


def test_document_fits_its_schema_and_its_verdicts_follow_from_its_rows(done: Execution) -> None:
    outputs = done.document["outputs"]
    process("collision-avoidance").outputs.model_validate(outputs)
    rows = {(row["starts"], row["pilot"], row["adversary"]): row for row in outputs["encounters"]}
    assert rows["outside", "certified", "worst"]["lost"] == 0
    assert rows["outside", "certified", "worst"]["least_separation_m"] > 100.0
    assert rows["outside", "coast", "worst"]["lost"] == 30
    assert rows["inside", "certified", "mirror"]["lost"] == 30
    assert [row["verdict"] for row in outputs["requirements"]] == ["HELD"] * 5
    assert outputs["nodes"]["unsafe_called_safe_joined"] == 0
    assert outputs["supervisor"]["in_slot_at_the_end"] == 6
    assert outputs["capture"][0]["captured_percent"] == pytest.approx(47.0, abs=1.0)


def test_states_are_judged_in_the_plane_and_in_space(done: Execution) -> None:
    """Head-on at 6 m/s nobody evades, in no dimension; far away, or far above, there is no need to."""
    rows = done.document["outputs"]["states"]
    assert [row["state"] for row in rows] == QUICK["states"]
    assert [row["answer"] for row in rows] == ["PROVED_UNSAFE"] * 2 + ["PROVED_SAFE"] * 3
    assert all(row["least_m"] <= row["most_m"] for row in rows)
    # Nobody can get farther away in the plane than in space, where there is one direction more.
    assert rows[0]["most_m"] <= rows[1]["most_m"] <= 0.0


def test_a_price_of_fuel_saves_some() -> None:
    only = {"pilots": ["hj"], "adversaries": ["none"], "supervised": 0, "states": []}
    grid = {"grid": {"nodes_position": 9, "nodes_speed": 7, "kept": 2}}
    spent = [
        execute("collision-avoidance", QUICK | only | grid | {"fuel_price_s": price}).document["outputs"][
            "encounters"
        ][0]["mean_delta_v_m_s"]
        for price in (0.0, 5.0)
    ]
    assert 0.0 < spent[1] < 0.95 * spent[0]


def test_artifacts_open(done: Execution) -> None:
    files = {artifact.name: artifact.data for artifact in done.artifacts}
    pictures = {
        "unsafe.png",
        "encounters.png",
        "flights.png",
        "capture.png",
        "capture_space.png",
        "escape.png",
    }
    assert set(files) == pictures | {"sets.npz"}
    for name in pictures:
        with Image.open(io.BytesIO(files[name])) as picture:
            assert min(picture.size) > 300
    with np.load(io.BytesIO(files["sets.npz"])) as arrays:
        assert arrays["value_m"].shape == (13, 13, 9, 9)
        assert arrays["capture_time_s"].shape == (1, 61, 61)


def test_same_inputs_same_result(done: Execution) -> None:
    again = execute("collision-avoidance", QUICK)
    assert comparable(again.document["outputs"]) == comparable(done.document["outputs"])
    assert [a.sha256 for a in again.artifacts] == [a.sha256 for a in done.artifacts]


def test_the_papers_players_are_drawn_and_not_flown() -> None:
    chosen = QUICK | {"players": "paper", "grid": {"nodes_position": 9, "nodes_speed": 7, "kept": 2}}
    result = execute("collision-avoidance", chosen)
    outputs = result.document["outputs"]
    assert outputs["encounters"] == []
    assert {row["verdict"] for row in outputs["requirements"]} == {"UNDECIDED"}
    assert "unsafe.png" in {artifact.name for artifact in result.artifacts}


def test_too_few_starts_are_a_note_and_no_verdict() -> None:
    """Hardly a start lies within so narrow a band; and a slice beyond the box is not drawn. Disks, this time."""
    chosen = QUICK | {
        "band_m": 1e-6,
        "supervised": 0,
        "shape": "disk",
        "slices_m_s": [[9, 0]],
        "grid": {"nodes_position": 9, "nodes_speed": 7, "kept": 2},
    }
    outputs = execute("collision-avoidance", chosen).document["outputs"]
    assert any("starts near the boundary" in note for note in outputs["notes"])
    assert any("not drawn" in note for note in outputs["notes"])
    verdicts = [row["verdict"] for row in outputs["requirements"]]
    assert verdicts == ["UNDECIDED", "UNDECIDED", "HELD"]


def test_dismissal_and_progress() -> None:
    with pytest.raises(Cancelled):
        execute("collision-avoidance", QUICK, Context(cancelled=lambda: True))
    seen: list[float] = []

    def report(done: float, total: float, _: str) -> None:
        seen.append(done / total)

    tiny = {"players": "paper", "grid": {"nodes_position": 7, "nodes_speed": 5, "kept": 2}}
    execute("collision-avoidance", QUICK | tiny, Context(report))
    assert seen == sorted(seen)


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"thrust_m_s2": 0}, "thrust_m_s2"),
        ({"disturbance_m_s2": 0.2}, "disturbance_m_s2"),
        ({"keep_out_m": -1}, "keep_out_m"),
        ({"horizon_s": 0}, "horizon_s"),
        ({"shape": "ball"}, "shape"),
        ({"players": "both"}, "players"),
        ({"pilots": ["hj", "hj"]}, "pilots"),
        ({"pilots": []}, "pilots"),
        ({"adversaries": ["weather"]}, "adversaries.0"),
        ({"grid": {"nodes_position": 101, "nodes_speed": 61}}, "grid"),
        ({"grid": {"box": {"speed_m_s": 0}}}, "grid.box.speed_m_s"),
        ({"slices_m_s": [[1]]}, "slices_m_s.0"),
        ({"encounters": 20_000, "pilots": ["certified", "hj", "pd", "coast", "mode1", "mode2"],
          "adversaries": ["worst", "mirror", "pursuit", "random", "none"]}, "encounters"),
        ({"period_s": 10, "horizon_s": 5}, "period_s"),
        ({"slot": {"half_x_m": 0}}, "slot.half_x_m"),
        ({"states": [[1, 2, 3, 4, 5]]}, "states"),
        ({"states": [[1, 2, 3]]}, "states.0"),
        ({"states": [[0, 0, 0, math.inf]]}, "states.0.3"),
        ({"fuel_price_s": -1}, "fuel_price_s"),
        ({"unknown": 1}, "unknown"),
    ],
)  # fmt: skip
def test_bad_inputs_name_the_field(change: dict[str, Any], field: str) -> None:
    with pytest.raises(InvalidInput) as error:
        execute("collision-avoidance", QUICK | change)
    assert error.value.field == field
