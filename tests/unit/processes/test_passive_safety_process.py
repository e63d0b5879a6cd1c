"""The passive-safety process: its document, pictures and arrays, units on the wire, refusals."""

import io

import numpy as np
import pytest
from PIL import Image

from safestart.errors import Cancelled, InvalidInput
from safestart.passive_safety.flights.independent_flight import replay
from safestart.passive_safety.model import PUBLISHED
from safestart.processes.execute import Execution, execute
from safestart.processes.passive_safety.outlines import outlines
from safestart.processes.registry import process
from safestart.records.comparable import comparable
from safestart.runtime.progress import Context

pytestmark = pytest.mark.slow

QUICK = {"abort_windows_min": [[120, 125], [260, 260]], "box_half_width_m": 0.2, "critical_abort": False}


@pytest.fixture(scope="module")
def done() -> Execution:
    return execute("passive-safety", QUICK)


def test_document_fits_its_schema_and_its_counter_example_replays(done: Execution) -> None:
    outputs = done.document["outputs"]
    process("passive-safety").outputs.model_validate(outputs)
    assert outputs["crossed_faces"] == ["x=-100"]
    assert outputs["crossing_first_min"] < outputs["crossing_last_min"]
    verdicts = [{f["requirement"]: f for f in window["findings"]} for window in outputs["windows"]]
    assert [v["separation"]["verdict"] for v in verdicts] == ["SAFE", "UNSAFE"]
    example = verdicts[1]["separation"]["counter_example"]
    start = np.array([example[key] for key in ("x_m", "y_m", "vx_m_s", "vy_m_s")]) * [1, 1, 60, 60]
    assert np.abs(replay(PUBLISHED, start, example["abort_min"], example["time_min"])[:2]).max() < 0.2
    assert verdicts[0]["thrust"]["unit"] == "N"
    assert verdicts[0]["thrust"]["bound"] == pytest.approx(7.40, abs=0.01)
    assert verdicts[0]["velocity"]["limit"] == pytest.approx(0.05)


def test_critical_abort_has_a_proof_and_a_flight_on_its_sides() -> None:
    critical = execute("passive-safety", {"abort_windows_min": []})
    outputs = critical.document["outputs"]
    assert outputs["windows"][0]["abort_window_min"] is None
    assert outputs["critical"]["proved_until_min"] == pytest.approx(274.3, abs=0.5)
    assert outputs["critical"]["counter_example"]["abort_min"] == pytest.approx(274.4, abs=0.5)
    assert [a.name for a in critical.artifacts] == ["tubes.png", "tubes.npz"]


def test_variants_are_chosen_on_the_wire() -> None:
    """Everything other than the default at once: the disc then holds, and own gains are the published ones."""
    chosen = {"model": "nonlinear", "gains": "bryson", "guard": "circle"}
    outputs = execute("passive-safety", QUICK | chosen).document["outputs"]
    process("passive-safety").outputs.model_validate(outputs)
    assert outputs["crossed_faces"] == ["circle"]
    verdicts = [{f["requirement"]: f["verdict"] for f in window["findings"]} for window in outputs["windows"]]
    assert [v["separation"] for v in verdicts] == ["SAFE", "UNSAFE"]
    assert all(v[name] == "SAFE" for v in verdicts for name in v if name != "separation")
    assert outputs["gains"]["mode1"][0][0] == pytest.approx(28.828677676943, abs=1e-4)


def test_artifacts_open(done: Execution) -> None:
    files = {a.name: a.data for a in done.artifacts}
    assert set(files) == {"tubes.png", "after_abort.png", "tubes.npz"}
    for name in ("tubes.png", "after_abort.png"):
        with Image.open(io.BytesIO(files[name])) as picture:
            assert min(picture.size) > 300
    with np.load(io.BytesIO(files["tubes.npz"])) as arrays:
        assert (arrays["mode1_lower"] <= arrays["mode1_upper"]).all()
        assert arrays["mode1_time_min"].shape[0] == arrays["mode1_upper"].shape[0] + 1
        assert arrays["mode1_thrust_n"].max() <= 10.0


def test_same_inputs_same_result(done: Execution) -> None:
    again = execute("passive-safety", QUICK)
    assert comparable(again.document["outputs"]) == comparable(done.document["outputs"])
    assert [a.sha256 for a in again.artifacts] == [a.sha256 for a in done.artifacts]


def test_dismissal_and_progress() -> None:
    with pytest.raises(Cancelled):
        execute("passive-safety", QUICK, Context(cancelled=lambda: True))
    seen: list[float] = []
    execute("passive-safety", QUICK, Context(lambda done, total, _: seen.append(done / total)))
    assert seen == sorted(seen)


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"horizon_min": 0}, "horizon_min"),
        ({"abort_windows_min": [[5, 3]]}, "abort_windows_min"),
        ({"abort_windows_min": [[5, 301]]}, "abort_windows_min"),
        ({"abort_windows_min": [[5]]}, "abort_windows_min.0"),
        ({"box_half_width_m": 0}, "box_half_width_m"),
        ({"model": "elliptic"}, "model"),
        ({"gains": "bryson", "mode_1": {"x_m": 0}}, "mode_1.x_m"),
        ({"guard": "square"}, "guard"),
        ({"centre": {"x_m": 0, "y_m": 0}}, "centre"),
        ({"half_widths": {"x_m": -1}}, "half_widths.x_m"),
    ],
)
def test_bad_inputs_name_the_field(change: dict, field: str) -> None:
    with pytest.raises(InvalidInput) as error:
        execute("passive-safety", QUICK | change)
    assert error.value.field == field


def test_outline_has_the_support_of_its_zonotope() -> None:
    gens = np.random.default_rng(3).normal(size=(4, 5, 2))
    corners = outlines(np.ones((4, 2)), gens)
    for angle in np.linspace(0, 6, 9):
        row = np.array([np.cos(angle), np.sin(angle)])
        assert (corners @ row).max(axis=1) == pytest.approx(row.sum() + np.abs(gens @ row).sum(axis=1))
