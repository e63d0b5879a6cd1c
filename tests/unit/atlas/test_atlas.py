"""The proof atlas: against the exact answer point by point, proofs through the checker, convexity, bad input."""

import numpy as np
import pytest

from safestart.atlas.atlas import Atlas
from safestart.atlas.sandwich import Support, refine
from safestart.atlas.survey import build
from safestart.errors import InvalidInput
from safestart.exact.answer import Verdict
from safestart.exact.decide import decide
from safestart.exact.prove import proof_of
from safestart.exact.question import Question
from safestart.model.scenario import Floats, Scenario
from safestart.proofs.single import check

POINTS = {"3 deg/s": (3.0, 0.1), "1 deg/s": (1.0, 0.1), "sliver": (2.0, 0.05), "no tumble": (0.0, 0.1)}
COUNTEREXAMPLE = np.array([9.364, 81.044])
"""A start that the closed form certifies and no thrust history keeps (tests/reference)."""


@pytest.fixture(scope="module", params=POINTS)
def atlas(request: pytest.FixtureRequest) -> Atlas:
    return build(Question(Scenario.of(*POINTS[request.param])))


def _starts(count: int) -> Floats:
    return np.random.default_rng(5).uniform([-230.0, 0.0], [230.0, 150.0], (count, 2))


def test_the_gap_is_closed_to_the_tolerance(atlas: Atlas) -> None:
    assert atlas.message == ""
    assert 0.0 <= atlas.relative_gap <= 0.005
    assert atlas.inner_area > 0.0


def test_the_bracket_holds_the_exact_margin(atlas: Atlas) -> None:
    starts = _starts(25)
    lower, upper = atlas.bounds(starts)
    for start, low, high in zip(starts, lower, upper, strict=True):
        exact = decide(atlas.question, np.concatenate([start, [0.0, 0.0]]))
        assert exact.upper >= low - 1e-6
        assert exact.lower <= high + 1e-6


def test_undecided_is_the_strip_between_the_polygons(atlas: Atlas) -> None:
    starts = _starts(20_000)
    lower, upper = atlas.bounds(starts)
    assert (lower <= upper + 1e-9).all()
    undecided = np.count_nonzero((lower <= 0.0) & (upper >= 0.0))
    # The strip's area, as a share of the box of the starts, with room for the draw.
    share = (atlas.outer_area - atlas.inner_area) / (460.0 * 150.0)
    assert undecided <= 20_000 * share * 1.5 + 20


def test_every_answer_carries_a_proof_that_checks(atlas: Atlas) -> None:
    seen = set()
    for start in (*_starts(6), atlas.centre.start, 0.5 * (atlas.centre.start + atlas.rim[0].start)):
        answer = atlas.answer(start)
        if answer.verdict is Verdict.UNDECIDED:
            continue
        verified = check(proof_of(atlas.question, np.concatenate([start, [0.0, 0.0]]), answer))
        assert verified.verdict == answer.verdict.value
        assert verified.margin_m == pytest.approx(answer.margin_m, abs=1e-5)
        seen.add(answer.verdict)
    assert seen == {Verdict.GO, Verdict.NO_GO}


def test_one_start_and_many_are_the_same_answer(atlas: Atlas) -> None:
    starts = _starts(300)
    lower, upper = atlas.bounds(starts)
    for start, low, high in zip(starts, lower.tolist(), upper.tolist(), strict=True):
        answer = atlas.answer(start)
        if answer.verdict is Verdict.GO:
            assert answer.lower == pytest.approx(low, rel=1e-9, abs=1e-9)
        elif answer.verdict is Verdict.NO_GO:
            assert answer.upper == pytest.approx(high, rel=1e-9, abs=1e-9)
        else:
            assert low <= 1e-9
            assert high >= -1e-9


def test_the_sliver_is_refused() -> None:
    atlas = build(Question(Scenario.of(2.0, 0.05)))
    answer = atlas.answer(COUNTEREXAMPLE)
    assert answer.verdict is Verdict.NO_GO
    assert (
        check(proof_of(atlas.question, np.concatenate([COUNTEREXAMPLE, [0.0, 0.0]]), answer)).verdict
        == "NO_GO"
    )


def test_beyond_the_cut_nothing_is_said(atlas: Atlas) -> None:
    answer = atlas.answer(np.array([0.0, 151.0]))
    assert answer.verdict is Verdict.UNDECIDED
    assert "beyond" in answer.reason


def test_no_start_can_stay() -> None:
    """Fast tumble, little thrust, long horizon: the set is empty and every answer is a proved NO_GO."""
    atlas = build(Question(Scenario.of(30.0, 1e-4)))
    assert atlas.deepest.margin < 0.0
    lower, upper = atlas.bounds(_starts(500))
    assert (upper < 0.0).all()
    assert np.isneginf(lower).all()


def test_tighter_tolerance_asks_more(atlas: Atlas) -> None:
    tight = build(atlas.question, tolerance=0.0005)
    assert tight.relative_gap <= 0.0005
    assert tight.inner_area >= atlas.inner_area - 1e-6
    assert tight.outer_area <= atlas.outer_area + 1e-6


@pytest.mark.parametrize(
    ("question", "arguments"),
    [
        (Question(Scenario.of(3.0, 0.1), dimensions=3), {}),
        (Question(Scenario.of(3.0, 0.1)), {"y_max": 0.1}),
        (Question(Scenario.of(3.0, 0.1)), {"tolerance": 0.0}),
    ],
)
def test_bad_atlases(question: Question, arguments: dict[str, float]) -> None:
    with pytest.raises(InvalidInput):
        build(question, **arguments)


def test_bad_points(atlas: Atlas) -> None:
    for points in (np.zeros(3), np.array([np.nan, 0.0])):
        with pytest.raises(InvalidInput):
            atlas.bounds(points)


@pytest.mark.parametrize("tolerance", [0.1, 0.01, 0.001])
def test_sandwich_of_an_ellipse(tolerance: float) -> None:
    axes = np.diag([3.0, 1.0])

    def oracle(direction: Floats) -> Support[None]:
        reach = float(np.linalg.norm(axes @ direction))
        return Support(direction, axes @ axes @ direction / reach, reach, None)

    found = refine(oracle, tolerance, 1000)
    assert found.relative_gap <= tolerance
    assert found.inner_area <= 3.0 * np.pi <= found.outer_area
    # 1 / n^2: the number of directions grows as the root of the accuracy.
    assert len(found.supports) <= 6.0 / np.sqrt(tolerance)
