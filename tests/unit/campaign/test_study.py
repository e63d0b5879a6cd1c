"""A campaign of walks: the same for any cut, order and number of workers, and what a plain loop finds."""

from __future__ import annotations

import json
import math
import random
from concurrent.futures import ThreadPoolExecutor
from statistics import fmean, pstdev
from typing import Any

import pytest

from safestart.campaign.case import Case
from safestart.campaign.combined import Each
from safestart.campaign.design import Repeated
from safestart.campaign.part import Part
from safestart.campaign.study import Study
from safestart.campaign.tally import Rows
from safestart.errors import Cancelled, InvalidInput
from safestart.model.metrics import wilson
from safestart.records import parquet
from safestart.runtime.progress import Context
from tests.unit.campaign.walk import OUTCOME, SEED, TALLY, study, walk


def ran(asked: Study, workers: int = 1, shuffle: int | None = None) -> list[Part]:
    """All parts, in the order in which they ended; through JSON, as the store keeps them."""
    parts = asked.parts({})
    if shuffle is not None:
        random.Random(shuffle).shuffle(parts)
    with ThreadPoolExecutor(workers) as pool:
        done = list(pool.map(lambda part: asked.simulated(part, walk, Context()), parts))
    return [Part(json.loads(json.dumps(part.document, allow_nan=False)), part.data) for part in done]


def said(asked: Study, done: list[Part]) -> Any:
    return asked.total(part.document for part in done).said


@pytest.fixture(scope="module")
def loop() -> list[dict[str, Any]]:
    """The walks one after the other, without a campaign."""
    design = study().design
    cases = [Case(k, SEED, parameters) for k, parameters in enumerate(design.parameters(0, 400))]
    return [{"case": case.index, **walk(case, Context())} for case in cases]


def test_what_is_said_is_what_a_loop_finds(loop: list[dict[str, Any]]) -> None:
    found = said(study(), ran(study()))
    stayed = [row for row in loop if row["stayed"]]
    assert found["cases"] == 400
    assert found["stayed"] == {
        "count": len(stayed),
        "cases": 400,
        "share": len(stayed) / 400,
        "wilson_95": list(wilson(len(stayed), 400) or ()),
    }
    asked = [row for row in loop if row["promised"] is not None]
    assert found["promise"]["tp"] == sum(row["promised"] and row["stayed"] for row in asked)
    assert found["promise"]["fp"] == sum(row["promised"] and not row["stayed"] for row in asked)
    assert found["promise"]["fn"] == sum(not row["promised"] and row["stayed"] for row in asked)
    assert sum(found["promise"][name] for name in ("tp", "fp", "fn", "tn")) == len(asked) == 320
    pushes = [row["push"] for row in stayed]
    assert found["push"]["count"] == len(pushes)
    assert found["push"]["mean"] == pytest.approx(fmean(pushes), rel=1e-14)
    assert found["push"]["std"] == pytest.approx(pstdev(pushes), rel=1e-12)
    assert (found["push"]["least"], found["push"]["most"]) == (min(pushes), max(pushes))
    left = [row["left_at"] for row in loop if row["left_at"] is not None]
    assert (found["left"], found["steps"]) == (len(left), sum(left))
    assert found["failures"] == {"diverged": 58}
    for decade, group in found["by_decade"].items():
        rows = [row for row in loop if row["decade"] == decade]
        assert (group["cases"], group["stayed"]["count"]) == (10, sum(row["stayed"] for row in rows))
    assert list(found["by_decade"]) == list(range(40))


def test_the_worst_promises_are_kept_whole(loop: list[dict[str, Any]]) -> None:
    def key(row: dict[str, Any]) -> tuple[bool, float, int]:
        return row["stayed"], row["margin"] if math.isfinite(row["margin"]) else -math.inf, row["case"]

    worst = sorted((row for row in loop if row["promised"]), key=key)[:4]
    found = said(study(), ran(study()))["worst"]
    assert [row["case"] for row in found] == [row["case"] for row in worst]
    assert found[0]["failure"] == "diverged"
    assert found[0]["margin"] is None, "what is not finite is unknown"
    assert found[0].keys() == worst[0].keys()


def test_order_and_number_of_workers_do_not_matter() -> None:
    asked = study()
    done = ran(asked)
    text, records = json.dumps(said(asked, done)), asked.recorded(done)
    for workers, shuffle in ((2, None), (5, 1), (1, 2)):
        again = ran(asked, workers, shuffle)
        assert json.dumps(said(asked, again)) == text
        assert asked.recorded(again) == records


@pytest.mark.parametrize("per_shard", [1, 7, 50, 399, 10_000])
def test_the_cut_does_not_matter(per_shard: int) -> None:
    whole, cut = study(per_shard=400), study(per_shard=per_shard)
    done = ran(cut)
    assert len(done) == math.ceil(400 / per_shard)
    found, expected = said(cut, done), said(whole, ran(whole))
    spread, exact = found.pop("push"), expected.pop("push")
    assert found == expected
    assert spread == pytest.approx(exact, rel=1e-12)


def test_some_shards_say_what_their_cases_say(loop: list[dict[str, Any]]) -> None:
    asked = study()
    total = asked.total(part.document for part in ran(asked)[2:4])
    assert total.shards == 2
    assert total.said["cases"] == 128
    assert total.said["stayed"]["count"] == sum(row["stayed"] for row in loop[128:256])
    assert total.run_s > 0.0
    nothing = asked.total([])
    assert (nothing.said["cases"], nothing.shards) == (0, 0)
    assert nothing.said["stayed"]["wilson_95"] is None
    assert nothing.said["push"]["mean"] is None


def test_records_hold_every_outcome(loop: list[dict[str, Any]]) -> None:
    asked = study()
    table = parquet.read(asked.recorded(ran(asked)))
    assert table.column_names == ["case", *(column.name for column in OUTCOME if column.recorded)]
    rows = table.to_pylist()
    assert len(rows) == len(loop)
    for found, row in zip(rows, loop, strict=True):
        expected = {name: value for name, value in row.items() if name != "decade"}
        assert repr(found) == repr(expected), "NaN and infinity as they are"


def test_records_are_the_first_cases_of_every_shard() -> None:
    asked = study(records=40, per_shard=100)
    table = parquet.read(asked.recorded(ran(asked, 3, 4)))
    assert table["case"].to_pylist() == [first + k for first in (0, 100, 200, 300) for k in range(10)]
    assert study(records=0).recorded(ran(study(records=0))) == b""


def test_a_shard_says_no_more_for_more_cases() -> None:
    """Documents are what the store keeps and the service adds up: counts, and a handful of rows."""
    tally = Each({name: each for name, each in TALLY.tallies.items() if name != "by_decade"})
    sizes = []
    for count in (200, 4000):
        asked = Study(study(count).design, OUTCOME, tally, count, SEED)
        (part,) = ran(asked)
        sizes.append(len(json.dumps(part.document)))
        assert part.data == b""
    assert sizes[1] < 1.1 * sizes[0] < 3000


def test_progress_is_told_and_dismissal_heard() -> None:
    asked = study(10, 5)
    told: list[tuple[float, str]] = []
    context = Context(lambda done, total, message: told.append((done / total, message)))
    asked.simulated(asked.parts({})[1], walk, context, "walk")
    assert told[:2] == [(0.0, "walk 1 of 5"), (0.2, "walk 1 of 5: walks")]
    assert told[-1] == (1.0, "walk 5 of 5: walks")
    assert [share for share, _ in told] == sorted(share for share, _ in told)
    with pytest.raises(Cancelled):
        asked.simulated(asked.parts({})[0], walk, Context(cancelled=lambda: True))


def test_a_wrong_outcome_is_refused() -> None:
    asked = Study(Repeated(3), OUTCOME[:1], Rows(), 3)
    (part,) = asked.parts({"asked": 1})
    assert part == {"inputs": {"asked": 1}, "first": 0, "count": 3}
    for outcome in ({}, {"sped": 1.0}, {"speed": 1.0, "more": 2.0}, {"speed": "fast"}):
        with pytest.raises(InvalidInput, match="speed"):
            asked.simulated(part, lambda case, context, outcome=outcome: outcome, Context())
