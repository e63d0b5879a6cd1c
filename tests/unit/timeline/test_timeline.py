"""Timelines against questions that are put by hand, their brackets, their proofs, their gaps and refusals."""

import itertools
import json
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from safestart.attitude.spin import Spin
from safestart.constraints.thrust_limit import ThrustLimit
from safestart.errors import InvalidInput
from safestart.exact.space.decide import decide_in_space
from safestart.exact.space.model_error import model_error
from safestart.exact.space.question import SpaceQuestion, five_faces
from safestart.interchange.ephemeris import Ephemeris
from safestart.model.orbit import KeplerOrbit
from safestart.model.scenario import CorridorShape
from safestart.processes.commit_timeline.run import _reason
from safestart.processes.execute import Execution, execute
from safestart.processes.side_by_side import execute_side_by_side
from safestart.proofs.checker import check
from safestart.timeline.encounter import Encounter
from tests.unit.interchange.sample import kepler
from tests.unit.timeline.approach import attitude, pair, states, text

RATE = math.radians(1.5)
A_MAX = 0.05


def asked(**more: Any) -> dict[str, Any]:
    chaser, target = pair()
    return {
        "chaser": text(chaser), "target": text(target), "spin": {"rate_deg_s": 1.5}, "a_max_m_s2": A_MAX,
        "horizon_s": 30, **more,
    }  # fmt: skip


def intervals(result: Execution) -> list[dict[str, Any]]:
    return result.document["outputs"]["intervals"]


def proofs(result: Execution) -> dict[str, Any]:
    (kept,) = (artifact for artifact in result.artifacts if artifact.name == "proofs.json")
    return json.loads(kept.data)


def question(seconds: float) -> SpaceQuestion:
    """By hand: the spin that the target was given, one circular orbit."""
    orbit = KeplerOrbit(math.sqrt(3.986004418e14 / 7.0e6**3))
    return SpaceQuestion(
        orbit,
        Spin(RATE, phase=RATE * seconds),
        five_faces(CorridorShape()),
        ThrustLimit("ball", (A_MAX,)),
        2.0,
        15,
    )


def verdict(seconds: float) -> str:
    """By hand: from the state that the chaser was given."""
    return decide_in_space(question(seconds), states(np.array([seconds]))[0], verdict_only=True).verdict.value


@pytest.fixture(scope="module")
def by_spin() -> Execution:
    return execute("commit-timeline", asked())


def test_verdicts_are_those_of_questions_put_by_hand(by_spin: Execution) -> None:
    found = intervals(by_spin)
    assert [one["verdict"] for one in found] == ["GO", "NO_GO", "GO", "NO_GO"]
    assert found[0]["begin_s"] == 0.0
    assert found[-1]["end_s"] == 300.0
    for before, after in itertools.pairwise(found):
        # The change lies between the two, and an instant on either side of it is what it is said to be.
        assert 0.0 < after["begin_s"] - before["end_s"] <= 0.1
        assert verdict(before["end_s"] - 0.1) == before["verdict"]
        assert verdict(after["begin_s"] + 0.1) == after["verdict"]
    for seconds in np.arange(0.0, 300.5, 10.0):
        (own,) = (one for one in found if one["begin_s"] <= seconds <= one["end_s"])
        assert verdict(seconds) == own["verdict"], seconds
    outputs = by_spin.document["outputs"]
    assert outputs["first_go"] == "2026-03-01T12:00:00"
    assert outputs["go_s"] == pytest.approx(
        sum(o["end_s"] - o["begin_s"] for o in found if o["verdict"] == "GO")
    )
    assert outputs["largest_eccentricity"] == pytest.approx(2e-4, rel=1e-3)


def test_every_end_has_a_proof_that_verifies(by_spin: Execution) -> None:
    kept = proofs(by_spin)
    assert len(kept) == 8
    for one in intervals(by_spin):
        for end in ("begin", "end"):
            document = kept[one[f"{end}_proof"]]
            found = check(document)
            assert found.verdict == one["verdict"]
            start = document["start"]
            state = [*start["position_m"], *start["velocity_m_s"]]
            np.testing.assert_allclose(state, states(np.array([one[f"{end}_s"]]))[0], atol=2e-5)


def test_the_error_of_the_linear_model_is_said_where_it_exceeds_the_margin(by_spin: Execution) -> None:
    for one in intervals(by_spin):
        if one["verdict"] == "GO":
            error = model_error(question(one["begin_s"]), states(np.array([one["begin_s"]]))[0])
            assert 0.0 < error <= one["model_error_m"] * (1.0 + 1e-6) < 0.1
        if abs(one["margin_m"]) < 1e-9:
            assert "linear model itself may be off" in one["reason"]
    run = {"verdict": "GO", "margin_m": 0.01, "model_error_m": 3.0, "within_error": True, "why": ""}
    assert "up to 3 m" in _reason(run, 30.0, None)
    assert "linear model" not in _reason(run | {"within_error": False}, 30.0, None)


@pytest.mark.parametrize("reference", ["GCRF", "EME2000", "RTN"])
def test_an_attitude_file_says_the_same_as_the_spin(by_spin: Execution, reference: str) -> None:
    given = attitude(Spin(RATE), 340.0, reference="RTN" if reference == "RTN" else "GCRF")
    if reference == "EME2000":
        from dataclasses import replace

        from safestart.attitude.quaternion import product, quaternion_of
        from safestart.interchange.frames import rotation_to_gcrf

        (turn,) = rotation_to_gcrf("EME2000", given.epochs[:1])
        given = replace(
            given, reference="EME2000", quaternions=product(quaternion_of(turn)[None], given.quaternions)
        )
    inputs = asked(attitude=text(given, "xml"), spin=None, proofs=False)
    for one, other in zip(intervals(by_spin), intervals(execute("commit-timeline", inputs)), strict=True):
        assert one["verdict"] == other["verdict"]
        assert one["begin_s"] == pytest.approx(other["begin_s"], abs=0.1)
        assert other["begin_proof"] is None


@pytest.mark.slow
def test_side_by_side_and_in_turn_are_the_same(by_spin: Execution) -> None:
    other = execute_side_by_side("commit-timeline", asked(), workers=2)
    assert other.document["outputs"] == by_spin.document["outputs"]
    assert [a.sha256 for a in other.artifacts] == [a.sha256 for a in by_spin.artifacts]


def test_several_corridors_and_a_span() -> None:
    corridors = [{"name": "fore"}, {"name": "aft", "axis": [0, -1, 0]}]
    start, stop = "2026-03-01T12:01:00", "2026-060T12:02:05"
    result = execute("commit-timeline", asked(corridors=corridors, start=start, stop=stop, proofs=False))
    found = intervals(result)
    assert result.document["outputs"]["start"] == start
    assert result.document["outputs"]["steps"] == 7
    # The spin's phase counts from the start of the span.
    assert {one["corridor"] for one in found} == {"fore", "aft"}
    assert all(one["verdict"] == "NO_GO" for one in found if one["corridor"] == "aft" and one["begin_s"] < 20)
    assert found[0]["verdict"] == "GO"


def test_gaps_and_ends_are_undecided() -> None:
    chaser, target = pair(span=2000.0)
    kept = np.r_[0:10, 60:201]
    broken = Ephemeris("CHASER", "2026-001A", "GCRF", "UTC", chaser.epochs[kept], chaser.states[kept])
    given = attitude(Spin(0.0), 1500.0, step=5.0)
    inputs = asked(chaser=text(broken), target=text(target), attitude=text(given), spin=None, step_s=50)
    found = intervals(execute("commit-timeline", inputs))
    assert [one["verdict"] for one in found] == ["GO", "UNDECIDED", "GO", "UNDECIDED"]
    assert found[1]["reason"] == "undecided: the files hold no states here"
    assert found[1]["begin_s"] == pytest.approx(90.0, abs=0.1)
    assert found[1]["end_s"] == pytest.approx(600.0, abs=0.1)
    assert found[1]["begin_proof"] is None
    assert found[3]["reason"] == "undecided: the attitude does not go on to the end of the horizon"
    assert found[3]["begin_s"] == pytest.approx(1470.0, abs=0.1)


def test_an_elliptic_orbit_and_a_tumble_about_a_slanted_axis() -> None:
    orbit = (12.0e6, 0.4, (0.4, 0.9, 1.3), 0.2)
    chaser, target = pair(span=200.0, orbit=orbit)
    spin = Spin(0.03, (0.3, 0.2, 1.0))
    given = attitude(spin, 240.0, orbit=orbit, step=0.5)
    inputs = asked(
        chaser=text(chaser), target=text(target), attitude=text(given), spin=None, step_s=20, bracket_s=1
    )
    result = execute("commit-timeline", inputs)
    found = intervals(result)
    assert {one["verdict"] for one in found} == {"GO", "NO_GO"}
    kept = proofs(result)
    for one in found:
        document = kept[one["begin_proof"]]
        assert document["question"]["orbit"]["eccentricity"] == pytest.approx(0.4, abs=1e-9)
        assert check(document).verdict == one["verdict"]
    # The orbit in the proof turns LVLH as the file does.
    stated = kept[found[0]["begin_proof"]]["question"]["orbit"]
    own = KeplerOrbit(stated["mean_motion_rad_s"], stated["eccentricity"], stated["true_anomaly_rad"])
    states_then = kepler(*orbit, np.array([0.0, 20.0]))
    radial = states_then[:, :3] / np.linalg.norm(states_then[:, :3], axis=1)[:, None]
    turned = math.acos(float(radial[0] @ radial[1]))
    assert float(own.turned(np.array([20.0]))[0]) == pytest.approx(turned, abs=1e-9)


@pytest.mark.parametrize(
    ("more", "field", "message"),
    [
        ({"attitude": "x"}, "attitude", "a spin, and not both"),
        ({"spin": None}, "attitude", "a spin, and not both"),
        ({"chaser": "hello"}, "chaser", "chaser: line 1: required KEYWORD"),
        ({"start": "2026-03-01T12:04:00", "stop": "2026-03-01T12:03:00"}, "stop", "its end after its begin"),
        ({"stop": "2027-03-01T12:03:00"}, "step_s", "at most 100000 instants"),
        ({"start": "soon"}, "start", "start"),
        ({"corridors": [{}, {}]}, "corridors", "names that differ"),
        ({"corridors": [{"axis": [0, 0, 0]}]}, "corridors.0.axis", "not all 0"),
        ({"horizon_s": 31}, "horizon_s", "horizon_s"),
        ({"other": 1}, "other", "no field of this name"),
    ],
)
def test_inputs_that_are_refused(more: dict[str, Any], field: str, message: str) -> None:
    with pytest.raises(InvalidInput) as caught:
        execute("commit-timeline", asked(**more))
    assert caught.value.field == field
    assert message in caught.value.detail


def test_attitudes_that_are_refused() -> None:
    sparse = attitude(Spin(0.2), 400.0, step=10.0)
    with pytest.raises(InvalidInput, match="at most 90 degrees between two entries"):
        execute("commit-timeline", asked(attitude=text(sparse), spin=None))
    chaser, target = pair()
    both = [Ephemeris(c.name, c.object_id, "ITRF", "UTC", c.epochs, c.states) for c in (chaser, target)]
    good = attitude(Spin(0.01), 400.0)
    with pytest.raises(InvalidInput, match="inertial attitude"):
        execute(
            "commit-timeline",
            asked(chaser=text(both[0]), target=text(both[1]), attitude=text(good), spin=None),
        )
    with pytest.raises(InvalidInput, match="both courses in one realisation of ITRF"):
        execute("commit-timeline", asked(chaser=text(both[0])))


def test_a_hole_of_the_attitude_is_undecided() -> None:
    """At 1 deg/s a hole of 250 s looks like 110 degrees the other way round; slerp gave a GO or a NO_GO in it."""
    whole = attitude(Spin(math.radians(1.0)), 400.0, step=10.0)
    kept = (whole.epochs <= whole.epochs[5]) | (whole.epochs >= whole.epochs[30])
    holed = replace(whole, epochs=whole.epochs[kept], quaternions=whole.quaternions[kept])
    encounter = Encounter(*pair(400.0), holed, int(whole.epochs[0]), 20.0)
    known = encounter.covered(whole.epochs)
    expected = [(k <= 3) or (30 <= k <= 38) for k in range(41)]
    assert known.tolist() == expected
    parts = replace(whole, pieces=(0, 20))
    known = Encounter(*pair(400.0), parts, int(whole.epochs[0]), 20.0).covered(whole.epochs)
    assert known.tolist() == [(k <= 17) or (20 <= k <= 38) for k in range(41)]
