"""Process tracking-mpc: paper 002's case, refusals, infeasible starts, the study in shards."""

import numpy as np
import pytest

from safestart.errors import InvalidInput
from safestart.processes.execute import execute
from safestart.processes.registry import process

PAPER = {"attitude_reference": "lvlh"}


def test_the_paper_s_case():
    result = execute("tracking-mpc", PAPER | {"region": {"rows": 6}})
    outputs = result.document["outputs"]
    assert (outputs["time_to_5cm_s"], outputs["time_to_1cm_s"]) == (22.0, 26.0)
    assert outputs["impulse_m_s"] == pytest.approx(0.918, abs=5e-4)
    assert outputs["theta_max_m"]["printed"] == pytest.approx(3.597, abs=5e-4)
    assert outputs["y_max_m"]["printed"] == pytest.approx(2.008, abs=5e-4)
    assert outputs["feasible"]
    assert outputs["printed_counter_example"] is None
    assert outputs["exact_feasible"]
    assert np.shape(outputs["inputs_m_s"]) == (60, 3)
    assert all(row["verdict"] == "HELD" for row in outputs["statements"])
    region = outputs["region"]
    assert len(region["x_m"]) == len(region["exact"]["mask"]) == 42
    assert region["confusion"]["fp"] == 0
    assert sum(region["confusion"].values()) == 42
    assert {a.name for a in result.artifacts} == {"path.png", "over_time.png", "flight.npz", "region.png"}


def test_infeasible_is_an_answer():
    outputs = execute("tracking-mpc", PAPER | {"start": {"position_m": [13.0, 14.0, 0.0]}}).document[
        "outputs"
    ]
    assert not outputs["feasible"]
    assert not outputs["exact_feasible"]
    assert outputs["exact_infeasibility_proved"]
    assert outputs["least_violation_m"] > 0.0
    assert outputs["exact_violation_m"] > 0.0
    assert outputs["inputs_m_s"] == []
    assert outputs["certificate"] is None


@pytest.mark.parametrize(
    ("wrong", "field"),
    [
        ({"inertia_kg_m2": [[1, 0, 0], [0, 1, 0], [0, 0, 5]]}, "inertia"),
        ({"inertia_kg_m2": [[1, 0], [0, 1, 0], [0, 0, 1]]}, "inertia_kg_m2"),
        ({"u_max_m_s": 0}, "u_max_m_s"),
        ({"n_c": 31}, "n_c"),
        ({"period_s": 30, "body_rate_deg_s": [0, 10, 0]}, "period"),
        ({"period_s": 60, "body_rate_deg_s": [0, 0.01, 0], "orbit_radius_m": 7e6}, "start"),
        ({"start": {"position_m": [5, 1, 0]}}, "start"),
        ({"attitude_wxyz": [0, 0, 0, 0]}, "attitude"),
        ({"theta_limit": "cube"}, "theta_limit"),
        (
            {"study": {"runs": 1, "position_sigma_m": 9.0, "velocity_sigma_m_s": 1.0, "input_sigma": 1.0}},
            "study",
        ),
    ],
)
def test_bad_input_is_named(wrong, field):
    if field == "start" and "period_s" in wrong:
        wrong = wrong | {"start": {"position_m": [0, -1, 0]}}
    with pytest.raises(InvalidInput, match=field):
        execute("tracking-mpc", wrong)


@pytest.mark.parametrize("variant", ["hard", "soft", "tube"])
def test_the_study_is_the_same_for_any_shards(variant):
    asked = {"steps": 40, "seed": 3, "study": {"runs": 24, "variant": variant, "per_shard": 24}}
    whole = execute("tracking-mpc", asked).document["outputs"]["study"]
    asked["study"]["per_shard"] = 7
    cut = execute("tracking-mpc", asked)
    spec = process("tracking-mpc")
    assert len(spec.sharding.parts(spec.parse(asked))) == 4
    study = cut.document["outputs"]["study"]
    assert study["requirements"] == whole["requirements"]
    assert study["worst"] == whole["worst"]
    assert "runs.parquet" in {a.name for a in cut.artifacts}
    counts = {name: one["count"] for name, one in study["requirements"].items()}
    assert counts["within_input"] == 24
    if variant == "tube":
        assert counts == {"inside": 24, "within_input": 24, "always_planned": 24, "arrived": 24}
    else:
        assert counts["always_planned"] < 24


def test_a_printed_limit_that_is_not_safe_says_so():
    """A spin about the axis of most inertia: the printed bound lets theta where the input cannot hold it."""
    _, axes = np.linalg.eigh(np.array(process("tracking-mpc").inputs().inertia_kg_m2))
    rate = (5.0 * axes[:, 2]).tolist()
    asked = {"body_rate_deg_s": rate, "theta_limit": "printed", "steps": 5, "tau": 0.0}
    result = execute("tracking-mpc", asked)
    outputs = result.document["outputs"]
    assert outputs["printed_counter_example"]["largest_input_m_s"] > 0.075
    assert "counter_example.npz" in {a.name for a in result.artifacts}
    said = {row["statement"]: row["verdict"] for row in outputs["statements"]}
    assert said["The printed theta_max is safe"] == "UNSAFE"
    assert outputs["theta_max_m"]["printed"] > 5.0 * outputs["theta_max_m"]["exact_high"]
