"""The answers to the quick questions are what they were, to the last bit; the long ones are asked by hand."""

import platform

import pytest

from tests.acceptance import digests

pytestmark = pytest.mark.skipif(
    platform.machine() not in ("x86_64", "AMD64"), reason="the digests are of the arithmetic of x86-64"
)


def test_quick_answers_are_what_they_were() -> None:
    names = digests.questions.quick_names()
    assert len(names) > 40
    assert digests.check(names) == {}


def test_every_question_has_digests_and_every_process_an_example() -> None:
    from safestart.processes.registry import PROCESS_IDS

    names = digests.questions.names()
    assert {f"{process_id}/example" for process_id in PROCESS_IDS} <= set(names)
    assert set(digests.stored()) == set(names)


def test_a_changed_number_is_named() -> None:
    before = {"document.json": {"outputs.margin_m": "1", "outputs.verdict": "2", "(all)": "3"}}
    after = {"document.json": {"outputs.margin_m": "0", "outputs.verdict": "2", "(all)": "4"}}
    assert digests.differences(before, after) == ["document.json differs in outputs.margin_m"]
    assert digests.differences(before, before) == []
