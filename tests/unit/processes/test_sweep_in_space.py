"""sweep-in-space: exact and flight agree without noise, starts depend on their number alone, refusals."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from safestart.errors import InvalidInput
from safestart.exact.answer import Verdict
from safestart.exact.space.decide import decide_in_space
from safestart.processes.execute import execute
from safestart.processes.registry import process
from safestart.processes.start_in_space.question import stay_in
from safestart.processes.sweep_in_space.run import drawn
from safestart.runtime.progress import Context

SPEC = process("sweep-in-space")
NEAR = SPEC.example | {
    "centre": {"position_m": [0, 25, 0], "frame": "body"},
    "position_half_width_m": [30, 20, 30],
    "velocity_half_width_m_s": [1.5, 1.5, 1.5],
    "horizon_s": 40,
    "cases": 24,
}


def outputs(**changes: Any) -> dict[str, Any]:
    found: dict[str, Any] = execute(SPEC.id, NEAR | changes, Context()).document["outputs"]
    return found


def test_without_noise_what_is_proved_is_flown_and_nothing_else() -> None:
    found = outputs()
    matrix = found["confusion"]["exact"]["sequence"]
    assert found["outside"] + len(found["flown_cases"]) == 24
    assert found["undecided"] == 0
    assert (matrix["fp"], matrix["fn"]) == (0, 0)
    assert matrix["tp"] > 2
    assert matrix["tn"] > 2
    assert found["exact_go"] == found["stayed"]
    inputs = SPEC.parse(NEAR)
    question = stay_in(inputs, 40)
    states = drawn(inputs, question)
    for row in found["worst"][:3]:
        assert np.allclose(states[row["case"]], row["position_m"] + row["velocity_m_s"], atol=1e-12)
        verdict = decide_in_space(question, states[row["case"]]).verdict
        assert (verdict is Verdict.GO) == (row["violated_at_s"] is None)


def test_noise_takes_flights_from_starts_with_a_proof_and_they_come_first() -> None:
    found = outputs(a_max_m_s2=0.1, position_sigma_m=60.0, velocity_sigma_m_s=5.0, cases=16)
    matrix = found["confusion"]["exact"]["sequence"]
    assert matrix["tp"] + matrix["fp"] + matrix["fn"] + matrix["tn"] == len(found["flown_cases"])
    assert matrix["fn"] == 0
    assert matrix["fp"] > 0
    assert found["worst"][0]["exact"] == "GO"
    assert found["worst"][0]["flown_margin_m"] < 0.0
    assert found["worst"][0]["violated_at_s"] is not None


def test_a_start_depends_on_its_number_and_the_seed() -> None:
    few, many = (SPEC.parse(NEAR | {"cases": cases}) for cases in (3, 9))
    question = stay_in(few, 40)
    assert np.array_equal(drawn(few, question), drawn(many, question)[:3])
    assert not np.array_equal(
        drawn(few, question), drawn(SPEC.parse(NEAR | {"cases": 3, "seed": 1}), question)
    )


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"controllers": ["filter"]}, "flies nothing in space: its prediction"),
        ({"controllers": ["pid"]}, "some of filter, filter_fine, sequence, received .*pid"),
        ({"cases": 0}, "cases"),
        ({"position_half_width_m": [1, 1]}, "position_half_width_m"),
    ],
)
def test_what_cannot_be_flown_is_refused_at_submission(wrong: dict[str, Any], said: str) -> None:
    with pytest.raises(InvalidInput, match=said):
        SPEC.parse(NEAR | wrong)
