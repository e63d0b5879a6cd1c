"""Atlases of planes in space: the exact question at random starts, the planar atlas, and proofs of both polygons."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from safestart.atlas.plane_atlas import PlaneAtlas, area, build_on_plane
from safestart.atlas.survey import build
from safestart.attitude.in_lvlh import torque_free
from safestart.attitude.spin import Spin
from safestart.constraints.thrust_limit import ThrustLimit, ball
from safestart.errors import InvalidInput
from safestart.exact.answer import Verdict
from safestart.exact.question import Question
from safestart.exact.space.decide import decide_in_space
from safestart.exact.space.plane import Plane
from safestart.exact.space.prove import proof_in_space
from safestart.exact.space.question import Face, SpaceQuestion, five_faces
from safestart.model.orbit import KeplerOrbit
from safestart.model.scenario import CorridorShape, Scenario
from safestart.proofs.checker import check

CORRIDOR = five_faces(CorridorShape())
LOW = KeplerOrbit(1.1e-3)
ORBIT = KeplerOrbit.of(2.4e7, 0.7, 0.2)
BODY = ((120.0, 2.0, -1.0), (2.0, 100.0, 3.0), (-1.0, 3.0, 60.0))
TUMBLE = torque_free(BODY, (1.0, 0.0, 0.0, 0.0), (0.01, -0.02, 0.04), "lvlh", ORBIT)
FREE = SpaceQuestion(
    ORBIT, TUMBLE, (*CORRIDOR, Face("far", (0.0, 1.0, 0.2), 140.0, "lvlh")), ball(0.05), steps=15
)
BOXED = SpaceQuestion(
    LOW, Spin(-0.05, (0.1, 0.2, 1.0)), CORRIDOR, ThrustLimit("box", (0.1, 0.05, 0.03), frame="body"), steps=15
)


def plane(
    columns: tuple[int, int], low: tuple[float, float], high: tuple[float, float], y: float = 0.0
) -> Plane:
    return Plane(
        np.array([0.0, y, 0.0, 0.0, 0.0, 0.0]), np.eye(6)[:, list(columns)], np.array(low), np.array(high)
    )


CASES = {
    "positions": (FREE, plane((0, 1), (-150.0, 0.0), (150.0, 150.0))),
    "across": (FREE, plane((0, 2), (-150.0, -150.0), (150.0, 150.0), 60.0)),
    "position and velocity": (FREE, plane((1, 4), (0.0, -6.0), (150.0, 6.0))),
    "two velocities": (BOXED, plane((3, 5), (-5.0, -5.0), (5.0, 5.0), 30.0)),
    "box": (BOXED, plane((2, 1), (-120.0, 0.0), (120.0, 120.0))),
}


@cache
def built(name: str) -> PlaneAtlas:
    return build_on_plane(*CASES[name], 0.02, 300)


@pytest.mark.parametrize("name", sorted(CASES))
def test_every_verdict_is_the_exact_one(name: str) -> None:
    question, where = CASES[name]
    atlas = built(name)
    assert 0.0 < atlas.inner_area <= atlas.outer_area
    assert atlas.relative_gap <= 0.02
    points = np.random.default_rng(1).uniform(where.low, where.high, (60, 2))
    go, no_go = atlas.verdicts(points)
    assert not (go & no_go).any()
    assert go.any()
    assert no_go.any()
    for point, yes, no in zip(points, go, no_go, strict=True):
        verdict = decide_in_space(question, where.states(point)).verdict
        assert not yes or verdict is Verdict.GO
        assert not no or verdict is Verdict.NO_GO
    for bound in atlas.bounds:
        # A bound holds for every start, not only for those beyond its line.
        for corner in atlas.corners:
            assert corner.margin <= bound.level + float(bound.slope @ corner.point) + 1e-9


@pytest.mark.parametrize("name", ["positions", "two velocities"])
def test_corners_and_edges_have_proofs(name: str) -> None:
    question, _ = CASES[name]
    atlas = built(name)
    for corner in atlas.corners[::4]:
        document = proof_in_space(question, *atlas.answer_at(corner))
        assert check(json.loads(json.dumps(document))).verdict == "GO"
    for bound in atlas.bounds[::5]:
        document = proof_in_space(question, *atlas.answer_beyond(bound, atlas.outer[0]))
        assert check(json.loads(json.dumps(document))).verdict == "NO_GO"
    # Between two corners the mixture of their thrusts stays: the reason why the polygon is proved.
    a, b = atlas.corners[0], atlas.corners[len(atlas.corners) // 2]
    middle = replace(a, point=0.5 * (a.point + b.point), margin=1e-6, thrust=0.5 * (a.thrust + b.thrust))
    assert check(json.loads(json.dumps(proof_in_space(question, *atlas.answer_at(middle))))).verdict == "GO"


def test_in_the_orbit_plane_it_is_the_planar_atlas() -> None:
    rate, thrust, y_max = 3.0, 0.1, 150.0
    planar = build(Question(Scenario.of(rate, thrust), 2.0, 30), y_max, 0.005)
    question = SpaceQuestion(LOW, Spin(math.radians(rate)), CORRIDOR, ball(thrust))
    atlas = build_on_plane(question, plane((0, 1), (-230.0, 0.0), (230.0, y_max)), 0.005, 400)
    assert atlas.inner_area <= planar.outer_area
    assert planar.inner_area <= atlas.outer_area
    assert atlas.inner_area == pytest.approx(planar.inner_area, rel=0.011)


def test_planes_without_a_start_that_stays_and_within_one() -> None:
    gone = build_on_plane(FREE, plane((0, 1), (-150.0, -90.0), (150.0, -10.0)), 0.02, 100)
    assert gone.corners == ()
    assert gone.outer_area == gone.relative_gap == 0.0
    assert "no start" in gone.message
    assert gone.verdicts(np.array([[0.0, -50.0]]))[1].all()
    whole = build_on_plane(FREE, plane((0, 1), (-2.0, 28.0), (2.0, 32.0)), 0.02, 100)
    assert whole.inner_area == pytest.approx(16.0)
    assert whole.relative_gap == 0.0
    few = build_on_plane(*CASES["positions"], 1e-4, 12)
    assert "stopped" in few.message
    assert few.relative_gap > 1e-4


def test_area_and_refusals() -> None:
    assert area(np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]])) == 2.0
    assert area(np.empty((0, 2))) == 0.0
    with pytest.raises(InvalidInput) as refused:
        build_on_plane(replace(FREE, speed_limit=1.0), CASES["positions"][1], 0.1, 50)
    assert refused.value.field == "question"
