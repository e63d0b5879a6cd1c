"""A value of any type at any place of a proof: the checker proves the document or rejects it, and never breaks."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator
from typing import Any

import pytest

from safestart.proofs.checker import check
from safestart.proofs.strict import ProofRejected
from tests.fuzzing.documents import KINDS, original
from tests.fuzzing.mutants import Path, at, paths
from tests.unit.proofs.forgery import sealed

VALUES: tuple[Any, ...] = (
    {},
    {"kind": "box"},
    [],
    [[]],
    None,
    "",
    "linear",
    True,
    0,
    -1,
    1.5,
    1e18,
    -1e160,
    5e-324,
)


def places(document: Any) -> Iterator[Path]:
    """One place of each name: the entries of a list are alike."""
    seen = set()
    for path in paths(document):
        name = tuple("*" if isinstance(key, int) else key for key in path)
        if name not in seen:
            seen.add(name)
            yield path


@pytest.mark.parametrize("kind", KINDS)
def test_a_checker_never_breaks(kind: str) -> None:
    document = json.loads(original(kind))
    # Where a change is allowed, the whole proof of a missed burn is checked again, in up to seconds.
    values = VALUES if "abort" not in kind else ({}, [], None, "linear")
    refused = 0
    for *inside, last in places(document):
        for value in values:
            made = copy.deepcopy(document)
            at(made, tuple(inside))[last] = value
            try:
                check(sealed(made))
            except ProofRejected:
                refused += 1
    assert refused > len(values)


def test_an_acceleration_that_no_burn_has_is_refused() -> None:
    """It is not printed, so two documents with different ones read alike."""
    document = json.loads(original("abort-lasting"))
    failures = document["question"]["failures"]
    assert (failures["stuck_s"], failures["acceleration_m_s2"]) == (0.0, 0.0)
    assert check(document).verdict == "PROVED"
    failures["acceleration_m_s2"] = 0.02
    with pytest.raises(ProofRejected, match="acceleration_m_s2: required 0 where no burn may be stuck on"):
        check(sealed(document))


@pytest.mark.parametrize("document", [None, 0, "x", [], {}, [{}], {"schema": {}}, {"schema": []}])
def test_what_is_no_document(document: Any) -> None:
    with pytest.raises(ProofRejected):
        check(document)
