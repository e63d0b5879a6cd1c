"""The process approach-trade: its figures against those of hopping, its verdicts, its refusals."""

import numpy as np
import pytest

from safestart.errors import InvalidInput
from safestart.model.metrics import least_runs, most_successes, wilson
from safestart.processes.approach_trade.findings import findings_of, front_of
from safestart.processes.execute import execute
from safestart.processes.registry import process

ASKED = {"angles_deg": [130, 0, 90], "runs": 40, "demand": {"breach": 0.1}, "kappas": [5], "seed": 4}


@pytest.fixture(scope="module")
def traded():
    return execute("approach-trade", ASKED).document["outputs"]


def by_angle(traded):
    return {row["angle_deg"]: row for row in traded["approaches"]}


def test_an_approach_is_the_one_that_hopping_flies_and_proves(traded) -> None:
    row = by_angle(traded)[0]
    said = execute("hopping", {"angle_deg": 0, "runs": 40, "seed": 4}).document["outputs"]
    assert row["breach"]["count"] == said["study"]["breach"]["count"] > 0
    assert row["breach"]["low"] == said["study"]["breach"]["low"]
    assert row["breach"]["high"] == said["study"]["breach"]["high"]
    assert row["lambda"] == said["proof"]["lambda"]
    for name in ("orbits", "fuel_1norm_m_s", "fuel_2norm_m_s"):
        assert row[name] == said["plan"][name]


def test_beyond_the_papers_angles_it_is_cheaper_than_the_r_bar_and_safer(traded) -> None:
    """Fuel by the plans of the findings (6.019 and 4.109 m/s, 8.232 and 5.739 in the 1-norm)."""
    _, beyond = traded["findings"]
    assert beyond["verdict"] == "HELD"
    assert beyond["angle_deg"] == 130
    assert beyond["less_fuel_1norm_percent"] == pytest.approx(100 * (1 - 5.739 / 8.232), abs=0.02)
    assert beyond["less_fuel_2norm_percent"] == pytest.approx(100 * (1 - 4.109 / 6.019), abs=0.02)
    assert beyond["lambda"] > by_angle(traded)[90]["lambda"]
    assert [row["angle_deg"] for row in traded["front"]] == [0, 130]


def test_the_v_bar_takes_a_remedy_and_says_what_it_costs(traded) -> None:
    row = by_angle(traded)[0]
    assert (row["verdict"], row["risk"], row["level"]) == ("REMEDIED",) * 3
    assert row["tightening"]["kappa"] == 5
    assert row["tightening"]["breach_high"] <= 0.1 < row["breach"]["low"]
    assert row["tightening"]["fuel_1norm_m_s"] > row["fuel_1norm_m_s"]
    away = row["away"]
    assert away["lambda"] >= 1.0 > row["lambda"]
    assert 0.0 < away["fuel_1norm_m_s"] / row["fuel_1norm_m_s"] - 1.0 < 0.03, "2.4 % in the findings"
    for angle in (90, 130):
        met = by_angle(traded)[angle]
        assert met["verdict"] == "MET"
        assert met["tightening"] is met["away"] is None


def test_what_cannot_be_remedied_is_not_met() -> None:
    """2 % of 21 % is missed for certain, and no kappa was allowed; no hop from 60 m drifts away enough for level 40."""
    asked = {
        "angles_deg": [0],
        "holds_m": [60],
        "runs": 40,
        "kappas": [],
        "demand": {"breach": 0.1, "error_level": 40},
    }
    (row,) = execute("approach-trade", asked).document["outputs"]["approaches"]
    assert row["risk"] == row["level"] == row["verdict"] == "NOT_MET"
    assert row["tightening"] is row["away"] is None


def test_shards_add_up(traded) -> None:
    spec = process("approach-trade")
    assert spec.sharding is not None
    inputs = spec.parse(ASKED)
    parts = spec.sharding.parts(inputs)
    assert len(parts) == 3
    nothing = spec.sharding.so_far(inputs, [])
    assert nothing["approaches"] == nothing["findings"] == []


def _row(angle: float, fuel: float, level: float, **more):
    row = {"angle_deg": angle, "hops": 5, "hold_m": 100.0, "fuel_1norm_m_s": fuel, "fuel_2norm_m_s": fuel}
    breach = {"probability": 0.0, "low": 0.0, "high": 0.01}
    return row | {"lambda": level, "verdict": "MET", "level": "MET", "breach": breach} | more


def test_the_front_holds_what_no_other_betters() -> None:
    rng = np.random.default_rng(5)
    rows = [_row(k, float(f), float(v)) for k, (f, v) in enumerate(rng.uniform(0, 1, (60, 2)).round(1))]
    front = front_of(rows)
    pairs = {(row["fuel_2norm_m_s"], row["lambda"]) for row in rows}
    best = {(f, v) for f, v in pairs if not any(g <= f and w >= v and (g, w) != (f, v) for g, w in pairs)}
    assert [(row["fuel_2norm_m_s"], row["lambda"]) for row in front] == sorted(best)


def test_findings_may_fail() -> None:
    dear = [_row(90, 5.0, 9.0), _row(120, 4.5, 10.0)]
    assert findings_of(dear, 0.01)[1]["verdict"] == "BROKEN", "10 % is less than 20 %"
    unsafe = [_row(90, 5.0, 9.0), _row(120, 3.0, 8.0)]
    assert findings_of(unsafe, 0.01)[1]["verdict"] == "BROKEN"
    assert len(findings_of([_row(120, 3.0, 10.0)], 0.01)) == 1, "nothing to compare with"
    open_ = [_row(0, 1.0, 2.0, verdict="UNDECIDED")]
    assert findings_of(open_, 0.01)[0]["verdict"] == "UNDECIDED"
    lost = [_row(0, 1.0, 2.0, verdict="NOT_MET", breach={"probability": 0.3, "low": 0.2, "high": 0.4})]
    assert findings_of(lost, 0.01)[0]["verdict"] == "BROKEN"


@pytest.mark.parametrize("share", [0.5, 0.1, 0.01, 1e-3, 1e-4])
def test_so_many_runs_and_breaches_show_a_share(share: float) -> None:
    runs = least_runs(share)
    assert wilson(0, runs)[1] <= share
    assert runs == 1 or wilson(0, runs - 1)[1] > share
    many = 3 * runs
    count = most_successes(many, share)
    assert wilson(count, many)[1] <= share < wilson(count + 1, many)[1]
    assert most_successes(max(runs - 1, 0), share) == (-1 if runs > 1 else most_successes(0, share))


@pytest.mark.parametrize(
    ("inputs", "said"),
    [
        ({"angles_deg": [0, 160]}, r"angles_deg: .*up to 145\.66 deg.*160 deg lies there"),
        ({"angles_deg": [0, 0]}, "angles_deg"),
        ({"angles_deg": []}, "angles_deg"),
        ({"holds_m": [100, 40]}, "holds_m: .*keep_out_m"),
        ({"start_m": 90}, "start_m: .*more than"),
        ({"hops": [0]}, "hops"),
        ({"angles_deg": list(range(60)), "hops": [3, 4, 5, 6]}, "at most 200 combinations.*240"),
        ({"runs": 20_000, "angles_deg": list(range(60))}, "runs: .*at most 3703"),
        ({"runs": 300}, "runs: .*at least 381"),
        ({"demand": {"breach": 0}}, "demand.breach"),
        ({"kappas": [-1]}, "kappas"),
        ({"eccentricity": 0.3}, "eccentricity: .*perigee"),
        ({"angle_deg": 3}, "angle_deg: .*no field"),
    ],
)
def test_bad_input_is_refused_by_name(inputs, said: str) -> None:
    with pytest.raises(InvalidInput, match=said):
        process("approach-trade").parse(inputs)
