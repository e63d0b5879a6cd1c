"""The answers to the quick questions are what they were, to the last bit; the long ones are asked by hand."""

import re
import subprocess
import sys

import pytest

from safestart.processes.registry import PROCESS_IDS
from tests.acceptance import digests
from tests.acceptance.digested import content, questions
from tests.acceptance.digested.calls import COMMANDS

BEFORE = {"rows": [{"engine": "exact", "cells": 3, "run_s": 0.1}, {"engine": "forward", "cells": 5}]}


@pytest.mark.skipif(
    not digests.same_arithmetic_possible(), reason="the digests are of x86-64 with AVX2 and FMA, and of glibc"
)
def test_quick_answers_are_what_they_were() -> None:
    names = questions.quick_names()
    assert len(names) > 40
    found = digests.check(names)
    assert found == {}, f"computed by {digests.other_arithmetic() or 'the same versions'}"


def test_every_question_has_digests() -> None:
    assert set(digests.stored()) == set(questions.names())


def test_the_service_keeps_what_the_process_computes() -> None:
    # Both were stored at different times: an old digest that a merge brings back is found here.
    stored, compared = digests.stored(), 0
    for served in (name for name in stored if name.removeprefix("service/") in stored):
        name = served.removeprefix("service/")
        if name == served or "document.json" not in stored[name]:
            continue
        pairs = [("document.json", "record.json")]
        pairs += [(file, f"artifacts/{file}") for file in stored[name] if file.endswith(".npz")]
        for here, there in pairs:
            computed, kept = (
                {k: v for k, v in stored[n][f].items() if _computed(k)}
                for n, f in ((name, here), (served, there))
            )
            assert digests.differences({here: computed}, {here: kept}) == [], served
            compared += len(computed)
    assert compared > 500


def _computed(place: str) -> bool:
    return place.startswith("outputs.") or ("." not in place and not place.startswith(("(", "schema", "sha")))


def test_all_is_what_its_parts_are() -> None:
    stored, compared = digests.stored(), 0
    whole = stored["reproduce/all"]["printed-1.json"]
    for name in ("table2", "table3", "chain", "collision-avoidance", "tracking-mpc", "passive-safety"):
        part = stored[f"reproduce/{name}"]["printed-1.json"]
        for place in (place for place in part if place.startswith("printed.")):
            same = f"printed.{name.replace('-', '_')}.{place.removeprefix('printed.')}"
            # A place of the whole is one level deeper, and may hold what are several places of the part.
            if same in whole and not any(other.startswith(f"{place}.") for other in part):
                assert whole[same] == part[place], same
                compared += 1
    assert compared > 100


def test_times_within_a_cell_are_left_out() -> None:
    def cell(seconds: float, radius: float) -> content.Digests:
        return content.table(
            f'name,detail\ntube,"{{""compile_s"":{seconds},""radius_m"":{radius}}}"\n'.encode()
        )

    assert cell(0.1, 2.0) == cell(0.2, 2.0)
    assert cell(0.1, 2.0) != cell(0.1, 3.0)


def test_every_process_is_asked_for_its_example_here_and_over_http() -> None:
    names = set(questions.names())
    assert {f"{process_id}/example" for process_id in PROCESS_IDS} <= names
    assert {f"service/{process_id}/example" for process_id in PROCESS_IDS} <= names


def test_everything_that_can_be_reproduced_is_asked_for() -> None:
    command = [sys.executable, "-m", "safestart", "reproduce", "--help"]
    told = subprocess.run(command, capture_output=True, text=True, check=True).stdout.partition("Commands:")[
        2
    ]
    known = set(re.findall(r"^  (\S+)", told, re.MULTILINE))
    assert len(known) >= 7
    assert known == {words[1] for lines in COMMANDS.values() for words in lines if words[0] == "reproduce"}


def test_a_changed_number_is_named_and_a_time_is_none() -> None:
    before = content.document(BEFORE)
    slower = {"rows": [{**BEFORE["rows"][0], "run_s": 9.9}, BEFORE["rows"][1]]}
    assert content.document(slower) == before
    other = content.document({"rows": [BEFORE["rows"][0], {"engine": "forward", "cells": 5.0}]})
    files = {"document.json": before}, {"document.json": other}
    assert digests.differences(*files) == ["document.json differs in rows.cells"]
    turned = content.document({"rows": [dict(reversed(row.items())) for row in BEFORE["rows"]]})
    files = {"document.json": before}, {"document.json": turned}
    assert digests.differences(*files) == ["document.json differs in (order of keys)"]
    assert digests.differences({"map.npz": {"x": "1"}}, {}) == ["map.npz is gone"]
