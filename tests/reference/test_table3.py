"""Paper 000, Table 3: what it prints, and what we find in its place."""

from __future__ import annotations

from safestart.cli.reproduce.table3 import CAUSES
from safestart.papers import safe_start as published
from safestart.processes.registry import process
from safestart.runtime.progress import Context

SHARDING = process("sweep").sharding


def test_the_printed_table_and_its_confusion_matrix() -> None:
    cells = [pair for rows in published.TABLE3.values() for row in rows.values() for pair in row]
    printed = published.TABLE3_CONFUSION
    assert len(cells) == 56
    # The table adds up to the matrix that the paper prints below it.
    assert sum(certified for certified, _ in cells) == printed["tp"] + printed["fp"]
    assert sum(feasible for _, feasible in cells) == printed["tp"] + printed["fn"]


def test_the_closing_speed_alone_explains_the_false_positives() -> None:
    asked = {"controllers": ["filter"], "preset": "paper", "certificates": ["closed_form"]}
    precision = {}
    for name, change in (CAUSES[0], CAUSES[1], CAUSES[3]):
        inputs = {**asked, "cases_per_cell": 18, "worst": 0, "records": 0, **change}
        parsed = process("sweep").parse(inputs)
        documents = [SHARDING.run_part(part, Context()).document for part in SHARDING.parts(parsed)]
        found = SHARDING.so_far(parsed, documents)["confusion"]["paper"]
        precision[name] = next(iter(found.values()))["precision"]
    assert len(precision) == 3
    assert precision["none switched off"] < 0.88
    assert precision["checked at nodes only"] < 0.88
    assert precision["closing speed capped"] > 0.98
