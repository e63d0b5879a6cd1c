"""region-in-space: the polygons of atlas-in-space, at once and without pictures."""

from __future__ import annotations

import numpy as np
import pytest

from safestart.errors import InvalidInput
from safestart.exact.answer import Verdict
from safestart.exact.space.decide import decide_in_space
from safestart.processes.execute import execute
from safestart.processes.registry import process
from safestart.processes.start_in_space.plane import plane_of
from safestart.processes.start_in_space.question import stay_in
from safestart.runtime.progress import Context

SPEC, ATLAS = process("region-in-space"), process("atlas-in-space")


def test_it_is_the_atlas_s_and_its_polygons_hold() -> None:
    asked = SPEC.example | {"gap": 0.1}
    made = execute(SPEC.id, asked, Context())
    assert not made.artifacts
    planes = made.document["outputs"]["planes"]
    assert planes == execute(ATLAS.id, asked, Context()).document["outputs"]["planes"]
    inputs = SPEC.parse(asked)
    question = stay_in(inputs, inputs.horizon_s)
    for said, found in zip(inputs.asked(), planes, strict=True):
        plane = plane_of(said, question)
        middle = np.mean(found["inner_polygon"], axis=0)
        assert decide_in_space(question, plane.states(middle)).verdict is Verdict.GO
        beyond = middle + 1.05 * (np.array(found["outer_polygon"][0]) - middle)
        assert decide_in_space(question, plane.states(beyond)).verdict is Verdict.NO_GO


def test_it_is_answered_at_once_and_says_what_it_costs() -> None:
    assert SPEC.light
    narrow, wide = (SPEC.cost(SPEC.parse(SPEC.example | {"gap": gap})) for gap in (0.01, 0.2))
    assert narrow > wide > 0.0


def test_planes_of_the_same_name_are_refused() -> None:
    plane = {
        "name": "a",
        "first": {"direction": [1, 0, 0], "low": -1, "high": 1},
        "second": {"direction": [0, 1, 0], "low": -1, "high": 1},
    }
    with pytest.raises(InvalidInput, match="each name once"):
        SPEC.parse({k: v for k, v in SPEC.example.items() if k != "size_m"} | {"planes": [plane, plane]})
