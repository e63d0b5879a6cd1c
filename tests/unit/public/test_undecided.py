"""What is UNDECIDED has no margin, by every way in: the middle of a bracket that holds 0 is no bound."""

from __future__ import annotations

import math
from typing import Any

import pytest

import safestart as ss
from safestart.exact.answer import BETWEEN, Answer, Verdict, concluded
from safestart.processes.door import parse
from safestart.processes.execute import execute
from safestart.processes.go_no_go.methods import exact
from safestart.runtime.progress import Context


def between(scenario: ss.Scenario, y: float, side: float, **asked: Any) -> list[float]:
    """x of starts that are UNDECIDED, between one that is GO and one that is NO_GO: halved until none is left."""
    go, no = 0.0, side * (2.5 + 1.5 * (y - 0.5))
    found = []
    for _ in range(60):
        middle = 0.5 * (go + no)
        verdict = ss.decide(scenario, (middle, y), **asked).verdict
        if verdict == "UNDECIDED":
            found.append(middle)
        go, no = (middle, no) if verdict == "GO" else (go, middle)
        if len(found) == 4:
            break
    return found


@pytest.mark.parametrize(("rate", "y", "side", "rest"), [(3.0, 50.0, 1.0, "lvlh"), (1.0, 20.0, -1.0, "body")])
def test_python_and_the_service_say_the_same_of_the_undecided(
    rate: float, y: float, side: float, rest: str
) -> None:
    scenario = ss.Scenario.of(rate, 0.1)
    xs = between(scenario, y, side, rest=rest, horizon_s=20.0)
    assert xs
    asked = {"omega_t_deg_s": rate, "a_max_m_s2": 0.1, "horizon_s": 20, "rest": rest, "method": "exact"}
    states = [{"x_m": x, "y_m": y} for x in xs]
    posted = execute("go-no-go", asked | {"states": states}, Context()).document["outputs"]
    for k, x in enumerate(xs):
        decision = ss.decide(scenario, (x, y), rest, horizon_s=20.0)
        got = parse(asked | states[k]).document(Context())
        assert decision.verdict == got["verdict"] == posted["verdict"][k] == "UNDECIDED"
        assert decision.reason == got["reason"] == posted["reason"][k]
        assert math.isnan(decision.margin_m)
        assert got["margin_m"] is posted["margin_m"][k] is None
        # The bracket is told, as a bracket.
        assert "margin between" in decision.reason


def test_an_arrival_without_the_proof_that_was_asked_has_no_margin() -> None:
    """Its flight keeps 0.25 m, but an UNDECIDED beside a positive margin reads as a GO."""
    asked = {
        "omega_t_deg_s": 2,
        "a_max_m_s2": 0.05,
        "question": "synchronize",
        "after_arrival": "hold",
        "method": "exact",
        "ball_radius_m": 0.001,
        "rest_speed_m_s": 0.05,
    }
    got = parse(asked | {"x_m": 5, "y_m": 40}).document(Context())
    assert (got["verdict"], got["margin_m"]) == ("UNDECIDED", None)


def test_of_every_bracket() -> None:
    open_ = concluded((-1.0, 2.0), None, (), 1, BETWEEN)
    assert (open_.verdict, open_.margin_m) == (Verdict.UNDECIDED, 0.5)
    assert math.isnan(open_.proved_m)
    for bracket, margin in (((1.0, 2.0), 1.0), ((-2.0, -1.0), -1.0)):
        assert concluded(bracket, None, (), 1, "").proved_m == margin


def test_a_failure_of_the_solver_has_no_margin(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: Any, **__: Any) -> Answer:
        return concluded((-1.0, 1.5), None, (), 1, "the solver gave up")

    monkeypatch.setattr(exact, "decide_start", fails)
    monkeypatch.setattr("safestart.public.decisions.decide_start", fails)
    asked = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "x_m": 5, "y_m": 40, "method": "exact"}
    assert parse(asked).document(Context())["margin_m"] is None
    assert math.isnan(ss.decide(ss.Scenario.of(3.0, 0.1), (5.0, 40.0)).margin_m)
