"""The process backward-variants: documents that fit, sets that nest, refusals by name."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import pytest
from PIL import Image

from safestart.errors import InvalidInput
from safestart.processes.execute import execute
from safestart.processes.registry import process

CWH: dict[str, Any] = {
    "system": {"kind": "planar_cwh"},
    "input_half_widths": [0.1, 0.1],
    "steps": 6,
    "target": [0, 30, 0, 0],
    "target_half_widths": [3, 3, 0.2, 0.2],
    "input_disturbance_half_widths": [0.01, 0.01],
    "input_noise_sigma": [0.005, 0.005],
    "directions": 8,
}


def test_the_double_integrator_of_figure_1() -> None:
    result = execute("backward-variants", process("backward-variants").example)
    (system,) = result.document["outputs"]["systems"]
    rows = {row["name"]: row for row in system["variants"]}
    assert rows["nominal"]["area"] == pytest.approx(41.7)
    assert all(row["beyond_nominal"] <= 1e-9 for row in rows.values())
    assert rows["robust_open_loop"]["area"] < rows["robust_feedback"]["area"] < rows["nominal"]["area"]
    assert system["flown"]["probability_low"] >= system["flown"]["required"]
    names = {artifact.name for artifact in result.artifacts}
    assert names == {"outlines.npz", "backward_variants.png"}
    for artifact in result.artifacts:
        if artifact.name.endswith(".png"):
            with Image.open(io.BytesIO(artifact.data)) as image:
                assert min(image.size) > 400
        else:
            with np.load(io.BytesIO(artifact.data)) as arrays:
                assert arrays["system_nominal"].shape == (10, 2)


def test_cwh_beside_the_double_integrator() -> None:
    outputs = execute("backward-variants", CWH).document["outputs"]
    assert [system["name"] for system in outputs["systems"]] == ["cwh", "double_integrator"]
    nominal = outputs["coupling_ratios"][0]
    assert nominal["variant"] == "nominal"
    assert 1.0 < nominal["first"] < 1.01
    section = execute("backward-variants", CWH | {"section": [None, None, 0, 0]}).document["outputs"]
    for whole, part in zip(outputs["systems"], section["systems"], strict=True):
        assert part["cloud"] is None
        for row, cut in zip(whole["variants"], part["variants"], strict=True):
            assert cut["high"][0] < row["high"][0]
            assert cut["beyond_nominal"] <= 1e-6


def test_a_target_too_small_is_empty_and_said_to_be() -> None:
    asked = process("backward-variants").example | {"target_half_widths": [0.1, 0.1], "cloud_draws": 0}
    (system,) = execute("backward-variants", asked).document["outputs"]["systems"]
    rows = {row["name"]: row for row in system["variants"]}
    assert rows["nominal"]["code"] == "ok"
    assert rows["robust_open_loop"]["code"] == "empty"
    assert rows["robust_open_loop"]["area"] is None
    assert system["flown"] is None


@pytest.mark.parametrize(
    ("wrong", "field"),
    [
        ({"target": [0, 0, 0]}, "target"),
        ({"system": {"a": [[1, 0, 0], [0, 1, 0]], "b": [[0], [1]], "kind": "matrices"}}, "system"),
        ({"system": {"a": [[1, 1], [1, 1]], "b": [[0], [1]], "kind": "matrices"}}, "a"),
        ({"plane": [0, 0]}, "plane"),
        ({"section": [1, None]}, "section"),
        ({"risk": 0}, "risk"),
        (CWH | {"steps": 60}, "steps"),
    ],
)
def test_bad_input_is_named(wrong: dict[str, Any], field: str) -> None:
    with pytest.raises(InvalidInput, match=field):
        execute("backward-variants", wrong)
