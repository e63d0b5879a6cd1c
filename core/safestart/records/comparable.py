"""When two results count as the same: canonical JSON without the keys that only tell time."""

from __future__ import annotations

import json
from hashlib import sha256
from typing import Any

TIMING_KEYS = frozenset({"run_s", "compile_s", "speedup_vs_hj", "started", "finished"})


def comparable(document: Any) -> Any:
    """The document without its timing keys, at every depth: equal for equal (inputs, seed), times aside."""
    if isinstance(document, dict):
        return {key: comparable(value) for key, value in document.items() if key not in TIMING_KEYS}
    if isinstance(document, list | tuple):
        return [comparable(value) for value in document]
    return document


def canonical(document: Any) -> str:
    """Canonical JSON: sorted keys, no spaces, no NaN; raises ``TypeError`` or ``ValueError`` otherwise."""
    return json.dumps(document, sort_keys=True, separators=(",", ":"), allow_nan=False)


def digest(document: Any) -> str:
    """SHA-256 that identifies a result: over the canonical JSON of :func:`comparable`, provenance left out.

    Where and with which versions something was computed is not what was computed: a replay elsewhere has the
    same hash if its inputs and outputs are the same.
    """
    if isinstance(document, dict):
        document = {key: value for key, value in document.items() if key != "provenance"}
    return sha256(canonical(comparable(document)).encode()).hexdigest()
