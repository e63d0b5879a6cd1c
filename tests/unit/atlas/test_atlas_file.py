"""An atlas written and read again: the same answers bit for bit; anything else is refused."""

import dataclasses

import numpy as np
import pytest

from safestart.atlas.atlas import Atlas
from safestart.atlas.file import key_of, pack, unpack
from safestart.atlas.survey import build
from safestart.errors import InvalidInput
from safestart.exact.question import Question
from safestart.model.scenario import Scenario

QUESTION = Question(Scenario.of(2.0, 0.05))


@pytest.fixture(scope="module")
def atlas() -> Atlas:
    return build(QUESTION, 150.0, 0.05)


def test_read_again_it_answers_the_same_bits(atlas: Atlas) -> None:
    again = unpack(pack(atlas))
    assert pack(again) == pack(atlas)
    assert again.question == atlas.question
    starts = np.random.default_rng(3).uniform([-150.0, 0.0], [150.0, 160.0], (200, 2))
    for one, two in zip(atlas.bounds(starts), again.bounds(starts), strict=True):
        assert np.array_equal(one, two)
    for start in starts[:50]:
        first, second = atlas.answer(start), again.answer(start)
        assert (first.verdict, first.lower, first.upper) == (second.verdict, second.lower, second.upper)
        assert first.multipliers == second.multipliers
        assert (first.thrust is None) == (second.thrust is None)
        assert first.thrust is None or np.array_equal(first.thrust, second.thrust)


def test_an_empty_set_survives_the_file() -> None:
    empty = build(Question(Scenario.of(20.0, 0.001)))
    assert not empty.rim
    assert pack(unpack(pack(empty))) == pack(empty)


def test_the_key_knows_every_number() -> None:
    keys = {key_of(QUESTION, 150.0, 0.005), key_of(QUESTION, 150.1, 0.005), key_of(QUESTION, 150.0, 0.006)}
    for other in (
        Question(Scenario.of(2.0 + 1e-12, 0.05)),
        Question(Scenario.of(2.0, np.nextafter(0.05, 1.0))),
        Question(Scenario.of(2.0, 0.05, 1.0e-3)),
        dataclasses.replace(QUESTION, steps=31),
        dataclasses.replace(QUESTION, dt=2.5),
    ):
        keys.add(key_of(other, 150.0, 0.005))
    assert len(keys) == 8
    assert key_of(QUESTION, 150, 0.005) == key_of(QUESTION, 150.0, 0.005)


def test_what_other_code_has_built_is_not_found(monkeypatch: pytest.MonkeyPatch) -> None:
    ours = key_of(QUESTION, 150.0, 0.005)
    monkeypatch.setattr("safestart.atlas.file.source", lambda: "other code")
    assert key_of(QUESTION, 150.0, 0.005) != ours


def test_other_files_are_refused(atlas: Atlas) -> None:
    data = pack(atlas)
    for wrong in (b"", b"atlas", data[: len(data) // 2]):
        with pytest.raises(InvalidInput, match="atlas"):
            unpack(wrong)
