"""The sweep: starts, counts, truth options, records; the same whatever the shards are run in."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from safestart.closed_form.paper import certify
from safestart.constraints.corridor import corridor_of
from safestart.errors import InvalidInput
from safestart.model.metrics import wilson
from safestart.model.scenario import Scenario
from safestart.processes.execute import execute
from safestart.processes.registry import process
from safestart.processes.sharding import MAX_SHARDS
from safestart.processes.sweep.cases import cases_of
from safestart.processes.sweep.fleet import fly_all
from safestart.processes.sweep.inputs import SweepInputs
from safestart.processes.sweep.split import DRAWN
from safestart.records import parquet
from safestart.records.comparable import comparable
from safestart.runtime.progress import Context

SHARDING = process("sweep").sharding
FILTER: dict[str, Any] = {"controllers": ["filter"], "certificates": ["paper"]}


def outputs_of(**asked: Any) -> Any:
    """The document of a sweep without its files."""
    parsed = process("sweep").parse(asked)
    done = [SHARDING.run_part(part, Context()).document for part in SHARDING.parts(parsed)]
    return SHARDING.so_far(parsed, done)


def inputs(**values: Any) -> SweepInputs:
    return SweepInputs.model_validate(values)


@pytest.mark.parametrize("per_cell", [1, 9, 30_000, 160_000])
@pytest.mark.parametrize("controllers", [["filter"], ["filter", "sequence"]])
def test_the_parts_hold_every_case_once(per_cell: int, controllers: list[str]) -> None:
    if per_cell > 1000 and "sequence" in controllers:
        per_cell = 3000
    asked = inputs(cases_per_cell=per_cell, controllers=controllers)
    seen: dict[int, int] = {}
    for number, part in enumerate(SHARDING.parts(asked)):
        assert part["number"] == number
        assert part["pieces"]
        for cell, first, count in part["pieces"]:
            assert seen.get(cell, 0) == first
            seen[cell] = first + count
    assert seen == dict.fromkeys(range(60), per_cell)


@pytest.mark.parametrize("distribution", ["grid", "monte_carlo", "latin_hypercube"])
def test_starts_lie_in_the_corridor_at_their_range(distribution: str) -> None:
    asked = inputs(distribution=distribution, cases=200, cases_per_cell=3, r0_m=[0.6, 3.0, 100.0])
    groups = [c for p in SHARDING.parts(asked) for c in cases_of(asked, p["pieces"])]
    points = np.concatenate([c.points for c in groups])
    assert sorted(np.concatenate([c.numbers for c in groups])) == list(range(len(points)))
    ranges = np.hypot(*points.T)
    assert (corridor_of(asked.corridor.shape()).slack(points) >= -1e-9).all()
    if distribution == "grid":
        assert set(np.round(ranges, 9)) == {0.6, 3.0, 100.0}
        # The widest angle is the corridor's: an angle a hair farther out is outside.
        far = points[ranges > 50]
        assert np.abs(np.arctan2(far[:, 0], far[:, 1])).max() > 0.8 * math.atan(1.5)
    else:
        assert 0.6 <= ranges.min() < 10.0 < 90.0 < ranges.max() <= 100.0


def test_the_starts_do_not_depend_on_what_is_flown() -> None:
    found = []
    for controllers in (["filter"], ["sequence"]):
        asked = inputs(controllers=controllers, cases_per_cell=130, omega_t_deg_s=[1, 3], a_max_m_s2=[0.1])
        groups = [c for p in SHARDING.parts(asked) for c in cases_of(asked, p["pieces"])]
        order = np.argsort(np.concatenate([c.numbers for c in groups]))
        found.append(np.concatenate([c.points for c in groups])[order])
    np.testing.assert_array_equal(*found)
    assert len(np.unique(found[0][:, 0])) == len(found[0])


def test_a_latin_hypercube_is_stratified() -> None:
    asked = inputs(distribution="latin_hypercube", cases=100, r0_m=[10.0, 110.0])
    (part,) = SHARDING.parts(asked)
    ranges = np.array([math.hypot(*c.points[0]) for c in cases_of(asked, part["pieces"])])
    assert sorted(np.floor(ranges - 10.0).astype(int)) == list(range(100))


def test_counts_are_those_of_the_records() -> None:
    result = execute("sweep", {**FILTER, "controllers": ["filter", "filter_fine"], "cases_per_cell": 4})
    outputs = result.document["outputs"]
    process("sweep").outputs.model_validate(outputs)
    files = {artifact.name: artifact for artifact in result.artifacts}
    table = parquet.read(files["cases.parquet"].data).to_pydict()
    assert table["case"] == list(range(240))
    certified = np.array(table["certified_paper"])
    points = np.stack([table["x_m"], table["y_m"]], axis=1)
    for omega, a_max, point, said in zip(
        table["omega_t_deg_s"], table["a_max_m_s2"], points, certified, strict=True
    ):
        assert bool(certify(Scenario.of(omega, a_max), point).safe) == said
    for name in ("filter", "filter_fine"):
        safe = np.array(table[f"safe_{name}"])
        cell = outputs["confusion"]["paper"][name]
        counts = [(certified & safe).sum(), (certified & ~safe).sum(), (~certified & safe).sum()]
        assert [cell["tp"], cell["fp"], cell["fn"]] == counts
        assert sum(cell[k] for k in ("tp", "fp", "fn", "tn")) == 240
        flown = np.array(table[f"delta_v_m_s_{name}"])[safe]
        assert outputs["delta_v_m_s"][name]["mean"] == pytest.approx(flown.mean())
        assert outputs["delta_v_m_s"][name]["std"] == pytest.approx(flown.std())
        late = np.array([math.inf if t is None else t for t in table[f"violated_at_s_{name}"]])
        np.testing.assert_array_equal(np.isinf(late), safe)
        assert sum(c["feasible"][name] for c in outputs["cells"]) == safe.sum()
        worst = outputs["worst"][name]
        lost = [case for case in worst if case["violated_at_s"] is not None]
        assert worst[: len(lost)] == lost
        assert len(lost) == min(5, cell["fp"])
    assert {"confusion.png", "table.png", "worst.png", "trajectories.npz"} <= set(files)


def test_sequence_flies_every_exact_go_and_nothing_else() -> None:
    asked = {"cases_per_cell": 2, "omega_t_deg_s": [1, 2, 4], "a_max_m_s2": [0.02, 0.1], "seed": 3}
    outputs = outputs_of(**asked)
    cell = outputs["confusion"]["exact"]["sequence"]
    assert (cell["fp"], cell["fn"]) == (0, 0)
    assert cell["tp"] >= 10
    assert cell["tn"] >= 10
    closed = outputs["confusion"]["paper"]["sequence"]
    assert closed["fp"] == 0
    assert outputs["undecided"] == 0
    low, high = cell["wilson_95"]["precision"]
    assert low < 1.0 == high


def test_the_filter_presets_reach_their_precision() -> None:
    tuned = outputs_of(**FILTER)["confusion"]["paper"]["filter"]
    assert tuned["tp"] + tuned["fp"] + tuned["fn"] + tuned["tn"] == 540
    assert tuned["precision"] >= 0.98
    asked = {**FILTER, "preset": "paper", "cases_per_cell": 27}
    paper = outputs_of(**asked)["confusion"]["paper"]["filter"]
    assert paper["precision"] == pytest.approx(0.80, abs=0.04)
    assert paper["recall"] == pytest.approx(0.91, abs=0.04)
    # One cause switched off: the closing-speed cap that the braking distance can afford.
    capped = {**asked, "filter": {"closing_factor": 0.6, "braking_share": 0.25}}
    mended = outputs_of(**capped)["confusion"]["paper"]["filter"]
    assert mended["precision"] >= 0.99


@pytest.mark.slow
def test_order_and_place_of_the_shards_do_not_matter() -> None:
    asked = {**FILTER, "cases_per_cell": 500, "certificates": ["paper"]}
    parsed = process("sweep").parse(asked)
    parts = SHARDING.parts(parsed)
    assert len(parts) > 1
    done = {n: SHARDING.run_part(parts[n], Context()) for n in reversed(range(len(parts)))}
    output = SHARDING.merged(parsed, [done[n] for n in range(len(parts))], Context())
    other = execute("sweep", asked)
    assert comparable(output.document) == comparable(other.document["outputs"])
    assert [a.sha256 for a in output.artifacts] == [a.sha256 for a in other.artifacts]
    half = SHARDING.so_far(parsed, [done[0].document])
    process("sweep").outputs.model_validate(half)
    assert 0 < half["cases"] < other.document["outputs"]["cases"]


def test_an_atlas_and_single_answers_agree() -> None:
    asked = {"controllers": ["filter"], "certificates": ["exact"], "omega_t_deg_s": [3], "a_max_m_s2": [0.1]}
    many = execute("sweep", {**asked, "cases_per_cell": 120, "r0_m": [30, 50, 100, 150]})
    table = parquet.read({a.name: a for a in many.artifacts}["cases.parquet"].data).to_pydict()
    from safestart.exact.decide import decide
    from safestart.exact.question import Question

    question = Question(Scenario.of(3.0, 0.1))
    for row in range(0, 480, 40):
        state = np.array([table["x_m"][row], table["y_m"][row], 0.0, 0.0])
        said = decide(question, state, verdict_only=True).verdict.value
        assert (said == "GO") == table["certified_exact"][row]


def test_noise_belongs_to_the_case_and_not_to_the_shard() -> None:
    noise = {
        "navigation_position_sigma_m": 0.3,
        "navigation_velocity_sigma_m_s": 0.02,
        "thrust_magnitude_sigma": 0.05,
    }
    asked = inputs(**FILTER, cases_per_cell=4, omega_t_deg_s=[2], a_max_m_s2=[0.1], truth=noise)
    (part,) = SHARDING.parts(asked)
    (cases,) = cases_of(asked, part["pieces"])
    whole = fly_all(asked, "filter", cases, lambda done: None)
    from safestart.processes.sweep.fleet import fly_one

    for row in range(0, 16, 5):
        single = fly_one(asked, "filter", cases, row)
        assert single.safe == whole.safe[row]
        assert single.delta_v == pytest.approx(whole.delta_v[row], abs=1e-9)
    quiet = fly_all(inputs(**FILTER, cases_per_cell=4), "filter", cases, lambda done: None)
    assert (quiet.delta_v != whole.delta_v).any()


@pytest.mark.parametrize(
    ("wrong", "field"),
    [
        ({"controllers": []}, "controllers"),
        ({"controllers": ["filter", "filter"]}, "controllers"),
        ({"controllers": ["autopilot"]}, "controllers"),
        ({"horizon_s": 61}, "horizon_s"),
        ({"r0_m": [0.4]}, "r0_m"),
        ({"cases_per_cell": 20_000_000, "controllers": ["filter"]}, "cases_per_cell"),
        ({"cases_per_cell": 100_000}, "cases_per_cell"),
        ({"truth": {"model": "two_body_j2"}, "mean_motion_rad_s": 0}, "mean_motion"),
        ({"truth": {"thrust_magnitude_sigma": -1}}, "thrust_magnitude_sigma"),
    ],
)
def test_bad_input_is_named(wrong: dict[str, Any], field: str) -> None:
    with pytest.raises(InvalidInput, match=field):
        process("sweep").parse(wrong)


def test_wilson_intervals() -> None:
    # Newcombe (1998), table I: 81 of 263 gives 0.2553 to 0.3662; 0 of 20 gives 0 to 0.1611.
    assert wilson(81, 263) == pytest.approx((0.2553, 0.3662), abs=1e-4)
    assert wilson(0, 20) == pytest.approx((0.0, 0.1611), abs=1e-4)
    assert wilson(20, 20) == pytest.approx((0.8389, 1.0), abs=1e-4)
    assert wilson(0, 0) is None


def test_a_very_large_sweep_has_larger_shards_of_whole_draws_and_not_more_of_them() -> None:
    asked = inputs(cases_per_cell=16_666_666, controllers=["filter"])
    parts = SHARDING.parts(asked)
    assert 7_000 <= len(parts) <= MAX_SHARDS
    last: dict[int, int] = {}
    for part in parts:
        for cell, first, count in part["pieces"]:
            assert first == last.get(cell, 0)
            assert first % DRAWN == 0
            last[cell] = first + count
    assert last == dict.fromkeys(range(60), 16_666_666)
