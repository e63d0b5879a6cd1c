"""The process hop-plan: the plan of hopping, verdicts with their evidence, refusals."""

import json
import subprocess
import sys

import numpy as np
import pytest

from safestart.errors import InvalidInput
from safestart.processes.execute import execute
from safestart.processes.registry import process
from safestart.proofs.checker import check
from safestart.proofs.statement import digest_of
from safestart.proofs.strict import ProofRejected


def planned(**inputs):
    return execute("hop-plan", inputs).document["outputs"]


def test_it_is_the_plan_and_nearly_the_proof_of_hopping() -> None:
    said = planned(angle_deg=0)
    study = execute("hopping", {"angle_deg": 0, "runs": 1}).document["outputs"]
    assert said["plan"] == study["plan"]
    assert said["lambda"] == pytest.approx(study["proof"]["lambda"], rel=0.01)
    found = [proof["least_distance_m"] for proof in said["proofs"]]
    assert found == pytest.approx(study["proof"]["least_distance_m"], rel=2e-3, abs=0.1)
    assert said["verdict"] == study["proof"]["verdict"] == "VIOLATED"


def test_a_violation_is_a_drift_that_enters() -> None:
    said = planned(angle_deg=0)
    assert [proof["verdict"] for proof in said["proofs"]] == ["PROVED"] * 4 + ["VIOLATED"]
    worst = next(one for one in said["drifts"] if one["hop"] == 5 and one["member"] == "worst found")
    distance = np.hypot(worst["radial_m"], worst["along_track_m"])
    assert distance.min() < 50.0
    assert said["proofs"][4]["nearest_m"] == pytest.approx(distance.min(), abs=3.0)
    proved = planned(angle_deg=120)
    assert proved["verdict"] == "PROVED"
    for one in proved["drifts"]:
        least = proved["proofs"][one["hop"] - 1]["least_distance_m"]
        assert np.hypot(one["radial_m"], one["along_track_m"]).min() >= least - 0.02


def test_burns_and_path_lead_from_start_to_hold() -> None:
    said = planned(angle_deg=90, hops=3, start_m=900, hold_m=60)
    burns = said["burns"]
    assert [burn["burn"] for burn in burns] == [1, 2, 3, 4]
    assert burns[0]["distance_m"] == pytest.approx(900)
    assert burns[-1]["distance_m"] == pytest.approx(60)
    assert burns[-1]["time_s"] == pytest.approx(said["plan"]["orbits"] * 7255.02, rel=1e-4)
    total = sum(float(np.abs(burn["impulse_m_s"]).sum()) for burn in burns)
    assert total == pytest.approx(said["plan"]["fuel_1norm_m_s"])
    assert said["path"][0] == pytest.approx([-900, 0])
    assert said["path"][-1] == pytest.approx([-60, 0], abs=1e-3)


def test_without_errors_there_is_no_level() -> None:
    none = {"position_m": 0, "velocity_m_s": 0, "thrust_share": 0, "thrust_deg": 0}
    said = planned(angle_deg=40, sigma=none)
    assert said["lambda"] is None
    assert said["verdict"] == "PROVED"


def test_the_service_needs_no_compiler_for_it() -> None:
    code = (
        "import sys; from safestart.processes.execute import execute; execute('hop-plan', {}); "
        "print(sorted({'numba', 'scipy', 'matplotlib', 'clarabel'} & set(sys.modules)))"
    )
    assert (
        subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
        == "[]\n"
    )


@pytest.mark.parametrize(
    ("inputs", "said"),
    [
        ({"angle_deg": 160}, r"angle_deg: .*up to 145\.66 deg"),
        ({"hold_m": 40}, "hold_m: required at least keep_out_m"),
        ({"start_m": 100}, "start_m: required more than hold_m"),
        ({"hold_m": 3000}, "hold_m: required less than start_m, 2000 m"),
        ({"hops": 21}, "hops"),
        ({"abort_orbits": 21}, "abort_orbits"),
        ({"runs": 3}, "runs: .*no field"),
    ],
)
def test_bad_input_is_refused_by_name(inputs, said: str) -> None:
    with pytest.raises(InvalidInput, match=said):
        execute("hop-plan", inputs)


def test_the_cost_counts_hops_and_orbits() -> None:
    spec = process("hop-plan")
    costs = [spec.cost(spec.parse(given)) for given in ({}, {"hops": 20}, {"hops": 20, "abort_orbits": 20})]
    assert costs[0] < costs[1] < costs[2]


@pytest.mark.parametrize("angle", [20.0, 130.0, 180.0])
def test_what_is_proved_has_a_document_that_the_checker_accepts(angle: float) -> None:
    run = execute("hop-plan", {"angle_deg": angle, "hold_m": 140, "document": True})
    said = run.document["outputs"]
    assert said["verdict"] == "PROVED"
    document = said["document"]
    assert json.loads(next(file for file in run.artifacts if file.name == "proof.json").data) == document
    verified = check(document)
    assert verified.margin_m <= min(proof["least_distance_m"] for proof in said["proofs"])
    assert verified.margin_m >= 50.0
    # A promise a centimetre better than the worst bound is refused.
    document["least_distance_m"] += 0.01
    document["digest"] = digest_of({k: v for k, v in document.items() if k != "digest"})
    with pytest.raises(ProofRejected, match="short by"):
        check(document)


def test_there_is_no_document_unless_it_is_asked_for_and_proved() -> None:
    assert planned(angle_deg=130)["document"] is None
    violated = execute("hop-plan", {"angle_deg": 0, "document": True})
    assert violated.document["outputs"]["document"] is None
    assert not violated.artifacts


def test_a_table_shows_no_round_off() -> None:
    """Half an orbit's sine is 1e-16: the V-bar's impulses had -6e-18 m/s along it."""
    said = execute("hop-plan", {"angle_deg": 0}).document["outputs"]
    shown = [hop["impulse_m_s"] for hop in said["plan"]["hops"]] + [said["plan"]["stop_m_s"]]
    shown += [burn["impulse_m_s"] for burn in said["burns"]] + [burn["position_m"] for burn in said["burns"]]
    for vector in shown:
        largest = max(map(abs, vector))
        assert all(e == 0.0 or abs(e) > 1e-9 * largest for e in vector)
        assert "-0.0" not in map(repr, vector)
