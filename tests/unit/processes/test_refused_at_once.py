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
    ("changed", "field"),
    [
        (_zones(half_m=[1, 0, 3]), "zones.1.half_m"),
        (_zones(kind="sphere"), "zones.1.half_m"),
        (_zones(kind="sphere", half_m=[-1, -1, -1]), "zones.1.half_m"),
        (_zones(attitude_wxyz=[0, 0, 0, 0]), "zones.1.attitude_wxyz"),
        ({"errors": {"covariance": [[-e for e in row] for row in ONE]}}, "errors.covariance"),
        ({"errors": {"covariance": BENT}}, "errors.covariance"),
        ({"errors": {"covariance": [[1.0]] * 6}}, "errors.covariance"),
        ({"burns": [{**FIRST, "duration_s": 5000}, SECOND]}, "burns"),
        ({"burns": [{**FIRST, "duration_s": 900}, SECOND]}, "burns.0.duration_s"),
        ({"burns": [SECOND, FIRST]}, "burns"),
        ({"burns": []}, "burns"),
        ({"failures": {"late_s": 5000}}, "failures.late_s"),
        ({"semi_major_axis_m": 1e8, "abort_orbits": 20}, "abort_orbits"),
        ({"model": "earth", "states": [STATE]}, "states"),
        ({"burns": None, "plan": CSV + "5,1,0,0\n1,1,0,0\n"}, "burns"),
        ({"burns": None, "plan": CSV + "5,nan,0,0\n"}, "plan"),
        ({"burns": None, "start": None, "plan": "CCSDS_OPM_VERS = 2.0\n", "target": "x"}, "plan"),
    ],
)  # fmt: skip
def test_refused_before_it_is_queued(changed: dict[str, Any], field: str) -> None:
    spec = process("passive-abort")
    asked = {key: value for key, value in {**spec.example, **changed}.items() if value is not None}
    with pytest.raises(InvalidInput) as refused:
        spec.require_possible(spec.parse(asked))
    assert refused.value.field == field
    assert refused.value.required
    assert refused.value.received is not None or field == "burns"


def test_the_example_is_possible() -> None:
    spec = process("passive-abort")
    spec.require_possible(spec.parse(spec.example))


def test_zones_and_burns_that_last_are_possible_about_the_earth() -> None:
    spec = process("passive-abort")
    asked = {**spec.example, **_zones(), "model": "earth", "burns": [{**FIRST, "duration_s": 50}]}
    spec.require_possible(spec.parse(asked))
