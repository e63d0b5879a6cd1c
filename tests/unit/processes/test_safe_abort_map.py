"""The safe-abort map: against flights, against paper 003, the same in shards, and refusing what makes no sense."""

import io
from datetime import UTC, datetime

import numpy as np
import pytest
from PIL import Image

from benchmarks.peers.reach_audit import random_starts
from safestart.errors import InvalidInput
from safestart.passive_safety.abort_map import safe_until
from safestart.passive_safety.flights.falsify import approaches
from safestart.passive_safety.flights.simulate import crossing_times
from safestart.passive_safety.model import PUBLISHED
from safestart.passive_safety.question import Question, Verdict
from safestart.passive_safety.verify import verify
from safestart.processes.execute import execute, merge
from safestart.processes.registry import process
from safestart.processes.safe_abort_map.study import places, split
from safestart.processes.sharding import Part
from safestart.runtime.progress import Context

pytestmark = pytest.mark.slow

QUICK = {
    "arc": {"rings": 1, "angles": 3, "inner_m": 985.0, "outer_m": 985.0, "from_deg": 204.0, "to_deg": 264.0},
    "starts_per_shard": 2,
}


def asked(x: float, y: float, box: float = 0.1, half: float = 5.0) -> Question:
    return Question((x, y, 0.0, 0.0), (half, half, 0.0, 0.0), 300.0, (0.0, 240.0), box)


def test_the_two_starts_that_the_paper_names() -> None:
    """(-900, -400): all of the 4 h. (-200, -900): about 100 min, when it enters mode 2 beside the cone."""
    whole = safe_until(asked(-900.0, -400.0), 48)
    assert (whole.separation, whole.requirements, whole.reason) == (240.0, 240.0, "")
    beside = safe_until(asked(-200.0, -900.0), 48)
    assert beside.requirements == pytest.approx(100.0, abs=5.0)
    assert beside.reason == "los"


@pytest.mark.parametrize("place", [(-300.0, -300.0), (180.0, 150.0), (-250.0, 40.0)])
def test_the_limit_is_proved_below_and_not_far_from_a_contact_above(place: tuple[float, float]) -> None:
    question = asked(*place)
    until = safe_until(question, 48).separation
    assert 0.0 < until < 240.0
    assert until % 5.0 == 0.0
    below = Question(question.centre, question.half, 300.0, (0.0, until), 0.1)
    assert verify(below).findings["separation"].verdict is Verdict.SAFE
    starts = random_starts(question, 400, 3)
    aborts = np.random.default_rng(4).uniform(0.0, until, 400)
    distance, _ = approaches(PUBLISHED, starts, aborts, 300.0, crossing_times(PUBLISHED, starts, 300.0))
    assert distance.min() > 0.1
    above = Question(question.centre, question.half, 300.0, (until, 240.0), 0.1)
    assert verify(above).findings["separation"].verdict is Verdict.UNSAFE


def test_a_set_across_a_corner_of_the_guard_is_proved_in_quarters() -> None:
    assert safe_until(asked(-780.0, -450.0), 48).requirements == 240.0


def test_what_cannot_follow_the_entry_is_proved_up_to_it() -> None:
    """So wide a set that its entry is not proved: aborts before the first entry are."""
    until = safe_until(asked(-600.0, 0.0, half=250.0), 48)
    assert until.reason
    assert until.requirements <= until.separation < 100.0


def test_document_picture_and_arrays() -> None:
    result = execute("safe-abort-map", QUICK)
    outputs = result.document["outputs"]
    process("safe-abort-map").outputs.model_validate(outputs)
    assert outputs["all_proved_until_min"][0] == 240.0
    assert outputs["all_proved_until_min"][2] < 120.0
    assert outputs["safe_abort_until_min"] == [240.0, 240.0, 240.0]
    assert outputs["starts_done"] == 3
    files = {a.name: a.data for a in result.artifacts}
    with Image.open(io.BytesIO(files["map.png"])) as picture:
        assert min(picture.size) > 300
    with np.load(io.BytesIO(files["map.npz"])) as arrays:
        assert arrays["x_m"].shape == (3,)


def test_shards_run_apart_give_the_same_map() -> None:
    spec = process("safe-abort-map")
    inputs = spec.parse(QUICK)
    assert spec.sharding is not None
    parts = spec.sharding.parts(inputs)
    assert [(part["first"], part["count"]) for part in parts] == [(0, 2), (2, 1)]
    done: list[Part] = [spec.sharding.run_part(part, Context()) for part in reversed(parts)][::-1]
    whole = execute("safe-abort-map", QUICK)
    again = merge("safe-abort-map", QUICK, done, datetime.now(UTC))
    assert again.document["outputs"] == whole.document["outputs"]
    assert [a.sha256 for a in again.artifacts] == [a.sha256 for a in whole.artifacts]
    half = spec.sharding.so_far(inputs, [done[0].document])
    assert half["starts_done"] == 2
    assert half["all_proved_until_min"][2] is None


def test_grid_leaves_out_what_is_not_a_start() -> None:
    inside = {
        "starts": "grid",
        "grid": {"nx": 3, "ny": 2, "x_from_m": -400, "x_to_m": 400, "y_from_m": 0, "y_to_m": 10},
    }
    inputs = process("safe-abort-map").parse(inside)
    assert places(inputs)[:3] == [(-400.0, 0.0), (0.0, 0.0), (400.0, 0.0)]
    outputs = execute("safe-abort-map", inside).document["outputs"]
    assert [v is None for v in outputs["safe_abort_until_min"]] == [False, True, False] * 2


def test_the_variant_is_part_of_every_shard() -> None:
    spec = process("safe-abort-map")
    kinds = [spec.parse(QUICK), spec.parse(QUICK | {"model": "nonlinear", "guard": "circle"})]
    first, second = (split(kind)[0]["inputs"] for kind in kinds)
    assert first != second
    assert second["model"] == "nonlinear"


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"arc": {"from_deg": 90, "to_deg": 0}}, "arc"),
        ({"arc": {"inner_m": 900, "outer_m": 800}}, "arc"),
        ({"arc": {"rings": 200, "angles": 2000}}, "starts"),
        ({"grid": {"nx": 1}}, "grid.nx"),
        ({"windows": 0}, "windows"),
        ({"starts": "line"}, "starts"),
    ],
)
def test_bad_inputs_name_the_field(change: dict, field: str) -> None:
    with pytest.raises(InvalidInput) as error:
        execute("safe-abort-map", change)
    assert error.value.field == field
