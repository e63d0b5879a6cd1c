"""The outcome of a result: the worst of its findings, as the pages head it, for lists and searches."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from safestart.errors import NotFound
from safestart.processes.registry import process
from safestart.processes.tables import tables_of
from safestart.processes.views import Findings

_WORST = ("bad", "open", "good")
_LONGEST = 64


def outcome_of(process_id: str, outputs: dict[str, Any]) -> dict[str, Any] | None:
    """``{word, sense, count, of, basis}`` of a result; None for a process without findings, or one not known here.

    ``word`` is the worst verdict, ``sense`` "good", "bad" or "open", ``count`` how many of the ``of`` findings are as
    bad. ``basis`` names what the verdicts rest on if that is no proof (then the sense is "open"), else it is None.
    """
    try:
        spec = process(process_id)
    except NotFound:
        return None
    views = [view for view in spec.views if isinstance(view, Findings)]
    if not views:
        return None
    tables = tables_of(outputs, spec.tables) | {"": [outputs]}
    found = [one for view in views for one in _findings(view, tables)]
    if not found:
        return None
    worst = next(sense for sense in _WORST if any(one[1] == sense for one in found))
    alike = [(word, basis) for word, sense, basis in found if sense == worst]
    word, basis = alike[0]
    return {
        "word": word[:_LONGEST],
        "sense": worst if basis is None else "open",
        "count": len(alike),
        "of": len(found),
        "basis": basis,
    }


def _findings(view: Findings, tables: dict[str, Any]) -> Iterator[tuple[str, str, str | None]]:
    basis = tables[""][0].get(view.basis) if view.basis else None
    basis = basis if isinstance(basis, str) else None  # of another version, it may be anything
    for row in tables.get(view.table, ()):
        word = row.get(view.word)
        if isinstance(word, str):
            sense = "bad" if word in view.bad else "good" if word in view.good else "open"
            yield word, sense, basis if basis in view.unproved else None
