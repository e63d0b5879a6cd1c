"""Timelines of uncertain starts: the boxes hold what they are said to hold, and every start in them is answered for."""

import itertools
import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from safestart.errors import InvalidInput
from safestart.interchange.covariance import Covariance
from safestart.interchange.ephemeris import Ephemeris
from safestart.interchange.relative import in_lvlh, lvlh_axes
from safestart.processes.execute import Execution, execute
from safestart.proofs.checker import check
from safestart.timeline.spread import start_boxes
from tests.unit.timeline.approach import epochs, pair, text

SIGMA = np.diag([0.3, 0.5, 0.2, 0.002, 0.001, 0.003]) ** 2
MIXED = np.eye(6) + 0.3 * (np.ones((6, 6)) - np.eye(6))


def matrix(scale: float = 1.0) -> np.ndarray:
    """A covariance whose components go together."""
    root = np.sqrt(SIGMA)
    return scale**2 * root @ MIXED @ root


def uncertain(course: Ephemeris, seconds: list[float], frame: str = "GCRF", scale: float = 1.0) -> Ephemeris:
    given = tuple(Covariance(int(at), frame, matrix(scale)) for at in epochs(np.array(seconds)))
    return replace(course, covariances=given)


def asked(**more: Any) -> Execution:
    chaser, target = pair()
    given = uncertain(chaser, [0.0, 100.0, 200.0, 300.0], scale=0.3)
    inputs = {
        "chaser": text(given), "target": text(target), "spin": {"rate_deg_s": 1.5}, "a_max_m_s2": 0.1,
        "horizon_s": 30, "step_s": 20, "bracket_s": 1, "confidence": 0.99, **more,
    }  # fmt: skip
    return execute("commit-timeline", inputs)


@pytest.mark.parametrize("frame", ["GCRF", "RTN_INERTIAL", "RTN_ROTATING"])
def test_a_box_holds_at_least_its_share_of_drawn_pairs(frame: str) -> None:
    """Both courses are drawn from their own covariances, in their own axes, and seen from each drawn target."""
    chaser, target = pair()
    at, generator = 100.0, np.random.default_rng(3)
    own, other = uncertain(chaser, [at], frame), uncertain(target, [at], frame, 0.5)
    boxes = start_boxes(chaser, target, (own.covariances, other.covariances), 0.9)
    (half,) = boxes.half_widths(epochs(np.array([at])))
    k = int(np.searchsorted(chaser.epochs, epochs(np.array([at]))[0]))
    drawn = [
        _drawn(course.states[k], frame, scale, generator) for course, scale in ((chaser, 1.0), (target, 0.5))
    ]
    axes, rates = lvlh_axes(drawn[1])
    seen = in_lvlh(drawn[0], drawn[1], axes, rates)
    nominal_axes, nominal_rates = lvlh_axes(target.states[k : k + 1])
    middle = in_lvlh(chaser.states[k : k + 1], target.states[k : k + 1], nominal_axes, nominal_rates)
    inside = (np.abs(seen - middle) <= half).all(axis=1).mean()
    assert inside >= 0.9, inside
    # Half as wide a box holds less: the share is no accident of boxes that are far too large.
    assert (np.abs(seen - middle) <= 0.4 * half).all(axis=1).mean() < 0.9


def _drawn(state: np.ndarray, frame: str, scale: float, generator: np.random.Generator) -> np.ndarray:
    errors = generator.multivariate_normal(np.zeros(6), matrix(scale), size=20_000)
    if frame == "GCRF":
        return state + errors
    (axes,), (rate,) = lvlh_axes(state[None])
    if frame == "RTN_ROTATING":
        errors[:, 3:] += np.cross([0.0, 0.0, rate], errors[:, :3])
    return state + np.concatenate([errors[:, :3] @ axes, errors[:, 3:] @ axes], axis=1)


def test_between_two_covariances_the_greater_counts() -> None:
    chaser, target = pair()
    small, large = (uncertain(chaser, [at], scale=scale) for at, scale in ((50.0, 1.0), (150.0, 2.0)))
    given = [*small.covariances, *large.covariances]
    half = start_boxes(chaser, target, (given, ()), 0.9).half_widths(
        epochs(np.array([0.0, 50.0, 100.0, 150.0, 200.0]))
    )
    assert np.isnan(half[[0, 4]]).all(), "nothing is known before the first and after the last"
    np.testing.assert_array_equal(half[2], np.maximum(half[1], half[3]))
    # Orbit and LVLH turn by a tenth of a radian meanwhile, so that the boxes are not simply one of two sizes.
    np.testing.assert_allclose(half[3], 2.0 * half[1], rtol=0.2)


def test_verdicts_hold_for_whole_boxes_and_their_proofs_say_so() -> None:
    certain, spread = asked(confidence=None), asked()
    kept = json.loads(next(one.data for one in spread.artifacts if one.name == "proofs.json"))
    outputs = spread.document["outputs"]
    found = outputs["intervals"]
    assert {one["verdict"] for one in found} == {"GO", "NO_GO", "UNDECIDED"}
    assert outputs["go_s"] < certain.document["outputs"]["go_s"]
    assert certain.document["outputs"]["largest_half_width_m"] is None
    position = matrix(0.3)[:3, :3]
    # Of a chi-squared distribution with 6 degrees of freedom, 99 % lie below 16.812 (tables).
    least, most = (np.sqrt(16.812 * x) for x in (np.trace(position) / 3.0, np.linalg.eigvalsh(position)[-1]))
    assert least <= outputs["largest_half_width_m"] <= most
    for one in found:
        if one["verdict"] == "UNDECIDED":
            assert one["begin_proof"] is None
            assert "box" in one["reason"]
            continue
        document = kept[one["begin_proof"]]
        assert min(document["start"]["position_half_width_m"]) > 0.0
        assert check(document).verdict == one["verdict"]
    for before, after in itertools.pairwise(found):
        assert {before["verdict"], after["verdict"]} != {"GO", "NO_GO"}, (
            "a box lies on both sides between them"
        )


def test_without_a_covariance_near_it_is_undecided() -> None:
    chaser, target = pair()
    given = text(uncertain(chaser, [100.0, 160.0]))
    found = asked(chaser=given, target=text(target), proofs=False).document["outputs"]["intervals"]
    assert found[0]["reason"] == "undecided: the files hold no covariance near here"
    assert found[0]["end_s"] == pytest.approx(100.0, abs=1.0)
    assert found[-1]["reason"] == found[0]["reason"]
    assert found[-1]["begin_s"] == pytest.approx(160.0, abs=1.0)


@pytest.mark.parametrize(
    ("more", "field"), [({"confidence": 0.3}, "confidence"), ({"confidence": 1.0}, "confidence")]
)
def test_confidences_that_are_refused(more: dict[str, Any], field: str) -> None:
    with pytest.raises(InvalidInput) as caught:
        asked(**more)
    assert caught.value.field == field


def test_a_confidence_needs_a_covariance() -> None:
    chaser, target = pair()
    with pytest.raises(InvalidInput, match="a file with covariances") as caught:
        asked(chaser=text(chaser), target=text(target))
    assert caught.value.field == "confidence"
