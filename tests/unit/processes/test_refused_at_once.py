"""What no job could answer is refused before one is queued, under the field's name on the wire."""

from typing import Any

import pytest

from safestart.errors import InvalidInput
from safestart.processes.registry import process

ONE = [[float(i == j) for j in range(6)] for i in range(6)]
BENT = [[*row[:1], 2.0 * (i == 0) + row[1], *row[2:]] for i, row in enumerate(ONE)]
FIRST = {"time_s": 0, "impulse_m_s": [0.0178, 0, 0]}
SECOND = {"time_s": 3627.5, "impulse_m_s": [0.0178, 0, 0]}
STATE = {"position_m": [0, 1, 2], "velocity_m_s": [0, 0, 0]}
CSV = "time_s,dv_x_m_s,dv_y_m_s,dv_z_m_s\n"


def _zones(**zone: Any) -> dict[str, Any]:
    return {"zones": [{"kind": "box", "half_m": [1, 1, 1]}, {"kind": "box", "half_m": [1, 2, 3], **zone}]}


@pytest.mark.parametrize(
    ("name", "changed", "field"),
    [
        ("passive-abort", _zones(half_m=[1, 0, 3]), "zones.1.half_m"),
        ("passive-abort", _zones(kind="sphere"), "zones.1.half_m"),
        ("passive-abort", _zones(kind="sphere", half_m=[-1, -1, -1]), "zones.1.half_m"),
        ("passive-abort", _zones(attitude_wxyz=[0, 0, 0, 0]), "zones.1.attitude_wxyz"),
        ("passive-abort", {"errors": {"covariance": [[-e for e in row] for row in ONE]}}, "errors.covariance"),
        ("passive-abort", {"errors": {"covariance": BENT}}, "errors.covariance"),
        ("passive-abort", {"errors": {"covariance": [[1.0]] * 6}}, "errors.covariance"),
        ("passive-abort", {"burns": [{**FIRST, "duration_s": 5000}, SECOND]}, "burns"),
        ("passive-abort", {"burns": [{**FIRST, "duration_s": 900}, SECOND]}, "burns.0.duration_s"),
        ("passive-abort", {"burns": [SECOND, FIRST]}, "burns"),
        ("passive-abort", {"burns": []}, "burns"),
        ("passive-abort", {"failures": {"late_s": 5000}}, "failures.late_s"),
        ("passive-abort", {"semi_major_axis_m": 1e8, "abort_orbits": 20}, "abort_orbits"),
        ("passive-abort", {"model": "earth", "states": [STATE]}, "states"),
        ("passive-abort", {"burns": None, "plan": CSV + "5,1,0,0\n1,1,0,0\n"}, "burns"),
        ("passive-abort", {"burns": None, "plan": CSV + "5,nan,0,0\n"}, "plan"),
        ("passive-abort", {"burns": None, "start": None, "plan": "CCSDS_OPM_VERS = 2.0\n", "target": "x"}, "plan"),
        ("commit-timeline", {"chaser": "hello"}, "chaser"),
        ("commit-timeline", {"attitude": "x", "spin": None}, "attitude"),
        ("commit-timeline", {"spin": None}, "attitude"),
        ("commit-timeline", {"spin": {"rate_deg_s": 1, "axis": [0, 0, 0]}}, "spin.axis"),
        ("commit-timeline", {"corridors": [{}, {"name": "b", "axis": [0, 0, 0]}]}, "corridors.1.axis"),
        ("commit-timeline", {"corridors": [{}, {}]}, "corridors"),
        ("commit-timeline", {"start": "2026-13-45T00:00:00Z"}, "start"),
        ("commit-timeline", {"confidence": 0.9}, "confidence"),
    ],
)  # fmt: skip
def test_refused_before_it_is_queued(name: str, changed: dict[str, Any], field: str) -> None:
    spec = process(name)
    asked = {key: value for key, value in {**spec.example, **changed}.items() if value is not None}
    with pytest.raises(InvalidInput) as refused:
        spec.require_possible(spec.parse(asked))
    assert refused.value.field == field
    assert refused.value.required
    assert refused.value.received is not None or field == "burns"


@pytest.mark.parametrize("name", ["passive-abort", "commit-timeline"])
def test_the_example_is_possible(name: str) -> None:
    spec = process(name)
    spec.require_possible(spec.parse(spec.example))


def test_zones_and_burns_that_last_are_possible_about_the_earth() -> None:
    spec = process("passive-abort")
    asked = {**spec.example, **_zones(), "model": "earth", "burns": [{**FIRST, "duration_s": 50}]}
    spec.require_possible(spec.parse(asked))
