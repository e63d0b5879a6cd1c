"""Region metrics against counts by hand."""

import numpy as np
import pytest
from scipy.stats import binomtest

from safestart.model.metrics import ConfusionMatrix, iou, violation, wilson

A = np.array([[True, True, False, False]])
B = np.array([[True, False, True, False]])
NONE = np.zeros((1, 4), dtype=bool)


def test_overlaps() -> None:
    assert iou(A, B) == pytest.approx(1 / 3)
    assert violation(A, B) == pytest.approx(1 / 2)
    assert iou(NONE, NONE) is None
    assert violation(A, np.array([[True, True, True, False]])) == 0.0
    assert violation(NONE, B) is None
    assert iou(A, NONE) == 0.0


def test_paper_confusion_matrix() -> None:
    """Paper 000, Table 3: TP 122, FP 30, FN 12, TN 336 give 0.80, 0.91, 0.92, 0.85, 0.80."""
    matrix = ConfusionMatrix(122, 30, 12, 336)
    assert matrix.precision == pytest.approx(0.80, abs=0.005)
    assert matrix.recall == pytest.approx(0.91, abs=0.005)
    assert matrix.accuracy == pytest.approx(0.92, abs=0.005)
    assert matrix.f1 == pytest.approx(0.85, abs=0.005)
    assert matrix.mcc == pytest.approx(0.80, abs=0.005)


def test_counts_only_the_domain() -> None:
    domain = np.array([[True, True, True, False]])
    assert ConfusionMatrix.of(A, B, domain) == ConfusionMatrix(1, 1, 1, 0)
    assert ConfusionMatrix.of(NONE, NONE, domain).document()["precision"] is None


def test_each_cell_is_counted_by_its_own_rule() -> None:
    """4 hits, 3 false alarms, 2 misses, 1 quiet cell: no two counts can be mistaken for each other."""
    predicted = np.array([True] * 4 + [True] * 3 + [False] * 2 + [False])
    actual = np.array([True] * 4 + [False] * 3 + [True] * 2 + [False])
    assert ConfusionMatrix.of(predicted, actual, np.ones(10, dtype=bool)) == ConfusionMatrix(4, 3, 2, 1)


@pytest.mark.parametrize(
    ("successes", "trials"), [(0, 1), (1, 1), (0, 40), (40, 40), (3, 7), (39, 40), (500, 1234)]
)
@pytest.mark.parametrize("level", [0.95, 0.99])
def test_wilson_intervals_are_those_of_scipy(successes: int, trials: int, level: float) -> None:
    z = {0.95: (), 0.99: (2.5758293035489004,)}[level]
    found = wilson(successes, trials, *z)
    expected = binomtest(successes, trials).proportion_ci(level, method="wilson")
    assert found == pytest.approx((expected.low, expected.high), abs=1e-12)
    assert found is not None
    assert found[0] == 0.0 or successes > 0
    assert found[1] == 1.0 or successes < trials
    assert 0.0 <= found[0] < found[1] <= 1.0


def test_wilson_of_nothing_is_nothing() -> None:
    assert wilson(0, 0) is None


def test_nothing_to_count_is_undefined() -> None:
    """An accuracy of 0 said that all was wrong where there was nothing."""
    empty = ConfusionMatrix.of(A, B, NONE)
    assert all(empty.document()[name] is None for name in ("precision", "recall", "accuracy", "f1", "mcc"))
    assert ConfusionMatrix(0, 2, 1, 0).accuracy == 0.0
