"""Keep-outs, field of view and plume rule: every GO keeps the demand itself, and nothing is claimed beyond that."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from benchmarks.peers.space_limits import Dense
from safestart.attitude.in_lvlh import torque_free
from safestart.attitude.spin import Spin
from safestart.constraints.thrust_limit import ThrustLimit, ball
from safestart.errors import InvalidInput
from safestart.exact.answer import Answer, Verdict
from safestart.exact.question import Goal
from safestart.exact.space.decide import decide_in_space
from safestart.exact.space.demands.demanded import lost_at_start
from safestart.exact.space.demands.rules import Demands, FieldOfView, KeepOut, Plume
from safestart.exact.space.question import Face, SpaceQuestion, five_faces
from safestart.exact.space.start_box import decide_from_box
from safestart.exact.space.watch import space_watch_of
from safestart.model.orbit import KeplerOrbit
from safestart.model.scenario import CorridorShape, Floats
from safestart.optim.cut_set import CutSet
from safestart.optim.thrust_shapes import BALL, CUBE, SIMPLEX

CORRIDOR = five_faces(CorridorShape())
START = np.array([2.0, 25.0, 1.0, 0.0, 0.0, 0.0])
PANEL = KeepOut("panel", (0.0, 10.0, 0.0), (5.0,))
BOX = KeepOut("box", (0.0, 0.0, 0.0), (6.0, 12.0, 3.0))
VIEW = FieldOfView((0.0, -1.0, 0.0), math.radians(40.0))
RULE = Plume(math.radians(30.0), 60.0)
SIX = tuple((float(x), float(y), float(z)) for x, y, z in np.vstack([np.eye(3), -np.eye(3)]))


def question(demands: Demands, **changes: Any) -> SpaceQuestion:
    parts: dict[str, Any] = {
        "orbit": KeplerOrbit(1.1e-3),
        "attitude": Spin(0.03, (0.1, 0.2, 1.0)),
        "faces": CORRIDOR,
        "thrust": ball(0.1),
    }
    return SpaceQuestion(**parts | changes, demands=demands)


def flown(asked: SpaceQuestion, state: Floats, answer: Answer) -> tuple[Floats, Floats, Floats]:
    """Positions in LVLH and in the body, and thrusts in LVLH, at many times of a GO."""
    watch = space_watch_of(replace(asked, demands=Demands())).until(len(answer.thrust))
    lvlh = watch.flown(state, answer.thrust)[:, :3]
    body = np.einsum("pij,pj->pi", asked.attitude.rotation(watch.sample_times), lvlh)
    return lvlh, body, watch.accelerations(answer.thrust)[watch.intervals]


def least(asked: SpaceQuestion, state: Floats, answer: Answer) -> float:
    """The least margin of the demands themselves, and of the plume rule: inf where it is kept, else -inf."""
    lvlh, body, thrust = flown(asked, state, answer)
    out = math.inf
    for one in asked.demands.keep_outs:
        away = (body if one.frame == "body" else lvlh) - np.array(one.centre)
        room = np.linalg.norm(away, axis=1) - one.size[0]
        if len(one.size) == 3:
            room = (np.abs(away) - np.array(one.size)).max(axis=1)
        out = min(out, float(room.min()))
    view, rule = asked.demands.view, asked.demands.plume
    if view is not None:
        sight = np.array(view.point) - (body if view.frame == "body" else lvlh)
        axis = np.array(view.axis) / np.linalg.norm(view.axis)
        off = np.arctan2(np.linalg.norm(np.cross(axis, sight), axis=1), sight @ axis)
        out = min(out, float((np.linalg.norm(sight, axis=1) * np.sin(view.half_angle - off)).min()))
    if rule is not None:
        away = lvlh - (np.array(rule.point) if rule.frame == "lvlh" else 0.0)
        cosine = np.einsum("pi,pi->p", away, thrust)
        size = np.linalg.norm(away, axis=1) * np.linalg.norm(thrust, axis=1)
        wrong = (cosine > size * math.cos(rule.half_angle)) & (np.linalg.norm(away, axis=1) < rule.reach)
        if bool((wrong & (size > 0.0)).any()):
            return -math.inf
    return out


@pytest.mark.parametrize(
    ("demands", "changes"),
    [
        (Demands((PANEL,)), {}),
        (Demands((BOX,)), {}),
        (Demands((replace(PANEL, frame="lvlh"),)), {}),
        (Demands(view=VIEW), {}),
        (Demands(view=replace(VIEW, half_angle=math.radians(12.0), frame="body")), {}),
        (Demands(plume=RULE), {}),
        (
            Demands(plume=replace(RULE, half_angle=math.radians(70.0), frame="lvlh", point=(1.0, 2.0, 0.0))),
            {},
        ),
        (Demands(view=VIEW), {"thrust": ThrustLimit("box", (0.1, 0.1, 0.05), frame="body")}),
        (Demands((PANEL,)), {"thrust": ThrustLimit("thrusters", (0.1,) * 6, SIX, "body")}),
        (Demands((PANEL,), replace(VIEW, half_angle=math.radians(50.0)), RULE), {}),
        (
            Demands((KeepOut("panel", (3.0, 8.0, 0.0), (2.0,)),), plume=RULE),
            {"goal": Goal(hold=(0.0, 4.0, 0.0)), "steps": 60},
        ),
        (Demands((PANEL,)), {"speed_limit": 1.0}),
        (Demands((PANEL,)), {"orbit": KeplerOrbit.of(2.4e7, 0.7, 0.3)}),
    ],
)
def test_a_go_keeps_the_demands_themselves(demands: Demands, changes: dict[str, Any]) -> None:
    asked = question(demands, **changes)
    answer = decide_in_space(asked, START)
    assert answer.verdict is Verdict.GO
    assert len(answer.restriction) == len(demands.names)
    assert all(name in said for name, said in zip(demands.names, answer.restriction, strict=True))
    assert least(asked, START, answer) >= answer.lower - 1e-9
    # What the flight without demands does instead.
    free = decide_in_space(replace(asked, demands=Demands()), START)
    assert free.lower >= answer.lower - 2e-4


def test_the_demands_bind() -> None:
    """The best flight without them breaks each of these; so a GO is not that flight."""
    plain = question(Demands())
    free = decide_in_space(plain, START)
    _, body, _ = flown(plain, START, free)
    on_the_way = tuple(body[len(body) // 2].tolist())
    for demands in (
        Demands((KeepOut("near", on_the_way, (1.0,)),)),
        Demands((KeepOut("near", on_the_way, (1.0, 0.5, 1.0)),)),
        Demands(view=VIEW),
    ):
        asked = question(demands)
        assert least(asked, START, free) < 0.0
        answer = decide_in_space(asked, START)
        assert answer.verdict is Verdict.GO
        assert least(asked, START, answer) > 0.0


@pytest.mark.parametrize(
    "thrust",
    [ThrustLimit("box", (0.1, 0.1, 0.1)), ThrustLimit("thrusters", (0.1,) * 6, SIX, "body")],
    ids=lambda one: one.kind,
)
def test_a_sum_of_thrusts_has_no_single_exhaust(thrust: ThrustLimit) -> None:
    """A thruster may blow at the target while the sum of all thrusts leads towards it."""
    with pytest.raises(InvalidInput, match="plume: required thrust of kind ball"):
        question(Demands(plume=RULE), thrust=thrust)


def test_the_plume_rule_binds() -> None:
    """The target far on the side to which the corridor turns: the best thrust leads away from it."""
    thrust = ball(0.1)
    plain = question(Demands(), thrust=thrust)
    free = decide_in_space(plain, START)
    lvlh, _, push = flown(plain, START, free)
    strongest = int(np.argmax(np.linalg.norm(push, axis=1)))
    point = tuple((lvlh[strongest] - 15.0 * push[strongest] / np.linalg.norm(push[strongest])).tolist())
    asked = question(Demands(plume=Plume(math.radians(45.0), 50.0, point, "lvlh")), thrust=thrust)
    assert least(asked, START, free) < 0.0
    answer = decide_in_space(asked, START)
    assert answer.verdict is Verdict.GO
    assert least(asked, START, answer) > 0.0


def test_random_cases_claim_nothing_false() -> None:
    """GO keeps the demand; NO_GO is the question's without demands, the start's or the cone's; others are UNDECIDED."""
    rng, seen = np.random.default_rng(3), set()
    for _ in range(40):
        axis = rng.normal(size=3)
        body = torque_free(
            ((120.0, 2.0, -1.0), (2.0, 100.0, 3.0), (-1.0, 3.0, 60.0)),
            (1.0, 0.0, 0.0, 0.0),
            tuple(0.02 * axis),
            "lvlh",
            KeplerOrbit(1.1e-3),
        )
        state = np.concatenate([rng.uniform([-4, 12, -4], [4, 60, 4]), rng.normal(scale=0.1, size=3)])
        centre = tuple((rng.uniform(0.2, 0.9) * state[:3] + rng.normal(scale=3.0, size=3)).tolist())
        size = (4.0,) if rng.random() < 0.5 else (2.0, 4.0, 3.0)
        demands = Demands(
            (KeepOut("panel", centre, size, "body" if rng.random() < 0.5 else "lvlh"),),
            FieldOfView(tuple((-state[:3]).tolist()), math.radians(rng.uniform(15, 60)))
            if rng.random() < 0.5
            else None,
            Plume(math.radians(rng.uniform(10, 70)), 100.0) if rng.random() < 0.5 else None,
        )
        asked = question(demands, attitude=body, thrust=ball(rng.choice([0.03, 0.1])))
        answer, free = (decide_in_space(one, state) for one in (asked, replace(asked, demands=Demands())))
        seen.add(answer.verdict)
        if answer.verdict is Verdict.GO:
            assert least(asked, state, answer) >= answer.lower - 1e-9
        elif answer.verdict is Verdict.NO_GO and not lost_at_start(demands, answer):
            by_cone = {row.face for row in answer.multipliers if row.pull} == {"field_of_view"}
            assert by_cone or free.verdict is Verdict.NO_GO
        elif answer.verdict is Verdict.NO_GO:
            turn = body.rotation(np.zeros(1))[0]
            assert min(room for _, room in demands.rooms(state[:3], turn @ state[:3])) == answer.upper < 0.0
        else:
            assert "is open" in answer.reason
    # The field of view alone left some open, before planes around its cone could refute.
    assert seen == {Verdict.GO, Verdict.NO_GO}


@pytest.mark.parametrize("frame", ["lvlh", "body"])
@pytest.mark.parametrize("seed", range(4))
def test_the_cone_is_refuted_where_no_flight_keeps_it(seed: int, frame: Any) -> None:
    """Beside a dense program with 26 planes inside of the cone, and with 26 around it."""
    rng, seen = np.random.default_rng([seed, frame == "body"]), []
    for _ in range(5):
        state = np.concatenate([rng.uniform([-2, 20, -2], [2, 30, 2]), rng.normal(scale=0.25, size=3)])
        plain = question(Demands(), steps=10, thrust=ball(rng.choice([0.01, 0.03])))
        angle, point = math.radians(rng.uniform(4.0, 20.0)), tuple(rng.normal(size=3).tolist())
        at = plain.attitude.rotation(np.zeros(1))[0] @ state[:3] if frame == "body" else state[:3]
        view = FieldOfView(tuple((point - at).tolist()), angle, point, frame)
        answer = decide_in_space(replace(plain, demands=Demands(view=view)), state)
        axis = (point - at) / np.linalg.norm(point - at)
        side = np.cross(axis, [0.3, 0.5, 0.8])
        side /= np.linalg.norm(side)
        margins = []
        for slope in (math.tan(angle) * math.cos(math.pi / 26), math.tan(angle)):
            turns = 2.0 * math.pi * np.arange(26) / 26
            across = np.outer(np.cos(turns), side) + np.outer(np.sin(turns), np.cross(axis, side))
            normals = slope * axis - across
            faces = [
                Face(f"plane {k}", tuple(normal.tolist()), float(normal @ point), frame)
                for k, normal in enumerate(normals)
            ]
            asked = replace(plain, faces=(*plain.faces, *faces))
            margins.append(Dense(asked, state, np.zeros(6)).margin(inside=slope < math.tan(angle)))
        inner, outer = margins
        seen.append(answer.verdict)
        if answer.verdict is Verdict.GO:
            assert outer > answer.lower - 1e-3
        elif answer.verdict is Verdict.NO_GO:
            assert inner < min(answer.upper, 0.0) + 1e-3
        if outer < -0.05:
            assert answer.verdict is Verdict.NO_GO
    assert Verdict.UNDECIDED not in seen


def test_an_arrival_that_leaves_the_cone_is_refuted() -> None:
    """0.5 m/s across the line of sight take 0.5^2 / 2 / 0.02 = 6.25 m to stop; 5 degrees at 35 m are 3.1 m."""
    view = FieldOfView((0.0, -1.0, 0.0), math.radians(5.0))
    still = {"orbit": KeplerOrbit(0.0), "attitude": Spin(0.0), "thrust": ball(0.02)}
    asked = question(Demands(view=view), **still)
    lost, kept = (decide_in_space(asked, np.array([0.0, 25.0, 0.0, v, 0.0, 0.0])) for v in (0.5, 0.2))
    assert (lost.verdict, kept.verdict) == (Verdict.NO_GO, Verdict.GO)
    assert any(row.face == "field_of_view" for row in lost.multipliers)
    free = decide_in_space(replace(asked, demands=Demands()), np.array([0.0, 25.0, 0.0, 0.5, 0.0, 0.0]))
    assert free.verdict is Verdict.GO


def test_what_is_not_found_is_undecided() -> None:
    """A wall of a keep-out between start and hold point that leaves no way within the corridor, but no proof of it."""
    wall = KeepOut("wall", (0.0, 12.0, 0.0), (200.0, 2.0, 200.0))
    asked = question(Demands((wall,)), goal=Goal(hold=(0.0, 4.0, 0.0)), steps=60)
    answer = decide_in_space(asked, START)
    assert answer.verdict is Verdict.UNDECIDED
    assert "wall" in answer.reason
    assert decide_in_space(replace(asked, demands=Demands()), START).verdict is Verdict.GO


def test_more_is_harder() -> None:
    margins = [
        decide_in_space(question(Demands((KeepOut("panel", (0.0, 10.0, 0.0), (r,)),))), START).lower
        for r in (1.0, 5.0, 9.0, 13.0)
    ]
    assert margins == sorted(margins, reverse=True)
    assert margins[-1] > 0.0


@pytest.mark.parametrize(("whole", "channels"), [(BALL, 3), (CUBE, 3), (SIMPLEX, 7)])
def test_a_cut_set_holds_its_points_and_its_bound(whole: Any, channels: int) -> None:
    rng = np.random.default_rng(5)
    cuts = rng.normal(size=(6, channels))
    cuts[2] = 0.0
    chosen = CutSet(whole, cuts)
    points = chosen.repaired(rng.normal(size=(6, channels)))
    np.testing.assert_allclose(whole.repaired(points), points, atol=1e-13)
    assert float((cuts * points).sum(axis=1).max()) <= 1e-15
    pull = rng.normal(size=(1, 6 * channels))
    bound = chosen.bound(np.zeros(1), pull, np.ones(1), 2.0, channels)
    draws = np.concatenate([chosen.repaired(2.0 * rng.normal(size=(6, channels)))[None] for _ in range(4000)])
    reached = (
        2.0 * (draws.reshape(4000, 6, channels) * pull.reshape(6, channels)).sum(axis=2).max(axis=0).sum()
    )
    assert 0.5 * bound < reached <= bound + 1e-9
    assert bound < whole.bound(np.zeros(1), pull, np.ones(1), 2.0, channels)


@pytest.mark.parametrize(
    ("make", "field"),
    [
        (lambda: KeepOut("", (0.0, 0.0, 0.0), (1.0,)), "name"),
        (lambda: KeepOut("a", (0.0, 0.0), (1.0,)), "centre"),
        (lambda: KeepOut("a", (0.0, math.nan, 0.0), (1.0,)), "centre"),
        (lambda: KeepOut("a", (0.0, 0.0, 0.0), (1.0, 2.0)), "size"),
        (lambda: KeepOut("a", (0.0, 0.0, 0.0), (0.0,)), "size"),
        (lambda: replace(PANEL, frame="hill"), "frame"),
        (lambda: replace(VIEW, axis=(0.0, 0.0, 0.0)), "axis"),
        (lambda: replace(VIEW, half_angle=1.6), "half_angle"),
        (lambda: replace(RULE, half_angle=0.0), "half_angle"),
        (lambda: replace(RULE, reach=-1.0), "reach"),
        (lambda: question(Demands((PANEL, PANEL))), "keep_outs"),
        (lambda: question(Demands((replace(PANEL, name="left"),))), "keep_outs"),
        (lambda: question(Demands((replace(PANEL, name="plume"),))), "keep_outs"),
        (lambda: question(Demands(tuple(replace(PANEL, name=f"p{k}") for k in range(9)))), "keep_outs"),
        (lambda: decide_from_box(question(Demands((PANEL,))), START, np.ones(6)), "question"),
    ],
)
def test_what_is_no_demand_is_refused(make: Any, field: str) -> None:
    with pytest.raises(InvalidInput) as refused:
        make()
    assert refused.value.field == field
