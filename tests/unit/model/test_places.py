"""Places of refusals hold names that a client wrote: no tags of unions."""

from __future__ import annotations

from typing import Any

import orjson
import pytest

from safestart.errors import InvalidInput
from safestart.processes.registry import process
from safestart_service.http.body import parse_body

SPEC = process("start-in-space")
ASKED: dict[str, Any] = {"starts": [{"position_m": [1, 30, 0]}], "omega_t_deg_s": 1.0, "a_max_m_s2": 0.1}
FACE = {"name": "a", "normal": [0, 0, 1], "offset_m": 9}


@pytest.mark.parametrize(
    ("changes", "field", "required"),
    [
        ({"orbit": {"semi_major_axis_m": 7e7, "eccentricity": 0.9}}, "orbit.eccentricity", "a number <= 0.8"),
        ({"orbit": {"semi_major_axis_m": 7e7}}, "orbit.eccentricity", "a value"),
        ({"orbit": {}}, "orbit.mean_motion_rad_s", "a value"),
        ({"corridor": {"faces": [FACE, FACE | {"frame": "x"}]}}, "corridor.faces.1.frame", "one of"),
        ({"corridor": {"faces": [FACE], "c_x": 1}}, "corridor.c_x", "no field of this name"),
        ({"corridor": {"faces": []}}, "corridor.faces", "at least 1 items"),
        ({"attitude": {"kind": "spin"}}, "attitude.rate_deg_s", "a value"),
        ({"attitude": {"kind": "euler"}}, "attitude.kind", "one of 'spin', 'torque_free', 'table'"),
        ({"attitude": {}}, "attitude.kind", "a value"),
        ({"attitude": 5}, "attitude", "an object"),
        ({"thrust": {"kind": "ball", "a_max_m_s2": 0}}, "thrust.a_max_m_s2", "a number >= 1e-06"),
        ({"keep_outs": [{"name": "k" * 41, "radius_m": 1}]}, "keep_outs.0.name", "at most 40 characters"),
        ({"keep_outs": [{"name": "k"}]}, "keep_outs.0.half_widths_m", "a value"),
        ({"horizon_s": 61}, "horizon_s", "a multiple of 2"),
    ],
)
def test_a_place_holds_names_of_fields_alone(changes: dict[str, Any], field: str, required: str) -> None:
    asked = ASKED | changes
    for refuse in (lambda: SPEC.parse(asked), lambda: parse_body(SPEC.inputs, orjson.dumps(asked))):
        with pytest.raises(InvalidInput) as refused:
            refuse()
        assert refused.value.field == field
        assert str(refused.value.required).startswith(required)


def test_a_rule_about_a_default_is_reported_at_its_field() -> None:
    """``engines`` is left out: its default is what cannot answer."""
    hull = {"kind": "thrusters", "directions": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "a_max_m_s2": [1, 1, 1]}
    with pytest.raises(InvalidInput) as refused:
        process("plane-benchmark").parse({"omega_t_deg_s": 1.0, "thrust": hull})
    assert (refused.value.field, refused.value.received) == ("engines", "nothing")
