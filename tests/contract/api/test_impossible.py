"""What no model can have is refused when it is submitted: no job waits to fail."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import pytest

from safestart.processes.registry import process
from tests.contract.api.service_client import assert_problem, jobs_of, service

FLAT = [[1, 0, 0], [0, 1, 0], [0, 0, 3]]
FLAT_BODY = {
    "kind": "torque_free",
    "inertia_kg_m2": FLAT,
    "attitude_wxyz": [1, 0, 0, 0],
    "body_rate_deg_s": [0, 0, 1],
}
TIMELINE = process("commit-timeline").example
CHASER, TARGET = TIMELINE["chaser"], TIMELINE["target"]
AEM = """CCSDS_AEM_VERS = 2.0
CREATION_DATE = 2026-01-01T00:00:00
ORIGINATOR = A
META_START
OBJECT_NAME = TARGET
OBJECT_ID = 2020-001A
REF_FRAME_A = GCRF
REF_FRAME_B = SC_BODY_1
TIME_SYSTEM = UTC
START_TIME = 2026-03-01T12:00:00
STOP_TIME = 2026-03-01T12:05:00
ATTITUDE_TYPE = QUATERNION
META_STOP
DATA_START
2026-03-01T12:00:00 0 0 0 1
2026-03-01T12:05:00 0 0 0.6 0.8
DATA_STOP
"""
WITH_AEM = TIMELINE | {"attitude": AEM, "spin": None}
OF_CHASER = AEM.replace("= TARGET", "= CHASER").replace("2020-001A", "2026-001A")
"""An attitude file of the other craft."""
IMPOSSIBLE: list[tuple[str, dict[str, Any], str]] = [
    ("tracking-mpc", {"inertia_kg_m2": FLAT}, "inertia_kg_m2"),
    ("tracking-mpc", {"inertia_kg_m2": [[1, 0.5, 0], [0, 1, 0], [0, 0, 1]]}, "inertia_kg_m2"),
    ("tracking-mpc", {"attitude_wxyz": [0, 0, 0, 0]}, "attitude_wxyz"),
    ("tracking-mpc", {"period_s": 60}, "period_s"),
    ("tracking-mpc", {"start": {"position_m": [5, 1, 0]}}, "start.position_m"),
    ("tracking-mpc", {"thrust": "held", "theta_limit": "printed"}, "theta_limit"),
    ("atlas-in-space", {"attitude": FLAT_BODY, "a_max_m_s2": 0.1}, "attitude.inertia_kg_m2"),
    ("plane-benchmark", {"attitude": FLAT_BODY, "a_max_m_s2": 0.1}, "attitude.inertia_kg_m2"),
    ("commit-timeline", TIMELINE | {"chaser": "hello"}, "chaser"),
    ("commit-timeline", TIMELINE | {"target": TARGET.replace("GCRF", "MOON_PA")}, "target"),
    ("commit-timeline", TIMELINE | {"target": TARGET[:-300]}, "target"),
    ("commit-timeline", TIMELINE | {"attitude": AEM}, "attitude"),
    ("commit-timeline", WITH_AEM | {"attitude": AEM.replace("SC_BODY_1", "EME2000")}, "attitude"),
    ("commit-timeline", WITH_AEM | {"attitude": AEM.replace("0.6 0.8", "1 0")}, "attitude"),
    ("commit-timeline", WITH_AEM | {"attitude": OF_CHASER}, "attitude"),
    ("commit-timeline", TIMELINE | {"start": "2026-02-30T12:00:00"}, "start"),
    ("commit-timeline", TIMELINE | {"start": "2026-03-02T12:00:00"}, "stop"),
    ("commit-timeline", TIMELINE | {"confidence": 0.9}, "confidence"),
    ("commit-timeline", TIMELINE | {"spin": {"rate_deg_s": 1, "axis": [0, 0, 0]}}, "spin"),
    ("commit-timeline", TIMELINE | {"corridors": [{"axis": [0, 0, 0]}]}, "corridors.0.axis"),
    ("commit-timeline", TIMELINE | {"corridors": [{}, {}]}, "corridors"),
    ("sweep-in-space", {"attitude": FLAT_BODY, "a_max_m_s2": 0.1}, "attitude.inertia_kg_m2"),
]


@pytest.fixture(scope="module")
def setting(tmp_path_factory):
    folder = tmp_path_factory.mktemp("impossible")
    with service(folder) as client:
        yield client, jobs_of(folder)


@pytest.mark.parametrize(("process_id", "inputs", "field"), IMPOSSIBLE)
def test_it_is_refused_before_it_is_queued(setting, process_id, inputs, field) -> None:
    client, jobs = setting
    answer = client.post(f"/processes/{process_id}/execution", json={"inputs": inputs})
    problem = assert_problem(answer, 422)
    assert problem["field"] == field
    assert problem["required"]
    assert problem["received"]
    assert sum(jobs.counts().values()) == 0


def test_looking_needs_no_engine() -> None:
    """The service stays free of what computes."""
    code = (
        "import sys; from safestart.processes.registry import PROCESS_IDS, process\n"
        "for spec in map(process, PROCESS_IDS): spec.require_possible(spec.parse(spec.example))\n"
        "print(sorted({'jax', 'numba', 'osqp', 'clarabel', 'matplotlib'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
