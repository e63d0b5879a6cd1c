"""The inputs that make a run this run, as short texts: what a list can show of a job without its documents."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from typing import Any

from safestart.processes.registry import PROCESS_IDS, process
from safestart_service.documents.describe import described_inputs

_MOST, _LONGEST, _ENTRIES = 24, 60, 8


def key_inputs(process_id: str, inputs: dict[str, Any]) -> dict[str, str]:
    """Texts by path, such as ``grid.nx``: required inputs, those of the example, and those unlike their default.

    Lists of more than 8 entries are told by their length; at most 24 paths are told, each in at most 60 letters. Of a
    process that is not known here all inputs count.
    """
    known = described_inputs(process_id) if process_id in PROCESS_IDS else {}
    example = process(process_id).example if known else {}
    chosen = {
        name: value
        for name, value in inputs.items()
        if name not in known
        or known[name]["minOccurs"]
        or name in example
        or (_plain(value) and value != known[name]["schema"].get("default"))
    }
    return dict(islice(_leaves(chosen, ""), _MOST))


def _leaves(inputs: dict[str, Any], path: str) -> Iterator[tuple[str, str]]:
    for name, value in inputs.items():
        here = f"{path}.{name}" if path else name
        if isinstance(value, list) and len(value) == 1 and isinstance(value[0], dict):
            value = value[0]
        if isinstance(value, dict):
            yield from _leaves(value, here)
        elif value is not None and value != [] and value != "":
            text = _text(value)
            yield here, text if len(text) <= _LONGEST else f"{text[: _LONGEST - 2]} …"


def _text(value: Any) -> str:
    if isinstance(value, list):
        if len(value) > _ENTRIES:
            return f"{len(value)} entries"
        return ", ".join(
            f"({_text(item)})" if isinstance(item, list | dict) else _text(item) for item in value
        )
    if isinstance(value, dict):
        told = ((name, item) for name, item in value.items() if item is not None)
        return ", ".join(f"{name} {_text(item)}" for name, item in islice(told, _ENTRIES))
    if isinstance(value, bool) or value is None:
        return {True: "yes", False: "no", None: "–"}[value]
    return f"{value:g}" if isinstance(value, float) and value == float(f"{value:g}") else str(value)


def _plain(value: Any) -> bool:
    """Whether a value holds no objects; those are full of defaults."""
    if isinstance(value, list):
        return not any(isinstance(item, list | dict) for item in value)
    return not isinstance(value, dict)
