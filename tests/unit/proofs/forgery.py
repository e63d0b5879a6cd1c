"""What a forger tries on a proof document, whatever it proves; every attempt has to be refused."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
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
