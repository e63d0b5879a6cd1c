"""A process cut into shards, run in turn: parts in order, progress that adds up, contents that tell parts apart."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pytest

from safestart.errors import Cancelled
from safestart.processes.base import ProcessOutput, ProcessSpec, WireModel
from safestart.processes.sharding import Part, Sharding, content
from safestart.runtime.progress import Context

HERE = "tests.unit.processes.test_sharding"


class Inputs(WireModel):
    """How many numbers to square."""

    count: int = 4


class Outputs(WireModel):
    """Their sum and the bytes in order."""

    total: int
    letters: str


def split(inputs: Inputs) -> list[dict[str, Any]]:
    return [{"n": n} for n in range(inputs.count)]


def shard(part: dict[str, Any], context: Context) -> Part:
    context.step(1, 2, "half")
    return Part({"square": part["n"] ** 2}, b"abcdef"[part["n"] : part["n"] + 1])


def merge(inputs: Inputs, parts: Sequence[Part], context: Context) -> ProcessOutput:
    letters = b"".join(part.data for part in parts).decode()
    return ProcessOutput({**summary(inputs, [part.document for part in parts]), "letters": letters})


def summary(inputs: Inputs, documents: Sequence[dict[str, Any]]) -> dict[str, Any]:
    return {"total": sum(document["square"] for document in documents)}


SHARDING = Sharding(f"{HERE}:split", f"{HERE}:shard", f"{HERE}:merge", f"{HERE}:summary")
SPEC = ProcessSpec("squares", "Squares", "Sums squares.", Inputs, Outputs, sharding=SHARDING)


def test_the_shards_run_in_turn_and_are_merged_in_order() -> None:
    said: list[tuple[float, str]] = []
    context = Context(lambda done, total, message: said.append((done / total, message)))
    output = SPEC.runner()(Inputs(count=4), context)
    assert output.document == {"total": 14, "letters": "abcd"}
    shares = [share for share, _ in said]
    assert shares == sorted(shares)
    assert (0.1, "shard 1 of 4: half") in said
    assert shares[-1] == 0.8


def test_no_parts_are_refused() -> None:
    with pytest.raises(ValueError, match="required 1 to 10000 parts, received 0"):
        SHARDING.parts(Inputs(count=0))


def test_a_dismissed_job_ends_between_shards() -> None:
    with pytest.raises(Cancelled):
        SHARDING.run(Inputs(), Context(cancelled=lambda: True))


def test_content_depends_on_process_part_and_source_alone() -> None:
    wanted = content("squares", {"n": 1, "m": 2}, "this code")
    assert content("squares", {"m": 2, "n": 1}, "this code") == wanted
    others = (
        ("cubes", {"n": 1, "m": 2}, "this code"),
        ("squares", {"n": 2, "m": 2}, "this code"),
        ("squares", {"n": 1, "m": 2}, "other code"),
    )
    assert wanted not in {content(*other) for other in others}
