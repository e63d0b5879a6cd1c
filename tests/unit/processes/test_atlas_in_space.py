"""atlas-in-space: the default planes, planes of one's own, their proofs, refusals."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from safestart.errors import InvalidInput
from safestart.exact.space.decide import decide_in_space
from safestart.processes.execute import execute
from safestart.processes.registry import process
from safestart.processes.start_in_space.plane import plane_of
from safestart.processes.start_in_space.plane_input import PlaneInput, coordinate_planes
from safestart.processes.start_in_space.question import question_of, states_of, stay_in
from safestart.proofs.checker import check
from safestart.runtime.progress import Context

SPEC = process("atlas-in-space")
TILTED: dict[str, Any] = {
    "name": "tilted",
    "origin_m": [1, 30, 2],
    "velocity_m_s": [0.1, 0, 0],
    "rest": "body",
    "first": {"direction": [1, 0, 1], "low": -60, "high": 60},
    "second": {"kind": "velocity", "direction": [0, 3, 0], "low": -3, "high": 3},
}


def answered(**changes: Any) -> Any:
    example = (
        SPEC.example if "planes" not in changes else {k: v for k, v in SPEC.example.items() if k != "size_m"}
    )
    return execute(SPEC.id, example | {"gap": 0.2} | changes, Context())


def test_the_coordinate_planes_by_default() -> None:
    made = answered()
    rows = made.document["outputs"]["planes"]
    assert [row["name"] for row in rows] == ["xy", "zy", "xz"]
    assert all(row["relative_gap"] <= 0.2 for row in rows)
    assert rows[0]["axes"] == ["position along x, body [m]", "position along y, body [m]"]
    assert [artifact.name for artifact in made.artifacts] == ["atlas.png"]
    assert made.artifacts[0].data.startswith(b"\x89PNG")


def test_a_plane_of_one_s_own_and_its_proofs() -> None:
    made = answered(planes=[TILTED], proofs=True)
    (row,) = made.document["outputs"]["planes"]
    documents = json.loads(next(a.data for a in made.artifacts if a.name == "proofs.json"))["tilted"]
    assert len(documents["go"]) == len(row["inner_polygon"])
    assert len(documents["no_go"]) >= 1
    for kind, verdict in (("go", "GO"), ("no_go", "NO_GO")):
        assert check(documents[kind][0]).verdict == verdict
    # The corner as a start of start-in-space, said against the turning body.
    corner = row["inner_polygon"][0]
    unit = np.array([1.0, 0.0, 1.0]) / np.sqrt(2.0)
    start = {
        "position_m": (np.array([1.0, 30.0, 2.0]) + corner[0] * unit).tolist(),
        "velocity_m_s": [0.1, corner[1], 0.0],
        "frame": "body",
    }
    inputs = process("start-in-space").parse(
        {name: SPEC.example[name] for name in ("attitude", "a_max_m_s2")} | {"starts": [start]}
    )
    question = question_of(inputs)
    (state,) = states_of(inputs, question)
    proved = documents["go"][0]["start"]
    np.testing.assert_allclose(state, proved["position_m"] + proved["velocity_m_s"], atol=1e-9)
    assert decide_in_space(question, state).lower > -1e-3


@pytest.mark.parametrize("frame", ["body", "lvlh"])
@pytest.mark.parametrize("rest", ["body", "lvlh"])
def test_frames_and_rest_are_those_of_the_starts(frame: str, rest: str) -> None:
    """Against the turning body in its axes start-in-space says the same; at rest in LVLH the velocity is 0 there."""
    question = stay_in(SPEC.parse(SPEC.example), 60.0)
    said = PlaneInput.model_validate(TILTED | {"frame": frame, "rest": rest, "velocity_m_s": [0, 0, 0]})
    plane = plane_of(said, question)
    state = plane.states(np.array([7.0, 0.0]))
    position = np.array([1.0, 30.0, 2.0]) + 7.0 * np.array([1.0, 0.0, 1.0]) / np.sqrt(2.0)
    turn = question.attitude.rotation(np.zeros(1))[0]
    omega = question.attitude.angular_velocity(np.zeros(1))[0]
    body = position if frame == "body" else turn @ position
    np.testing.assert_allclose(turn @ state[:3], body, atol=1e-12)
    moving = turn.T @ np.cross(omega, body) if rest == "body" else np.zeros(3)
    np.testing.assert_allclose(state[3:], moving, atol=1e-12)


def test_coordinate_planes_pass_through_their_centre() -> None:
    question = stay_in(SPEC.parse(SPEC.example), 60.0)
    for said in coordinate_planes([1.0, 20.0, 3.0], 5.0):
        where, at = plane_of(said, question), dict(zip("xyz", (1.0, 20.0, 3.0), strict=True))
        np.testing.assert_allclose(0.5 * (where.low + where.high), [at[name] for name in said.name])
        turn = question.attitude.rotation(np.zeros(1))[0]
        body = turn @ where.states(0.5 * (where.low + where.high))[:3]
        np.testing.assert_allclose(body, [1.0, 20.0, 3.0], atol=1e-12)


@pytest.mark.parametrize(
    ("changes", "field", "said"),
    [
        ({"planes": [TILTED, TILTED]}, None, "each name once"),
        ({"planes": [TILTED], "centre_m": [0, 1, 0], "size_m": 150}, None, "only where no planes"),
        ({"gap": 0}, "gap", ">= 0.0001"),
        (
            {"planes": [TILTED | {"first": {"direction": [1, 0], "low": 0, "high": 1}}]},
            "planes.0.first.direction",
            "required",
        ),
        (
            {"planes": [TILTED | {"first": {"direction": [0, 0, 0], "low": 0, "high": 1}}]},
            "planes.0.first.direction",
            "required",
        ),
        (
            {
                "planes": [
                    TILTED | {"second": {"kind": "velocity", "direction": [1, 0, 0], "low": 1, "high": 0}}
                ]
            },
            "planes.0.second.low",
            "less than high",
        ),
        (
            {"planes": [TILTED | {"second": {"direction": [2, 0, 2], "low": 0, "high": 1}}]},
            "planes.0.second.direction",
            "another direction",
        ),
        ({"planes": [TILTED | {"origin_m": [1e8, 0, 0]}]}, "planes.0.origin_m.0", "<= 10000"),
        ({"attitude": None}, "attitude", "neither"),
        ({"thrust": {"kind": "ball", "a_max_m_s2": 1}}, "thrust", "both"),
    ],
)
def test_refusals_name_the_field(changes: dict[str, Any], field: str | None, said: str) -> None:
    inputs = {name: value for name, value in SPEC.example.items() if name != "size_m"}
    with pytest.raises(InvalidInput, match=said) as refused:
        execute(SPEC.id, inputs | changes, Context())
    assert field is None or refused.value.field == field
