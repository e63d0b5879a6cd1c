"""Comparison of two regions on one grid: IoU, violation fraction, confusion matrix. Undefined values are None."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from safestart.model.scenario import Bools


def _count(mask: Bools) -> int:
    return int(np.count_nonzero(mask))


def iou(a: Bools, b: Bools) -> float | None:
    """Intersection over union of two masks of equal shape; None when both are empty."""
    union = _count(a | b)
    return _count(a & b) / union if union else None


def violation(a: Bools, b: Bools) -> float | None:
    """Share of ``a`` that lies outside ``b``, |A minus B| / |A|; None when A is empty."""
    size = _count(a)
    return _count(a & ~b) / size if size else None


def ratio(numerator: float, denominator: float) -> float | None:
    """Quotient, or None when the denominator is 0."""
    return numerator / denominator if denominator else None


def wilson(successes: int, trials: int, z: float = 1.959963984540054) -> tuple[float, float] | None:
    """Wilson score interval of a share (95 % for the default z); None without trials."""
    if trials == 0:
        return None
    share, square = successes / trials, z * z / trials
    middle = (share + 0.5 * square) / (1.0 + square)
    half = z / (1.0 + square) * math.sqrt(share * (1.0 - share) / trials + 0.25 * square / trials)
    # Rounding could leave the interval just short of 0 or 1 at the ends.
    low = 0.0 if successes == 0 else max(0.0, middle - half)
    return low, 1.0 if successes == trials else min(1.0, middle + half)


def most_successes(trials: int, most: float) -> int:
    """The most successes among ``trials`` whose Wilson interval of 95 % ends by ``most``; -1: not even none."""
    count = -1
    while count < trials and _end(count + 1, trials) <= most:
        count += 1
    return count


def least_runs(most: float) -> int:
    """The least trials of which none with a success shows a share of at most ``most`` in (0, 1), by the same interval.

    Without a success the interval ends at z^2 / (trials + z^2).
    """
    square = 1.959963984540054**2
    trials = max(math.floor(square * (1.0 - most) / most), 1)
    while _end(0, trials) > most:
        trials += 1
    return trials


def _end(successes: int, trials: int) -> float:
    interval = wilson(successes, trials)
    return 1.0 if interval is None else interval[1]


@dataclass(frozen=True, slots=True)
class ConfusionMatrix:
    """Counts of a prediction against the truth, with the usual rates."""

    tp: int
    fp: int
    fn: int
    tn: int

    @classmethod
    def of(cls, predicted: Bools, actual: Bools, domain: Bools) -> ConfusionMatrix:
        """Count over the cells of ``domain``; all arrays have one shape."""
        p, a = predicted[domain], actual[domain]
        return cls(_count(p & a), _count(p & ~a), _count(~p & a), _count(~p & ~a))

    @property
    def precision(self) -> float | None:
        """tp / (tp + fp)."""
        return ratio(self.tp, self.tp + self.fp)

    @property
    def recall(self) -> float | None:
        """tp / (tp + fn)."""
        return ratio(self.tp, self.tp + self.fn)

    @property
    def accuracy(self) -> float | None:
        """(tp + tn) / all."""
        return ratio(self.tp + self.tn, self.tp + self.fp + self.fn + self.tn)

    @property
    def f1(self) -> float | None:
        """2 tp / (2 tp + fp + fn)."""
        return ratio(2 * self.tp, 2 * self.tp + self.fp + self.fn)

    @property
    def mcc(self) -> float | None:
        """Matthews correlation; None when a row or column of the matrix is empty."""
        tp, fp, fn, tn = self.tp, self.fp, self.fn, self.tn
        return ratio(tp * tn - fp * fn, math.sqrt((tp + fp) * (tp + fn) * (tn + fp) * (tn + fn)))

    def document(self) -> dict[str, float | int | None]:
        """Counts and rates for JSON."""
        return {
            "tp": self.tp,
            "fp": self.fp,
            "fn": self.fn,
            "tn": self.tn,
            "precision": self.precision,
            "recall": self.recall,
            "accuracy": self.accuracy,
            "f1": self.f1,
            "mcc": self.mcc,
        }
