"""Proofs with keep-outs, a field of view and the plume rule: the checker checks the demands, and no change passes."""

from __future__ import annotations

import copy
import json
import math
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from safestart.attitude.spin import Spin
from safestart.constraints.thrust_limit import ThrustLimit, ball
from safestart.exact.answer import Answer, Verdict
from safestart.exact.question import Goal
from safestart.exact.space.decide import decide_in_space
from safestart.exact.space.demands.rules import Demands, FieldOfView, KeepOut, Plume
from safestart.exact.space.prove import proof_in_space
from safestart.exact.space.question import SpaceQuestion
from safestart.model.orbit import KeplerOrbit
from safestart.proofs.checker import check
from safestart.proofs.strict import ProofRejected
from tests.unit.exact.test_space_demands import BOX, PANEL, RULE, SIX, START, VIEW, flown, question
from tests.unit.proofs.forgery import assert_all_is_read, assert_every_digit_counts, changed, sealed

Document = dict[str, Any]
ALL = Demands((PANEL, BOX), VIEW, RULE)
ASKED: dict[str, SpaceQuestion] = {
    "all": question(Demands((PANEL, BOX), replace(VIEW, half_angle=math.radians(55.0)), RULE), steps=12),
    "sphere": question(Demands((replace(PANEL, frame="lvlh"),)), steps=12),
    "box": question(Demands((BOX,)), steps=12),
    "view": question(Demands(view=VIEW), steps=20),
    "plume": question(Demands(plume=RULE), steps=12),
    "synchronize": question(
        Demands((KeepOut("panel", (3.0, 8.0, 0.0), (2.0,)),), plume=RULE),
        goal=Goal(hold=(0.0, 4.0, 0.0)),
        steps=40,
    ),
    "view lost": question(
        Demands(view=replace(VIEW, half_angle=math.radians(5.0))),
        orbit=KeplerOrbit(1e-3),
        attitude=Spin(0.01),
        thrust=ball(0.02),
        steps=15,
    ),
    "view lost in the body": question(
        Demands((PANEL,), replace(VIEW, half_angle=math.radians(4.0), frame="body")),
        orbit=KeplerOrbit(1e-3),
        attitude=Spin(0.01),
        thrust=ThrustLimit("thrusters", (0.02,) * 6, SIX, "body"),
        steps=10,
    ),
    "view lost before the hold": question(
        Demands(view=replace(VIEW, half_angle=math.radians(5.0))),
        thrust=ball(0.02),
        attitude=Spin(0.0),
        goal=Goal(hold=(9.0, 25.0, -1.0), earliest=14, radius=3.0, rest=0.3),
        steps=18,
    ),
    "sphere at the start": question(Demands((replace(PANEL, size=(20.0,)),)), steps=12),
    "box at the start": question(Demands((replace(BOX, size=(6.0, 30.0, 3.0)),)), steps=12),
    "view at the start": question(Demands(view=replace(VIEW, axis=(1.0, 1.0, 0.0))), steps=12),
}


LOST = np.array([0.5, 25.0, 0.3, 0.6, 0.0, -0.1])


@cache
def made(kind: str) -> str:
    asked, start = ASKED[kind], LOST if "lost" in kind else START
    answer = decide_in_space(asked, start)
    return json.dumps(proof_in_space(asked, start, answer))


def document(kind: str) -> Document:
    out: Document = json.loads(made(kind))
    return out


@pytest.mark.parametrize("kind", sorted(ASKED))
def test_every_answer_is_accepted_and_said_in_full(kind: str) -> None:
    found = check(document(kind))
    assert found.verdict == ("NO_GO" if "start" in kind or "lost" in kind else "GO")
    said = "\n".join(found.statement)
    for name in ASKED[kind].demands.names:
        assert name in said
    if kind == "all":
        for part in (
            "sphere of 5.0 m",
            "half-widths [6.0, 12.0, 3.0] m",
            "(55 deg)",
            "(30 deg)",
            "60.0 m of",
        ):
            assert part in said
    if "start" in kind:
        assert "the start itself does not keep" in said


@pytest.mark.parametrize("kind", ["all", "sphere at the start", "view at the start"])
def test_what_is_not_read_is_refused(kind: str) -> None:
    """A demand may be left out: less is proved then, and the statement says less."""
    assert_all_is_read(check, document(kind), without=("keep_outs", "field_of_view", "plume"))
    assert_every_digit_counts(check, document(kind), 40)


Q = "question."


@pytest.mark.parametrize(
    ("kind", "key", "value"),
    [
        ("sphere", Q + "keep_outs.0.radius_m", 26.0),
        ("sphere", Q + "keep_outs.0.centre_m", [2.0, 24.0, 1.0]),
        ("sphere", Q + "keep_outs.0.name", "left"),
        ("sphere", Q + "keep_outs.0.name", "field_of_view"),
        ("box", Q + "keep_outs.0.half_widths_m", [6.0, 40.0, 3.0]),
        ("box", Q + "keep_outs.0.half_widths_m", [6.0, 12.0]),
        ("box", Q + "keep_outs.0.centre_m", [0.0, 25.0, 0.0]),
        ("view", Q + "field_of_view.half_angle_rad", 0.3),
        ("view", Q + "field_of_view.axis", [0.0, 1.0, 0.0]),
        ("view", Q + "field_of_view.axis", [0.0, 0.0, 0.0]),
        ("view", Q + "field_of_view.point_m", [30.0, 0.0, 0.0]),
        ("plume", Q + "plume.half_angle_rad", 1.4),
        ("plume", Q + "plume.point_m", [0.0, 60.0, 0.0]),
        ("plume", Q + "plume.half_angle_rad", 1.6),
        ("all", Q + "keep_outs", []),
        ("sphere at the start", "violated", "right"),
        ("sphere at the start", "violated", "plume"),
        ("sphere at the start", Q + "keep_outs.0.radius_m", 5.0),
        ("sphere at the start", "margin_m", -20.5),
        ("sphere at the start", "margin_m", -7.0),
        ("box at the start", Q + "keep_outs.0.half_widths_m", [6.0, 20.0, 3.0]),
        ("box at the start", "margin_m", -2.5),
        ("view at the start", Q + "field_of_view.axis", [0.0, -1.0, 0.0]),
        ("view at the start", "margin_m", -40.0),
    ],
)
def test_another_demand_is_not_proved(kind: str, key: str, value: Any) -> None:
    parts: list[Any] = [int(e) if e.isdigit() else e for e in key.split(".")]
    forged = document(kind)
    inside: Any = forged
    for part in parts[:-1]:
        inside = inside[part]
    inside[parts[-1]] = value
    with pytest.raises(ProofRejected):
        check(sealed(forged))


@pytest.mark.parametrize("kind", [name for name in sorted(ASKED) if "lost" in name])
def test_planes_hold_the_cone(kind: str) -> None:
    """A row of the field of view is a plane against which the cone lies on one side; no other vector passes."""
    whole = document(kind)
    rows = [row for part in whole.get("parts", [whole]) for row in part["multipliers"]]
    planes = [row for row in rows if row["face"] == "field_of_view"]
    assert planes
    assert all(set(row) == {"face", "pull", "time_s", "value"} for row in planes)
    strongest = max(planes, key=lambda row: row["value"])
    size = float(np.linalg.norm(strongest["pull"]))
    assert size == pytest.approx(strongest["value"], rel=1e-12)
    axis = np.array(whole["question"]["field_of_view"]["axis"])
    kept = list(strongest["pull"])
    for forged, said in (
        ((np.array(kept) - 1e-6 * size * axis).tolist(), "leaves the cone on one side"),
        ((-np.array(kept)).tolist(), "leaves the cone on one side"),
        ((np.array(kept) * 1.001).tolist(), "pull"),
        ([0.0, 0.0, 0.0], "sum of weighted margins"),
        (kept[:2], "pull"),
    ):
        strongest["pull"] = forged
        with pytest.raises(ProofRejected, match=said):
            check(sealed(copy.deepcopy(whole)))
    strongest["pull"] = kept
    del whole["question"]["field_of_view"]
    with pytest.raises(ProofRejected, match="a face of the question"):
        check(sealed(whole))


def test_a_wider_cone_is_not_refuted_by_the_same_planes() -> None:
    forged = document("view lost")
    forged["question"]["field_of_view"]["half_angle_rad"] = math.radians(5.01)
    with pytest.raises(ProofRejected, match="leaves the cone on one side"):
        check(sealed(forged))
    # Any narrower cone lies within these planes, too.
    forged["question"]["field_of_view"]["half_angle_rad"] = math.radians(4.0)
    assert check(sealed(forged)).verdict == "NO_GO"


def test_no_face_takes_the_name_of_the_field_of_view() -> None:
    forged = document("view lost")
    forged["question"]["faces"][0]["name"] = "field_of_view"
    with pytest.raises(ProofRejected, match="names other than field_of_view"):
        check(sealed(forged))


def test_a_demand_that_is_easier_stays_proved() -> None:
    """So the refusals above are about what the flight does, not about any change."""
    for kind, path, value in (
        ("sphere", "radius_m", 4.0),
        ("box", "half_widths_m", [5.0, 11.0, 2.0]),
    ):
        forged = document(kind)
        forged["question"]["keep_outs"][0][path] = value
        assert check(sealed(forged)).verdict == "GO"
    assert check(changed(document("view"), Q + "field_of_view.half_angle_rad", 0.9)).verdict == "GO"
    assert check(changed(document("plume"), Q + "plume.half_angle_rad", 0.2)).verdict == "GO"
    assert check(changed(document("plume"), Q + "plume.range_m", 5.0)).verdict == "GO"


def test_a_flight_that_breaks_a_demand_is_refused() -> None:
    """The best flight without a demand, claimed for the question with it."""
    plain = question(Demands())
    free = decide_in_space(plain, START)
    lvlh, body, push = flown(plain, START, free)
    there = tuple(body[len(body) // 2].tolist())
    strongest = int(np.argmax(np.linalg.norm(push, axis=1)))
    point = tuple((lvlh[strongest] - 15.0 * push[strongest] / np.linalg.norm(push[strongest])).tolist())
    for demands, said in (
        (Demands((KeepOut("near", there, (1.0,)),)), "near"),
        (Demands((KeepOut("near", there, (1.0, 0.5, 1.0)),)), "near"),
        (Demands(view=FieldOfView((0.0, -1.0, 0.0), math.radians(20.0))), "field_of_view"),
        (Demands(plume=Plume(math.radians(45.0), 50.0, point, "lvlh")), "plume"),
    ):
        asked = question(demands)
        answer = Answer(Verdict.GO, 1e-3, 1e-3, 1.0, free.thrust, (), 1)
        with pytest.raises(ProofRejected, match=said):
            check(json.loads(json.dumps(proof_in_space(asked, START, answer))))


def test_a_hull_of_thrusters_has_no_plume_rule() -> None:
    """The rule on the sum of the thrusts holds, yet one of them may blow at the target."""
    asked = question(Demands((PANEL,)), steps=12, thrust=ThrustLimit("thrusters", (0.1,) * 6, SIX, "body"))
    proved: Document = proof_in_space(asked, START, decide_in_space(asked, START))
    assert check(proved).verdict == "GO"
    for rule in ("plume", "all"):
        with pytest.raises(ProofRejected, match="plume: required thrust of kind ball"):
            check(changed(proved, "question.plume", document(rule)["question"]["plume"]))


def test_no_box_of_starts_has_demands() -> None:
    forged = document("sphere")
    forged["start"] |= {"position_half_width_m": [0.1] * 3, "velocity_half_width_m_s": [0.0] * 3}
    with pytest.raises(ProofRejected, match="demands"):
        check(sealed(forged))


def test_digits_of_every_new_field_count() -> None:
    """Mutations of single numbers in the demands: refused, or the same claim about an easier demand."""
    rng = np.random.default_rng(7)
    base = document("all")
    refused = 0
    for _ in range(40):
        forged = copy.deepcopy(base)
        chosen = rng.choice(["keep_outs", "field_of_view", "plume"])
        inside = forged["question"][chosen]
        if chosen == "keep_outs":
            inside = inside[int(rng.integers(2))]
        key = rng.choice([name for name in inside if name not in ("name", "frame")])
        factor = float(rng.choice([-1.0, 0.2, 5.0, 40.0]))
        if isinstance(inside[key], list):
            inside[key] = [factor * e + float(rng.normal(scale=20.0)) for e in inside[key]]
        else:
            inside[key] *= factor
        try:
            check(sealed(forged))
        except ProofRejected:
            refused += 1
            continue
        flight = replace(ASKED["all"], demands=_demands(forged["question"]))
        assert _least_of(flight, forged) >= forged["margin_m"] - 1e-6
    assert refused > 15


def _demands(said: dict[str, Any]) -> Demands:
    outs = tuple(
        KeepOut(
            one["name"],
            tuple(one["centre_m"]),
            (one["radius_m"],) if "radius_m" in one else tuple(one["half_widths_m"]),
            one["frame"],
        )
        for one in said["keep_outs"]
    )
    view, rule = said["field_of_view"], said["plume"]
    return Demands(
        outs,
        FieldOfView(tuple(view["axis"]), view["half_angle_rad"], tuple(view["point_m"]), view["frame"]),
        Plume(rule["half_angle_rad"], rule["range_m"], (0.0, 0.0, 0.0), rule["frame"]),
    )


def _least_of(asked: SpaceQuestion, forged: Document) -> float:
    from tests.unit.exact.test_space_demands import least

    thrust = np.array(forged["thrust_m_s2"])
    margin = forged["margin_m"]
    answer = Answer(Verdict.GO, margin, margin, margin, thrust, (), 1)
    rule = forged["question"]["plume"]
    if rule["point_m"] != [0.0, 0.0, 0.0]:
        asked = replace(asked, demands=replace(asked.demands, plume=None))
    return least(asked, START, answer)
