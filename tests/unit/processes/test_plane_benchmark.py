"""plane-benchmark: rows that measure masks, pictures, and refusals with the request."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import pytest

from safestart.errors import InvalidInput
from safestart.processes.execute import execute
from safestart.processes.registry import process
from safestart.runtime.progress import Context

SPEC = process("plane-benchmark")
SMALL: dict[str, Any] = {**SPEC.example, "across": 5, "along": 5}
SIX = {
    "kind": "thrusters",
    "directions": [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]],
    "a_max_m_s2": [0.1] * 6,
}


def test_rows_measure_the_masks_of_a_plane_of_position_and_velocity() -> None:
    plane = {
        "name": "approach",
        "origin_m": [1, 20, 0],
        "first": {"direction": [0, 1, 0], "low": -15, "high": 60},
        "second": {"kind": "velocity", "direction": [0, 1, 0], "low": -8, "high": 8},
    }
    made = execute(SPEC.id, SMALL | {"plane": plane}, Context())
    found = made.document["outputs"]
    artifacts = {artifact.name: artifact.data for artifact in made.artifacts}
    arrays = np.load(io.BytesIO(artifacts["maps.npz"]))
    assert found["axes"] == ["position along y, body [m]", "velocity along y, body [m/s]"]
    assert artifacts["overlay.png"].startswith(b"\x89PNG")
    assert found["inside_cells"] == arrays["inside"].sum()
    assert found["cell_area"] == pytest.approx(75 / 4 * 4.0)
    exact = arrays["exact_mask"]
    for row in found["rows"]:
        mask = arrays[f"{row['engine']}_mask"]
        assert row["code"] == "ok"
        assert row["cells"] == mask.sum() > 0
        assert row["area"] == pytest.approx(found["cell_area"] * mask.sum())
        assert row["iou_vs_exact"] == pytest.approx((mask & exact).sum() / (mask | exact).sum())
        assert row["violation_vs_exact"] == pytest.approx((mask & ~exact).sum() / mask.sum())
    # A start at rest and one that comes at 8 m/s differ.
    assert (exact[2] != exact[4]).any() or (exact[2] != exact[0]).any()


@pytest.mark.parametrize(
    ("changes", "field", "said"),
    [
        ({"engines": ["exact", "hamilton_jacobi"]}, None, "hamilton_jacobi does not answer here: its grid"),
        ({"engines": ["certified"]}, None, "certified does not answer here"),
        ({"engines": ["oracle"]}, None, "one of certified"),
        ({"engines": ["backward"], "a_max_m_s2": None, "thrust": SIX}, None, "axis by axis"),
        ({"engines": ["exact", "exact"]}, "engines", "at most once"),
        ({"engines": []}, "engines", "at least 1"),
        ({"across": 200, "along": 200}, None, "at most 2601"),
        ({"across": 1}, "across", "2"),
        ({"horizon_s": 41}, "horizon_s", "multiple"),
    ],
)
def test_refused_with_the_request(changes: dict[str, Any], field: str | None, said: str) -> None:
    with pytest.raises(InvalidInput, match=said) as refused:
        SPEC.parse(SMALL | changes)
    assert field is None or refused.value.field == field


@pytest.mark.parametrize(
    ("first", "field"),
    [
        ({"direction": [0, 0, 0], "low": 0, "high": 1}, "plane.first.direction"),
        ({"direction": [1, 0, 0], "low": 1, "high": 1}, "plane.first.low"),
        ({"direction": [0, 2, 0], "low": 0, "high": 1}, "plane.second.direction"),
    ],
)
def test_what_is_no_plane_names_its_field(first: dict[str, Any], field: str) -> None:
    plane = {"name": "p", "first": first, "second": {"direction": [0, 1, 0], "low": 0, "high": 50}}
    with pytest.raises(InvalidInput) as refused:
        execute(SPEC.id, SMALL | {"plane": plane}, Context())
    assert refused.value.field == field
