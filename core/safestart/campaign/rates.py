"""Shares of the cases of a campaign, with Wilson intervals of 95 %."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from safestart.campaign.table import Table
from safestart.model.metrics import ConfusionMatrix, ratio, wilson


@dataclass(frozen=True, slots=True)
class Share:
    """How often a flag is set among the rows where it is known, with its Wilson interval of 95 %."""

    flag: str

    def of(self, table: Table) -> list[int]:
        """Set, known."""
        return [int(table.flagged(self.flag).sum()), int(table.known(self.flag).sum())]

    def add(self, state: list[int], more: list[int]) -> list[int]:
        """Entry by entry."""
        return [a + b for a, b in zip(state, more, strict=True)]

    def said(self, state: list[int]) -> dict[str, Any]:
        """``count`` of ``cases``, ``share`` and ``wilson_95`` (None without a case)."""
        count, cases = state
        interval = wilson(count, cases)
        return {
            "count": count,
            "cases": cases,
            "share": ratio(count, cases),
            "wilson_95": None if interval is None else list(interval),
        }


@dataclass(frozen=True, slots=True)
class Confusion:
    """A prediction against the truth, over the rows with a known prediction."""

    predicted: str
    actual: str

    def of(self, table: Table) -> list[int]:
        """tp, fp, fn, tn."""
        asked = table.known(self.predicted)
        predicted, actual = table.flagged(self.predicted)[asked], table.flagged(self.actual)[asked]
        counts = np.bincount(2 * predicted.astype(np.int64) + actual, minlength=4).tolist()
        return [counts[3], counts[2], counts[1], counts[0]]

    def add(self, state: list[int], more: list[int]) -> list[int]:
        """Entry by entry."""
        return [a + b for a, b in zip(state, more, strict=True)]

    def said(self, state: list[int]) -> dict[str, Any]:
        """Counts with their rates and Wilson intervals of 95 %; None where there is no case."""
        tp, fp, fn, tn = state
        intervals = {
            "precision": wilson(tp, tp + fp),
            "recall": wilson(tp, tp + fn),
            "false_positive_rate": wilson(fp, fp + tn),
        }
        return {
            **ConfusionMatrix(tp, fp, fn, tn).document(),
            "false_positive_rate": ratio(fp, fp + tn),
            "false_positive_share": ratio(fp, tp + fp + fn + tn),
            "wilson_95": {name: None if pair is None else list(pair) for name, pair in intervals.items()},
        }
