"""Equality of results: canonical JSON without the timing keys."""

from __future__ import annotations

import json
from hashlib import sha256
from typing import Any

TIMING_KEYS = frozenset({"run_s", "compile_s", "speedup_vs_hj", "started", "finished"})


def comparable(document: Any) -> Any:
    """The document without its timing keys, at every depth; the same for the same inputs and seed."""
    if isinstance(document, dict):
        return {key: comparable(value) for key, value in document.items() if key not in TIMING_KEYS}
    if isinstance(document, list | tuple):
        return [comparable(value) for value in document]
    return document


def canonical(document: Any) -> str:
    """Canonical JSON: sorted keys, no spaces, no NaN; raises ``TypeError`` or ``ValueError`` otherwise."""
    return json.dumps(document, sort_keys=True, separators=(",", ":"), allow_nan=False)


def digest(document: Any) -> str:
    """SHA-256 that identifies a result: over the canonical JSON of :func:`comparable`, without provenance.

    Machine and versions do not belong to it: a replay elsewhere has the same hash if its inputs and outputs are the
    same.
    """
    if isinstance(document, dict):
        document = {key: value for key, value in document.items() if key != "provenance"}
    return sha256(canonical(comparable(document)).encode()).hexdigest()
