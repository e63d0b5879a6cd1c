"""Starts that the paper's conditions certify and no thrust history can keep in the corridor: proved, and not certified.

The conditions ignore the mean motion (without tumble nothing bounds the range), the height in their erosion, and what
a narrow corridor leaves to turn in. Each NO_GO is proved by a document that the independent checker accepts; the two
planar ones of 60 s also by a linear program of its own (``test_certificate_limits``), a relaxation of the question.
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from safestart.closed_form import certified, paper
from safestart.model.scenario import CorridorShape, Scenario
from safestart.processes.execute import execute
from safestart.processes.go_no_go.spec import GoNoGoInputs
from safestart.proofs.checker import check
from tests.reference.test_certificate_limits import best_margin

# deg/s, m/s^2, slope c_x, horizon (s), start (m); margin of the paper's conditions and proved bound on the margin (m).
CASES: dict[str, tuple[float, float, float, float, tuple[float, ...], float, float]] = {
    "no tumble": (0.0, 1e-3, 1.5, 300.0, (590.0, 400.0), 6.518, -18.871),
    "in space": (1.7656, 0.0781, 1.5, 60.0, (28.6, 94.099, -131.669), 0.0227, -10.936),
    "narrow corridor": (2.0, 1.0, 0.4, 60.0, (-153.0, 1023.1), 0.784, -60.641),
    "slow tumble, weak thrust": (0.02, 1e-3, 1.5, 600.0, (1046.2, 960.9), 3.813, -564.928),
    "next to the range limit": (2.0, 0.05, 1.5, 60.0, (9.364, 81.044), 0.487, -1.194),
}


def scenario_of(name: str) -> Scenario:
    rate, thrust, slope, *_ = CASES[name]
    usual = Scenario.of(rate, thrust)
    return Scenario(usual.target, usual.chaser, CorridorShape(c_x=slope))


def asked(name: str, **more: Any) -> dict[str, Any]:
    rate, thrust, slope, horizon, start, *_ = CASES[name]
    state = dict(zip(("x_m", "y_m", "z_m"), start, strict=False))
    inputs = {"omega_t_deg_s": rate, "a_max_m_s2": thrust, "corridor": {"c_x": slope}, "horizon_s": horizon}
    found: dict[str, Any] = execute("go-no-go", inputs | {"states": [state]} | more).document["outputs"]
    return found


@pytest.mark.parametrize("name", CASES)
def test_the_paper_says_go(name: str) -> None:
    start, margin = CASES[name][4:6]
    found = paper.certify(scenario_of(name), np.array(start))
    assert bool(found.safe)
    assert float(found.margin) == pytest.approx(margin, abs=2e-3)
    said = asked(name, method="paper")
    assert (said["verdict"], said["decided_by"]) == (["GO"], ["paper"])


@pytest.mark.parametrize("name", CASES)
def test_the_certificate_does_not(name: str) -> None:
    assert not bool(certified.certify(scenario_of(name), np.array(CASES[name][4])).go)
    assert asked(name, method="certified")["verdict"] == ["UNDECIDED"]


@pytest.mark.parametrize("name", CASES)
def test_no_thrust_history_stays(name: str) -> None:
    """By default NO_GO, with a proof that the checker accepts; the bound is the stated one."""
    said = asked(name)
    assert (said["method"], said["verdict"], said["decided_by"]) == ("auto", ["NO_GO"], ["exact"])
    proved = asked(name, proofs=True)
    assert proved["margin_m"][0] == pytest.approx(CASES[name][6], abs=1e-3)
    verified = check(json.loads(json.dumps(proved["proof"][0])))
    assert verified.verdict == "NO_GO"
    assert verified.margin_m == pytest.approx(CASES[name][6], abs=1e-3)


@pytest.mark.parametrize("name", ["narrow corridor", "next to the range limit"])
def test_a_program_of_its_own_agrees(name: str) -> None:
    start, _, bound = CASES[name][4:]
    found = best_margin(scenario_of(name), np.array(start), 60.0, 2.0)
    assert found == pytest.approx(bound, abs=0.06 * abs(bound))
    assert found < 0.0


def test_nobody_is_told_go_who_does_not_name_the_paper() -> None:
    """Every process that says GO, at its defaults, at the operating point of the first case."""
    assert GoNoGoInputs.model_fields["method"].default == "auto"
    point = {"omega_t_deg_s": 0.0, "a_max_m_s2": 1e-3}
    grid = {"nx": 60, "ny": 41, "y_max_m": 500}  # holds (590, 400) to some metres
    region = execute("certificate", point | {"grid": grid}).document["outputs"]
    x, y = np.array(region["x_m"]), np.array(region["y_m"])
    cell = int(np.argmin(np.abs(y - 400.0))), int(np.argmin(np.abs(x - 590.0)))
    assert not region["mask"][cell[0]][cell[1]]
    old = execute("certificate", point | {"grid": grid, "certificate": "paper"}).document["outputs"]
    assert old["safe_fraction"] > region["safe_fraction"]
    assert old["mask"][cell[0]][int(np.argmin(np.abs(x - 500.0)))]
    needed = execute(
        "thrust-map", {"omega_t_deg_s": [0.0], "a_max_m_s2": [1e-3], "stand_off_m": 400}
    ).document["outputs"]
    assert needed["paper_required_a_max_m_s2"] == [pytest.approx(1e-6)]
