"""A span in parts; what is known from finished parts. Light to import: the service uses it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from safestart.processes.commit_timeline.spec import CommitTimelineInputs

PARTS = 8
"""Parts of a span, whatever its length and the number of workers."""


def split(inputs: CommitTimelineInputs) -> list[dict[str, Any]]:
    """Each part asks its share of the instants."""
    dumped = inputs.model_dump(mode="json")
    return [{"inputs": dumped, "part": part} for part in range(PARTS)]


def summary(inputs: CommitTimelineInputs, documents: Iterable[dict[str, Any]]) -> dict[str, Any]:
    """How many instants have been asked so far, by verdict."""
    counts: dict[str, int] = {}
    for document in documents:
        for run in document["runs"]:
            counts[run["verdict"]] = counts.get(run["verdict"], 0) + run["instants"]
    return {"corridors": [one.name for one in inputs.corridors], "instants": counts}
