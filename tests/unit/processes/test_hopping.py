"""The processes hop-time, passive-abort and hopping, as clients meet them."""

import json

import numpy as np
import pytest

from safestart.cli.reproduce.hopping import hopping_document
from safestart.errors import InvalidInput
from safestart.processes.execute import execute
from safestart.processes.hopping import run
from safestart.processes.registry import process
from safestart.proofs.checker import check
from tests.unit.processes.boasted import boasted


def test_hop_time() -> None:
    assert execute("hop-time", {"angle_deg": 0, "rho": 0.7}).document["outputs"]["orbits"] == 0.5
    with pytest.raises(InvalidInput, match=r"up to 147\.19 deg"):
        execute("hop-time", {"angle_deg": 150, "rho": 0.7})


@pytest.mark.parametrize(("angle", "rho"), [(0.0, 0.7), (40.0, 0.7), (90.0, 0.3), (140.0, 0.7), (270.0, 0.0)])
def test_the_path_of_a_hop_leaves_its_share_and_ends_across_its_line(angle: float, rho: float) -> None:
    path = np.array(execute("hop-time", {"angle_deg": angle, "rho": rho}).document["outputs"]["path"])
    ahead, below = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    assert path[0] == pytest.approx([-below, ahead], abs=1e-12)
    assert path[-1] == pytest.approx([-rho * below, rho * ahead], abs=1e-9)
    last = (3 * path[-1] - 4 * path[-2] + path[-3]) / 2  # its velocity, to second order
    assert abs(last @ path[0]) < 1e-3 * np.linalg.norm(last)


@pytest.fixture(scope="module")
def studied():
    return execute("hopping", {"runs": 120, "hops": 4, "angle_deg": 40, "keep_out_m": 60, "seed": 3})


def test_plan_study_and_proof(studied) -> None:
    said = studied.document["outputs"]
    assert said["plan"]["hops"][0]["start_m"] == 2000.0
    assert said["plan"]["hops"][-1]["end_m"] == 100.0
    assert said["plan"]["orbits"] == pytest.approx(sum(hop["orbits"] for hop in said["plan"]["hops"]))
    breach = said["study"]["breach"]
    assert breach["runs"] == 120
    assert breach["low"] <= breach["probability"] == breach["count"] / 120 <= breach["high"]
    assert len(breach["per_hop"]) == len(said["proof"]["least_distance_m"]) == 4
    assert (said["proof"]["verdict"], said["proof"]["checked"]) == ("PROVED", True)
    assert said["proof"]["lambda"] > 1.0
    assert {artifact.name for artifact in studied.artifacts} == {
        "plan.png",
        "flights.png",
        "approaches.parquet",
        "proof.json",
    }
    document = json.loads(next(file for file in studied.artifacts if file.name == "proof.json").data)
    assert check(document).margin_m >= 60.0


def test_a_proof_of_hops_that_the_checker_refuses_proves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run, "document_of", boasted)
    done = execute("hopping", {"runs": 1, "hops": 2, "angle_deg": 90, "keep_out_m": 20})
    said = done.document["outputs"]
    assert (said["proof"]["verdict"], said["proof"]["checked"]) == ("UNKNOWN", True)
    assert said["proof"]["lambda"] is None
    assert set(said["proof"]["least_distance_m"]) == {0.0}
    assert any("refuses the proof" in note for note in said["notes"])
    assert "proof.json" not in {artifact.name for artifact in done.artifacts}


def test_the_proof_may_speak_about_the_true_earth() -> None:
    asked = {"runs": 1, "hops": 2, "angle_deg": 90, "inclination_deg": 57, "abort_orbits": 1}
    said = {}
    for model in ("linear", "nonlinear", "earth"):
        run = execute("hopping", asked | {"proof_model": model})
        said[model] = run.document["outputs"]["proof"]
        assert said[model]["model"] == model
    assert {one["verdict"] for one in said.values()} == {"PROVED"}
    # The bound on the nonlinear terms costs some of the level.
    assert said["nonlinear"]["lambda"] < said["linear"]["lambda"]
    assert said["earth"]["lambda"] == pytest.approx(said["linear"]["lambda"], rel=0.05)
    assert said["earth"]["lambda"] != said["linear"]["lambda"]
    document = json.loads(next(file for file in run.artifacts if file.name == "proof.json").data)
    assert document["question"]["model"] == "earth"
    assert check(document).verdict == "PROVED"


def test_shards_add_up(studied) -> None:
    spec = process("hopping")
    assert spec.sharding is not None
    inputs = spec.parse({"runs": 120, "hops": 4, "angle_deg": 40, "keep_out_m": 60, "seed": 3})
    parts = spec.sharding.parts(inputs)
    assert [part["count"] for part in parts] == [60, 60] or sum(part["count"] for part in parts) == 120
    assert spec.sharding.so_far(inputs, [])["study"] is None
    documents = [spec.sharding.run_part(part, _quiet()).document for part in reversed(parts)]
    assert spec.sharding.so_far(inputs, documents)["study"] == studied.document["outputs"]["study"]


def _quiet():
    from safestart.runtime.progress import Context

    return Context()


@pytest.mark.parametrize(
    ("inputs", "said"),
    [
        ({"hold_m": 40, "keep_out_m": 50}, "hold_m"),
        ({"start_m": 100, "hold_m": 100}, "start_m"),
        ({"angle_deg": 160}, "angle_deg"),
        ({"eccentricity": 0.3}, "perigee"),
        ({"gamma": 1.2}, "gamma"),
        ({"hops": 0}, "hops"),
        ({"sigma": {"position_m": -1}}, "sigma.position_m"),
    ],
)
def test_bad_input_is_named(inputs, said: str) -> None:
    with pytest.raises(InvalidInput, match=said):
        execute("hopping", {"runs": 1, **inputs})


def _plan(**more):
    example = process("passive-abort").example
    return {**example, **more}


def test_passive_abort_proves_and_its_document_is_checked() -> None:
    done = execute("passive-abort", _plan())
    assert done.document["outputs"]["verdict"] == "PROVED"
    proof = next(artifact for artifact in done.artifacts if artifact.name == "proof.json")
    assert check(json.loads(proof.data)).margin_m == done.document["outputs"]["least_distance_m"]
    assert {(case["burn"], case["failure"]) for case in done.document["outputs"]["cases"]} == {
        (k, "missed") for k in range(3)
    }


def test_passive_abort_shows_a_flight_that_enters() -> None:
    done = execute("passive-abort", _plan(keep_out_m=120, model="nonlinear"))
    assert done.document["outputs"]["verdict"] == "VIOLATED"
    assert done.document["outputs"]["counter_example"]["distance_m"] < 120
    assert done.document["outputs"]["model"] == "nonlinear"


def test_passive_abort_speaks_about_the_true_earth() -> None:
    orbit = {
        "eccentricity": 0.002,
        "inclination_deg": 98,
        "argument_of_perigee_deg": 30,
        "true_anomaly_deg": 10,
    }
    done = execute("passive-abort", _plan(model="earth", error_level=False, keep_out_m=30, **orbit))
    outputs = done.document["outputs"]
    assert (outputs["verdict"], outputs["model"]) == ("PROVED", "earth")
    assert "J2" in outputs["notes"][0]
    states = [{"position_m": [0, y, 0], "velocity_m_s": [0, 0, 0]} for y in (182.06, 20.0)]
    near = execute("passive-abort", _plan(model="earth", error_level=False, keep_out_m=30, states=states))
    assert near.document["outputs"]["verdict"] == "VIOLATED"
    assert near.document["outputs"]["counter_example"]["distance_m"] < 30


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"burns": []}, "burns"),
        (
            {"burns": [{"time_s": 5, "impulse_m_s": [0, 1, 0]}, {"time_s": 5, "impulse_m_s": [0, 1, 0]}]},
            "order",
        ),
        ({"burns": [{"time_s": 5, "impulse_m_s": [0, 0, 0]}]}, "not zero"),
        ({"failures": {"stuck_s": 5}}, "acceleration_m_s2"),
        ({"failures": {"late_s": 5000}}, "late_s"),
        ({"model": "nonlinear", "errors": {"at_each_burn": False}}, "at_each_burn"),
        ({"semi_major_axis_m": 6e6}, "semi_major_axis_m"),
        ({"model": "earth", "errors": {"at_each_burn": False}}, "at_each_burn"),
        ({"model": "earth", "eccentricity": 0.3}, "perigee"),
        ({"model": "earth", "states": []}, "states"),
        ({"eccentricity": 0.01}, "model: required earth"),
    ],
)
def test_bad_plans_are_named(more, said: str) -> None:
    with pytest.raises(InvalidInput, match=said):
        execute("passive-abort", _plan(**more))


def test_reproduce_hopping_stands_beside_the_paper() -> None:
    document = hopping_document(runs=10)
    said = {row["what"]: (row["ours"], row["paper"]) for row in document["rows"]}
    assert said["V-bar hop, orbits"] == ("0.5000", "0.5")
    assert said["R-bar hop as rho falls to 0, orbits"][0] == "0.2030"
    off, on = (
        said[f"0.6 orbits, barrier {name}: closest after each hop, m"][0] for name in ("off", "nominal")
    )
    assert min(float(c) for c in off.split(", ")) < 50.0 <= min(float(c) for c in on.split(", "))


@pytest.mark.parametrize(
    ("asked", "field", "received"),
    [
        ({"hold_m": 40}, "hold_m", "40"),
        ({"start_m": 50}, "start_m", "50"),
        ({"keep_out_m": 200}, "hold_m", "nothing"),
        ({"eccentricity": 0.5}, "eccentricity", "0.5"),
    ],
)
def test_a_rule_about_two_fields_names_one_and_its_value(asked, field, received):
    """Clients mark the field; the whole body was reported instead."""
    with pytest.raises(InvalidInput) as refused:
        process("hopping").parse(asked)
    assert (refused.value.field, refused.value.received) == (field, received)
    assert not str(refused.value.required).startswith(field)
