"""An atlas written and read again: the same answers bit for bit; anything else is refused."""

import dataclasses
import io
import json
from collections import OrderedDict
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.spatial import ConvexHull, HalfspaceIntersection

from safestart.atlas.atlas import Atlas
from safestart.atlas.file import key_of, pack, unpack
from safestart.atlas.survey import build
from safestart.errors import InvalidInput
from safestart.exact.question import Question
from safestart.model.scenario import Scenario
from safestart.processes.go_no_go import atlases
from safestart.processes.go_no_go.atlases import CUTS_M, atlas_for
from safestart.runtime.progress import Context

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


Arrays = dict[str, Any]


def rewritten(data: bytes, change: Callable[[Arrays], None]) -> bytes:
    with np.load(io.BytesIO(data)) as found:
        arrays = {name: found[name].copy() for name in found.files}
    change(arrays)
    target = io.BytesIO()
    np.savez_compressed(target, allow_pickle=False, **arrays)
    return target.getvalue()


def headed(**change: Any) -> Callable[[Arrays], None]:
    """Another head; a dotted name reaches inside, None takes a field away."""

    def apply(arrays: Arrays) -> None:
        head = json.loads(str(arrays["head"]))
        for key, value in change.items():
            *path, last = key.split("__")
            inside = head
            for part in path:
                inside = inside[part]
            if value is None:
                del inside[last]
            else:
                inside[last] = value
        arrays["head"] = np.array(json.dumps(head, sort_keys=True))

    return apply


def _margin(arrays: Arrays) -> None:
    """Every start near the rim was GO with 50 m to spare."""
    arrays["margin"] += 50.0


def _level(arrays: Arrays) -> None:
    arrays["level"] -= 50.0


def _slope(arrays: Arrays) -> None:
    arrays["slope"] *= 1.0 + 1e-9


def _start(arrays: Arrays) -> None:
    arrays["start"][3] += 1.0


def _farther(arrays: Arrays) -> None:
    """The rim, and all that was computed from it, as if it lay ten times as far out."""
    centre = arrays["start"][1]
    arrays["start"][2:] = centre + 10.0 * (arrays["start"][2:] - centre)
    arrays["corners"] = arrays["start"][2:] - centre


def _corners(arrays: Arrays) -> None:
    arrays["corners"] *= 1.5


def _thrust(arrays: Arrays) -> None:
    arrays["thrust"] *= 1.0 + 1e-12


def _weights(arrays: Arrays) -> None:
    arrays["weights"][0] *= -1.0


def _faces(arrays: Arrays) -> None:
    arrays["faces"][:] = (arrays["faces"] + 1) % 3


def _times(arrays: Arrays) -> None:
    arrays["times"] += 60.0


def _more(arrays: Arrays) -> None:
    arrays["note"] = np.array("GO")


def _less(arrays: Arrays) -> None:
    del arrays["angles"]


@pytest.mark.parametrize(
    "change",
    [
        *(
            _margin,
            _level,
            _slope,
            _start,
            _farther,
            _corners,
            _thrust,
            _weights,
            _faces,
            _times,
            _more,
            _less,
        ),
        headed(question__scenario__chaser__max_acceleration=0.06),
        headed(question__scenario__target__tumble_rate=0.01),
        headed(question__scenario__corridor__c_x=3.0),
        headed(question__steps=15),
        headed(question__dt=1.0),
        headed(question__speed_limit=0.01),
        headed(question__goal={"radius": 0.5}),
        headed(question__scenario__target__mean_motion=None),
        headed(names=["left", "right", "hold_plane"]),
        headed(inner_area=1e6, outer_area=1e6),
        headed(outer_area=15_950.0),
        headed(note="GO"),
        headed(message=None),
    ],
)
def test_an_atlas_that_its_evidence_does_not_bear_out_is_refused(
    atlas: Atlas, change: Callable[[Arrays], None]
) -> None:
    with pytest.raises(InvalidInput, match="atlas"):
        unpack(rewritten(pack(atlas), change))


class _Shelf:
    def __init__(self, data: bytes) -> None:
        self.data = data

    def find(self, key: str) -> bytes | None:
        return self.data

    def keep(self, key: str, data: bytes) -> None:
        """An atlas that was built instead; nobody asks for it."""


def _context(kept: Atlas) -> Context:
    return Context(shelf=_Shelf(pack(kept)))


def test_an_atlas_of_another_question_is_not_taken_from_the_shelf(monkeypatch: pytest.MonkeyPatch) -> None:
    """A sound atlas under the key of a harder question made its starts GO."""
    easy = build(Question(Scenario.of(0.5, 0.1)), CUTS_M[1], 0.05)
    hard = Question(Scenario.of(3.1, 0.02))
    monkeypatch.setattr(atlases, "_kept", OrderedDict())
    assert atlas_for(hard, 100.0, _context(easy)).question == hard
    assert atlas_for(easy.question, 40.0, _context(easy)).y_max == CUTS_M[0], "nor one with another cut"
    assert pack(atlas_for(easy.question, 100.0, _context(easy))) == pack(easy)


def test_the_outer_area_is_that_of_the_half_planes() -> None:
    """Slivers between a witness and its own half-plane were left out: the gap was said to be smaller than it is."""
    small = build(Question(Scenario.of(5.0, 0.02), 2.0, 20), 50.0)
    sides = np.vstack([np.column_stack([-small.slopes, -small.levels]), [[0.0, 1.0, -50.0]]])
    corners = HalfspaceIntersection(sides, small.centre.start).intersections
    assert small.outer_area >= ConvexHull(corners).volume * (1.0 - 1e-9)
    assert small.relative_gap <= 0.005
    assert small.inner_area <= small.outer_area
