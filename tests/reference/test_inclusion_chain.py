"""Eq. (12) at 3 deg/s and 0.10 m/s^2, 40 s, the house grid: what holds, what does not, and from when on (chain.md)."""

import pytest

from safestart.processes.execute import execute
from safestart.proofs.single import check

pytestmark = pytest.mark.slow

SETS = ["tube", "analytical_tube", "analytical", "synchronize", "stay", "exact_position"]


@pytest.fixture(scope="module")
def outputs() -> dict:
    inputs = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "sets": SETS, "containment_up_to_s": 120}
    return execute("inclusion-chain", inputs).document["outputs"]


def test_cells(outputs: dict) -> None:
    cells = {row["name"]: row["cells"] for row in outputs["sets"]}
    assert cells == {
        "tube": 193,
        "analytical_tube": 40,
        "analytical": 44,
        "synchronize": 17,
        "stay": 204,
        "exact_position": 237,
    }


def test_the_chain_breaks_at_its_first_two_links(outputs: dict) -> None:
    found = {(link["inner"], link["outer"]): link["cells"] for link in outputs["chain"]}
    assert found == {("tube", "analytical"): 149, ("analytical", "synchronize"): 28}
    examples = {(e["inner"], e["outer"]): e for e in outputs["counter_examples"]}
    broken = examples["analytical", "synchronize"]
    assert (broken["x_m"], broken["y_m"]) == pytest.approx((-60.467, 40.0), abs=1e-3)
    assert broken["outer_margin_m"] < -10.0
    assert check(broken["proof"]).verdict == "NO_GO"
    assert check(examples["tube", "analytical"]["proof"]).verdict == "GO"


def test_the_certified_set_is_contained_from_76_s_on(outputs: dict) -> None:
    horizons = {entry["outer"]: entry["horizon_s"] for entry in outputs["horizon_contained_s"]}
    assert horizons == {"synchronize": 76.0, "exact_position": 40.0}


def test_twelve_certified_starts_of_the_fine_grid_cannot_stay(outputs: dict) -> None:
    (thin,) = [one for one in outputs["slivers"] if one["inner"] == "analytical"]
    assert (thin["certified"], thin["cannot_stay"]) == (8190, 12)
    assert check(thin["proof"]).verdict == "NO_GO"
