"""What an engine answers is checked before it is counted: a failure has no region, a success one of the grid."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from safestart.engines.analytical import Analytical
from safestart.engines.base import EngineResult, Problem, ResultCode
from safestart.errors import InvalidInput, UnfitResult
from safestart.model.registry import by_name
from safestart.model.scenario import Grid, Scenario
from safestart.processes.execute import execute
from safestart.runtime.progress import Context

PROBLEM = Problem(Scenario.of(3.0, 0.1), Grid(9, 7, 80.0))
INSIDE = PROBLEM.inside()
GOOD = EngineResult(ResultCode.OK, INSIDE & False, np.zeros(INSIDE.shape), 0.1)
WRONG: dict[str, tuple[dict[str, Any], str]] = {
    "a failure with a region": (
        {"code": ResultCode.NUMERICAL_FAILURE},
        "mask: required none with numerical_failure, received one",
    ),
    "a success without": ({"mask": None}, "mask: required bool.*received NoneType"),
    "no such code": ({"code": "okay"}, "code: required a ResultCode, received 'okay'"),
    "transposed": ({"mask": GOOD.mask.T}, r"mask: required bool.*\(7, 9\), received bool, \(9, 7\)"),
    "floats": ({"mask": GOOD.mask * 1.0}, "mask: required bool.*received float64"),
    "outside": ({"mask": ~INSIDE}, r"mask: required cells inside the corridor, received \d+ outside"),
    "a margin of other cells": (
        {"margin": np.zeros(3)},
        r"margin: required floating.*received float64, \(3,\)",
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_it_is_refused(case: str) -> None:
    changed, said = WRONG[case]
    assert GOOD.fit("mine", INSIDE) is GOOD
    with pytest.raises(UnfitResult, match=f"engine mine: {said}"):
        replace(GOOD, **changed).fit("mine", INSIDE)


def test_a_failure_without_a_region_is_an_answer() -> None:
    failed = EngineResult(ResultCode.NUMERICAL_FAILURE, None, None, 0.1)
    assert failed.fit("mine", INSIDE) is failed


def test_a_benchmark_does_not_count_it(monkeypatch: pytest.MonkeyPatch) -> None:
    right = Analytical.solve

    def swollen(self: Analytical, problem: Problem, context: Context) -> EngineResult:
        return replace(right(self, problem, context), mask=np.ones(problem.inside().shape, dtype=np.bool_))

    monkeypatch.setattr(Analytical, "solve", swollen)
    asked = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "engines": ["analytical"], "horizon_s": 10}
    with pytest.raises(UnfitResult, match="engine analytical: mask: required cells inside"):
        execute("benchmark", asked | {"grid": {"nx": 9, "ny": 7, "y_max_m": 80}})


def test_a_name_is_registered_once() -> None:
    assert list(by_name("letters", "abc", str)) == ["a", "b", "c"]
    with pytest.raises(InvalidInput, match="letters: required names that come once each, received 'b'"):
        by_name("letters", "abcb", str)
