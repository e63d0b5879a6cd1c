"""What a forger tries on a proof document, whatever it proves; every attempt has to be refused."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from safestart.proofs.statement import digest_of
from safestart.proofs.strict import ProofRejected

Document = dict[str, Any]
Change = Callable[[Document], None]
Check = Callable[[Any], object]


def sealed(document: Document) -> Document:
    """The document with the digest that belongs to it: a forger writes the digest, too."""
    document["digest"] = digest_of(document)
    return document


def changed(document: Document, key: str, value: Any) -> Document:
    """A sealed copy with another value under a dotted key."""
    made = copy.deepcopy(document)
    *path, last = key.split(".")
    inside = made
    for part in path:
        inside = inside[part]
    inside[last] = value
    return sealed(made)


def assert_refused(check: Check, document: Document, change: Change, said: str) -> None:
    """A harmful change is refused for its digest, and with the right digest for what it harms."""
    made = copy.deepcopy(document)
    change(made)
    with pytest.raises(ProofRejected, match="digest"):
        check(made)
    with pytest.raises(ProofRejected, match=said):
        check(sealed(made))


def assert_every_digit_counts(check: Check, document: Document, number: int) -> None:
    """One digit of the text, at ``number`` places: another document, whatever it may still prove."""
    text = json.dumps(document)
    places = [i for i, c in enumerate(text) if c.isdigit()]
    for place in np.random.default_rng(1).choice(places, number, replace=False):
        other_text = text[:place] + str((int(text[place]) + 5) % 10) + text[place + 1 :]
        try:
            other = json.loads(other_text)
        except ValueError:
            continue
        if other != document:
            with pytest.raises(ProofRejected):
                check(other)


def places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[tuple[Any, ...], Any]]:
    """Every object, list and leaf with where it stands."""
    yield path, value
    if isinstance(value, dict):
        for key, inside in value.items():
            yield from places(inside, (*path, key))
    if isinstance(value, list):
        for k, inside in enumerate(value[:3]):
            yield from places(inside, (*path, k))


def put(made: Document, path: tuple[Any, ...], value: Any) -> None:
    inside: Any = made
    for key in path[:-1]:
        inside = inside[key]
    inside[path[-1]] = value


def refused(check: Check, made: Document, path: tuple[Any, ...], factor: float) -> bool:
    """Whether the document is refused with another number, or all numbers of a list, at a place."""
    forged, inside = copy.deepcopy(made), made
    for key in path:
        inside = inside[key]
    put(forged, path, [e * factor for e in inside] if isinstance(inside, list) else inside * factor)
    try:
        check(sealed(forged))
    except ProofRejected:
        return True
    return False


def assert_all_is_read(check: Check, document: Document, without: tuple[str, ...] = ()) -> None:
    """A field of another type, one that is missing, one too many: refused at every place of the document.

    ``without`` are fields that a document need not have: less is claimed, and proved, then.
    """
    for path, value in places(document):
        if not path or path[0] == "digest":
            continue
        for other in (None, "x", True, [], {}, float(10**300), -1e300):
            if other == "x" and path[-1] == "name":
                # A face that no multiplier names may have any name.
                continue
            forged = copy.deepcopy(document)
            put(forged, path, other)
            with pytest.raises(ProofRejected):
                check(sealed(forged))
        if isinstance(value, dict):
            for key in {*value, "more"} - {*without}:
                forged = copy.deepcopy(document)
                inside: Any = forged
                for step in path:
                    inside = inside[step]
                if key == "more":
                    inside["more"] = 1
                else:
                    del inside[key]
                with pytest.raises(ProofRejected):
                    check(sealed(forged))
