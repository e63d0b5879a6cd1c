"""The process hold-region: flights from the boundary hold, flights from beyond it do not."""

from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image

from safestart.errors import InvalidInput
from safestart.processes.execute import execute


def test_flights_from_the_boundary_hold_and_from_beyond_do_not() -> None:
    asked = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "flights": 12, "phase_deg": 25}
    result = execute("hold-region", asked)
    outputs = result.document["outputs"]
    assert outputs["code"] == "ok"
    assert outputs["spectral_radius"] < 1.0
    rows = {row["set"]: row for row in outputs["flown"]}
    assert rows["ellipsoid"]["held"] == rows["polyhedron"]["held"] == 12
    assert rows["beyond_polyhedron"]["held"] == 0
    assert rows["regime"]["held"] == rows["regime"]["starts"] == 12
    assert outputs["regime"]["code"] == "ok"
    assert outputs["regime"]["limited_by"] == "filter"
    assert rows["regime"]["least_margin_m"] > 1.0
    # The boundary is one: some flight from it has next to no room left in thrust or corridor.
    assert rows["polyhedron"]["most_thrust_m_s2"] > 0.0997
    assert outputs["polyhedron"]["volume_ratio"] > 50.0
    files = {artifact.name: artifact.data for artifact in result.artifacts}
    with np.load(io.BytesIO(files["hold_region.npz"])) as arrays:
        assert (arrays["vertices"] @ arrays["rows"].T <= arrays["bounds"] + 1e-7).all()
        # An error at rest in the turning frame has the velocity omega x position in LVLH.
        assert arrays["rows_body"].shape == arrays["rows"].shape
    with Image.open(io.BytesIO(files["hold_region.png"])) as image:
        assert min(image.size) > 400


def test_a_hold_beyond_the_thrust_is_said_to_be_none() -> None:
    outputs = execute("hold-region", {"omega_t_deg_s": 20, "a_max_m_s2": 0.05}).document["outputs"]
    assert outputs["code"] == "no_hold"
    assert outputs["ellipsoid"] is None
    assert outputs["polyhedron"] is None
    assert outputs["flown"] == []
    assert outputs["regime"]["code"] == "unstable"
    assert outputs["reference_thrust_m_s2"] > 0.05


def test_the_papers_weights_keep_nothing_at_three_degrees_a_second() -> None:
    asked = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "flights": 2, "preset": "paper"}
    outputs = execute("hold-region", asked).document["outputs"]
    assert outputs["code"] == "ok"
    assert outputs["regime"]["code"] == "unstable"
    assert outputs["regime"]["spectral_radius"] > 1.0
    assert [row["set"] for row in outputs["flown"]] == ["ellipsoid", "polyhedron", "beyond_polyhedron"]


def test_bad_input_is_named() -> None:
    with pytest.raises(InvalidInput, match="dt_s"):
        execute("hold-region", {"omega_t_deg_s": 50, "a_max_m_s2": 5, "dt_s": 4})
    with pytest.raises(InvalidInput, match="hold_clearance_m"):
        execute("hold-region", {"omega_t_deg_s": 1, "a_max_m_s2": 0.1, "hold_clearance_m": 0})
