"""The outcome of a result: the worst of its findings, and what it rests on."""

from __future__ import annotations

from typing import Any

import pytest

from safestart.processes.go_no_go.spec import UNPROVED
from safestart.processes.outcome import outcome_of


def said(word: str, sense: str, count: int, of: int, basis: str | None = None) -> dict[str, Any]:
    return {"word": word, "sense": sense, "count": count, "of": of, "basis": basis}


@pytest.mark.parametrize(
    ("verdicts", "outcome"),
    [
        (["GO", "GO"], said("GO", "good", 2, 2)),
        (["GO", "UNDECIDED"], said("UNDECIDED", "open", 1, 2)),
        (["NO_GO", "UNDECIDED", "GO", "NO_GO"], said("NO_GO", "bad", 2, 4)),
        ([], None),
    ],
)
def test_the_worst_word_counts(verdicts: list[str], outcome: dict[str, Any] | None) -> None:
    assert outcome_of("go-no-go", {"verdict": verdicts, "states": [[1, 2]] * len(verdicts)}) == outcome


@pytest.mark.parametrize("method", UNPROVED)
def test_a_verdict_without_a_proof_decides_nothing(method: str) -> None:
    outputs = {"verdict": ["GO"], "states": [[1, 2]], "method": method}
    assert outcome_of("go-no-go", outputs) == said("GO", "open", 1, 1, method)


def test_findings_within_rows() -> None:
    windows = [{"findings": [{"verdict": word}]} for word in ("SAFE", "UNSAFE")]
    assert outcome_of("passive-safety", {"windows": windows}) == said("UNSAFE", "bad", 1, 2)


def test_a_single_row_is_a_finding_too() -> None:
    assert outcome_of("flight", {"verdict": "GO", "margin_m": 1.0}) == said("GO", "good", 1, 1)


def test_no_findings_no_outcome() -> None:
    assert outcome_of("benchmark", {"rows": []}) is None
    assert outcome_of("of another version", {"verdict": "GO"}) is None
