"""One file and one line make an engine: options, rows, arrays, pictures, the API's description follow."""

from __future__ import annotations

import json
import math
import subprocess
import sys

import pytest

pytestmark = pytest.mark.slow

# A process of its own: what a benchmark may ask for is settled when its spec is loaded.
ASK = """
import io, json
import numpy as np
from safestart.engines.registry import ENGINES
from tests.unit.engines.example_engine import SPEC
ENGINES[SPEC.name] = SPEC

from safestart.errors import InvalidInput
from safestart.processes.execute import execute
from safestart.processes.registry import process
from safestart_service.documents.describe import description

asked = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "engines": ["analytical", "speed"], "horizon_s": 10,
         "grid": {"nx": 15, "ny": 13, "y_max_m": 80}, "speed": {"speed_m_s": 2.5}}
result = execute("benchmark", asked)
process("benchmark").outputs.model_validate(result.document["outputs"])
files = {artifact.name: artifact.data for artifact in result.artifacts}
arrays = np.load(io.BytesIO(files["maps.npz"]))
x, y = np.meshgrid(arrays["x_m"], arrays["y_m"])
try:
    process("benchmark").parse({**asked, "speed": {"speed_m_s": -1}})
except InvalidInput as error:
    refused = error.field
print(json.dumps({
    "document": result.document,
    "files": sorted(files),
    "furthest": float(np.hypot(x, y)[arrays["speed_mask"]].max()),
    "missed": int((arrays["inside"] & ~arrays["speed_mask"] & (np.hypot(x, y) < 45.0)).sum()),
    "refused": refused,
    "description": description(process("benchmark"), ""),
}))
"""


@pytest.fixture(scope="module")
def told() -> dict:
    done = subprocess.run([sys.executable, "-c", ASK], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_it_answers_beside_the_others(told: dict) -> None:
    analytical, speed = told["document"]["outputs"]["rows"]
    assert (analytical["engine"], speed["engine"]) == ("analytical", "speed")
    assert speed["code"] == "ok"
    assert speed["detail"] == {"speed_m_s": 2.5}
    assert speed["cells"] > 0
    assert speed["confusion"]["tp"] + speed["confusion"]["fp"] == analytical["cells"]
    assert told["files"] == ["agreement.png", "maps.npz", "overlay.png"]


def test_its_option_counts(told: dict) -> None:
    limit = 2.5 / math.radians(3.0)
    assert 45.0 < told["furthest"] <= limit < 48.0
    assert told["missed"] == 0
    assert told["document"]["inputs"]["speed"] == {"speed_m_s": 2.5}
    assert told["document"]["inputs"]["hamilton_jacobi"]["accuracy"] == "very_high"
    assert told["refused"] == "speed.speed_m_s"


def test_the_api_describes_it(told: dict) -> None:
    described = told["description"]
    assert described["safestart:engines"][-1] == {
        "name": "speed",
        "title": "slow enough",
        "colour": "#F0E442",
        "summary": "starts that move with the target at no more than a given speed",
    }
    assert described["inputs"]["speed"]["schema"]["properties"]["speed_m_s"]["default"] == 3.0
    assert described["inputs"]["engines"]["schema"]["items"]["enum"][-1] == "speed"
    assert described["inputs"]["engines"]["schema"]["maxItems"] == 9
