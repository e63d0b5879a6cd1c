"""What the reach tubes of the switched rendezvous prove, refuse and leave unknown."""

import numpy as np
import pytest

from benchmarks.peers.reach_audit import powered_excess, random_starts
from safestart.errors import InvalidInput
from safestart.passive_safety.flights.falsify import approaches, closest, powered_extremes
from safestart.passive_safety.flights.independent_flight import replay
from safestart.passive_safety.flights.simulate import crossing_times
from safestart.passive_safety.model import PUBLISHED
from safestart.passive_safety.question import Question, Verdict
from safestart.passive_safety.verify import verify

FROM_THE_SIDE = Question(centre=(-200.0, -900.0, 0.0, 0.0), half=(10.0, 10.0, 0.0, 0.0), window=(0.0, 200.0))
AT_A_CORNER = Question(centre=(-900.0, -520.0, 0.0, 0.0), half=(25.0, 25.0, 0.0, 0.0), window=(0.0, 200.0))


def test_start_beside_the_cone_violates_the_line_of_sight() -> None:
    answer = verify(FROM_THE_SIDE)
    finding = answer.findings["los"]
    assert [branch.crossing.name for branch in answer.reach.branches] == ["y=-100"]
    assert finding.verdict is Verdict.UNSAFE
    assert finding.counter_example is not None
    state = replay(
        PUBLISHED, np.array(finding.counter_example["start"]), np.inf, finding.counter_example["time_min"]
    )
    assert abs(state[1]) > -np.tan(np.pi / 6) * state[0] + 1.0


def test_a_set_across_a_corner_of_the_octagon_is_proved() -> None:
    """Each branch reaches past the corner, where no flight is; that all stay in mode 2 is proved all the same."""
    answer = verify(AT_A_CORNER)
    assert len(answer.reach.branches) == 2
    assert answer.findings["separation"].verdict is Verdict.SAFE
    assert answer.findings["thrust"].verdict is Verdict.SAFE


def test_a_single_start_is_a_set_too() -> None:
    findings = verify(Question(half=(0.0, 0.0, 0.0, 0.0), window=(0.0, 240.0))).findings
    assert findings["separation"].verdict is Verdict.SAFE
    assert findings["velocity_disc"].verdict is Verdict.UNSAFE


def test_what_is_not_proved_is_unknown_with_a_reason() -> None:
    """So wide a set that some starts may never enter within the tube, or cross a face twice."""
    answer = verify(
        Question(centre=(-900.0, 0.0, 0.0, 0.0), half=(300.0, 900.0, 0.0, 0.0), window=(0.0, 200.0))
    )
    assert answer.findings["thrust"].verdict is not Verdict.SAFE
    for finding in answer.findings.values():
        assert finding.verdict is not Verdict.SAFE
        assert finding.reason or finding.counter_example


def test_closest_approach_of_the_aborts_up_to_240_minutes() -> None:
    found = closest(Question(window=(0.0, 240.0)), (0.0, 240.0))
    assert found.max_norm == pytest.approx(0.28, abs=0.01)
    assert np.abs(
        replay(PUBLISHED, np.array(found.start), found.abort, found.time)[:2]
    ).max() == pytest.approx(found.max_norm, abs=1e-9)


def test_random_aborts_keep_the_proved_distance() -> None:
    question = Question(window=(0.0, 240.0), box=0.2)
    bound = verify(question).findings["separation"].bound
    assert bound is not None
    starts = random_starts(question, 600, 21)
    aborts = np.random.default_rng(22).uniform(0.0, 240.0, len(starts))
    distance, _ = approaches(
        PUBLISHED, starts, aborts, question.horizon, crossing_times(PUBLISHED, starts, 240.0)
    )
    assert distance.min() >= bound


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"centre": (-90.0, 0.0, 0.0, 0.0)}, "centre"),
        ({"centre": (float("nan"), 0.0, 0.0, 0.0)}, "centre.x"),
        ({"half": (-1.0, 0.0, 0.0, 0.0)}, "half.x"),
        ({"horizon": 0.0}, "horizon"),
        ({"box": 0.0}, "box"),
        ({"window": (10.0, 5.0)}, "window[1]"),
        ({"window": (10.0, 301.0)}, "window[1]"),
    ],
)
def test_bad_questions_name_the_field(change: dict, field: str) -> None:
    with pytest.raises(InvalidInput) as error:
        Question(**change)
    assert error.value.field == field


@pytest.mark.parametrize("seed", range(12))
def test_no_proof_is_contradicted_by_flights_from_anywhere(seed: int) -> None:
    """Random initial sets all around the target, with velocities, windows and boxes."""
    random = np.random.default_rng(seed)
    angle, radius = random.uniform(0.0, 2.0 * np.pi), random.uniform(300.0, 1000.0)
    first = random.uniform(0.0, 150.0)
    question = Question(
        centre=(radius * np.cos(angle), radius * np.sin(angle), *random.uniform(-2.0, 2.0, 2)),
        half=(*random.uniform(0.0, 25.0, 2), *random.uniform(0.0, 0.2, 2)),
        window=(first, random.uniform(first, 250.0)),
        box=random.uniform(0.1, 5.0),
    )
    answer = verify(question)
    tubes, window = answer.reach, answer.question.window
    assert window is not None
    if not tubes.entry.reason:
        assert powered_excess(question, tubes, 300, seed) <= 0.0
    starts = random_starts(question, 400, seed)
    aborts = random.uniform(*window, 400)
    crossings = crossing_times(PUBLISHED, starts, 300.0)
    separation = answer.findings["separation"]
    if separation.verdict is Verdict.SAFE:
        distance, _ = approaches(PUBLISHED, starts, aborts, question.horizon, crossings)
        assert distance.min() >= (question.box if separation.bound is None else separation.bound)
    extremes = powered_extremes(question)
    for name, source in (
        ("thrust", "thrust"),
        ("los", "los"),
        ("velocity", "speed_octagon"),
        ("velocity_disc", "speed"),
    ):
        finding = answer.findings[name]
        if finding.verdict is Verdict.SAFE and finding.bound is not None:
            assert extremes[source].value <= finding.bound + 1e-9
        assert finding.verdict is not Verdict.UNKNOWN or finding.reason
