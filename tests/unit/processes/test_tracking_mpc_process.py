"""Process tracking-mpc: paper 002's case, refusals, infeasible starts, the study in shards."""

import numpy as np
import pytest

from safestart.attitude.quaternion import matrix_of
from safestart.errors import InvalidInput
from safestart.interchange.ccsds.message import message_of
from safestart.interchange.ccsds.parameters import orbit_of
from safestart.interchange.read import attitude_from, ephemeris_from
from safestart.interchange.relative import relative_states
from safestart.interchange.sampling import quaternions_at
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
    pictures = {"path.png", "over_time.png", "region.png"}
    files = {"chaser.oem", "chaser.opm", "chaser.ocm", "target.oem", "target.aem", "flight.czml"}
    assert {a.name for a in result.artifacts} == {*pictures, *files, "flight.npz", "region.npz", "scene.npz"}
    assert region["arrives"]["mask"] == region["mpct"]["mask"]
    assert 30 < region["mpct"]["count"] < 42
    assert [one["set"] for one in region["sets"]] == ["tracking_mpc", "arrives", "any_history"]


@pytest.mark.parametrize("thrust", ["impulse", "held"])
def test_the_flight_s_files_hold_it(thrust):
    """Read back, the pair of ephemerides gives the flight, the attitude file its body frame, the OPM its impulses."""
    asked = PAPER | {"steps": 12, "thrust": thrust, "input_limit": "ball"}
    result = execute("tracking-mpc", asked)
    files = {a.name: a.data for a in result.artifacts}
    chaser, target = (ephemeris_from(files[f"{name}.oem"]) for name in ("chaser", "target"))
    seen = relative_states(chaser, target, chaser.epochs)
    outputs = result.document["outputs"]
    np.testing.assert_allclose(seen.states[:, :3], outputs["position_lvlh_m"], atol=2e-8)
    attitude = attitude_from(files["target.aem"])
    turns = matrix_of(quaternions_at(attitude, chaser.epochs)) @ seen.axes.swapaxes(1, 2)
    body = np.einsum("kij,kj->ki", turns, seen.states[:, :3])
    np.testing.assert_allclose(body, outputs["position_body_m"], atol=2e-8)
    burns = orbit_of(message_of(files["chaser.opm"])).manoeuvres
    spent = sum(float(np.linalg.norm(burn.delta_v)) for burn in burns)
    assert spent == pytest.approx(outputs["impulse_m_s"], rel=1e-9)
    assert {burn.duration for burn in burns} == {0.0 if thrust == "impulse" else 1.0}


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
        ({"inertia_kg_m2": [[1, 0, 0], [0, 1, 0], [0, 0, 5]]}, "inertia_kg_m2"),
        ({"body_rate_deg_s": [0, 50, 50]}, "body_rate_deg_s"),
        ({"inertia_kg_m2": [[1, 0], [0, 1, 0], [0, 0, 1]]}, "inertia_kg_m2"),
        ({"u_max_m_s": 0}, "u_max_m_s"),
        ({"u_max_m_s": 1e-300}, "u_max_m_s"),
        ({"n_c": 31}, "n_c"),
        ({"period_s": 30, "body_rate_deg_s": [0, 10, 0]}, "period_s"),
        ({"period_s": 60, "body_rate_deg_s": [0, 0.01, 0], "orbit_radius_m": 7e6}, "start"),
        ({"start": {"position_m": [5, 1, 0]}}, "start"),
        ({"attitude_wxyz": [0, 0, 0, 0]}, "attitude_wxyz"),
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


@pytest.mark.parametrize("exact", ["all", "position", "velocity", "input"])
def test_errors_of_some_kinds_only(exact):
    """Without noise the steady filter had no solution: the study ended in an error that named nothing."""
    names = {"position": "position_sigma_m", "velocity": "velocity_sigma_m_s", "input": "input_sigma"}
    study = {name: 0.0 for kind, name in names.items() if exact in ("all", kind)} | {
        "runs": 2,
        "spin_sigma": 0,
        "inertia_sigma": 0,
    }
    outputs = execute("tracking-mpc", {"steps": 30, "study": study}).document["outputs"]
    assert outputs["study"]["requirements"]["inside"]["count"] == 2


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


@pytest.mark.parametrize("position", [[1.1, 1.0, 0.0], [1.1, 1.0, 1.1], [-0.4, 0.3, 0.0]])
def test_a_start_on_a_face_is_inside(position):
    outputs = execute("tracking-mpc", {"start": {"position_m": position}}).document["outputs"]
    assert abs(outputs["slack_m"][0]) < 1e-12
    assert outputs["exact_violation_m"] is not None


def test_a_rocket_body_in_whole():
    """Two equal moments, held thrust, region: an answer with its certificate, and words on whether it arrives."""
    asked = {
        "inertia_kg_m2": [[1000, 0, 0], [0, 1000, 0], [0, 0, 1500]],
        "region": {"rows": 3},
        "thrust": "held",
        "steps": 20,
    }
    outputs = execute("tracking-mpc", asked).document["outputs"]
    assert outputs["feasible"]
    said = {row["statement"]: row["verdict"] for row in outputs["statements"]}
    arrives = outputs["time_to_5cm_s"] is not None
    assert said["The flight arrives: it ends within 5 cm of the port"] == ("HELD" if arrives else "BROKEN")
