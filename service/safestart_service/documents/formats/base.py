"""The definition of a result format, and the choice of table for a format with rows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel

from safestart.errors import invalid
from safestart.processes.base import Table
from safestart.processes.registry import PROCESS_IDS, process
from safestart.processes.tables import Rows, tables_of
from safestart_service.errors import NotAcceptable

Record = dict[str, Any]
"""A stored result as ``ResultDocument`` describes it."""


@dataclass(frozen=True, slots=True)
class Format:
    """A format of a result.

    ``name`` is its value of the query parameter ``format`` and its file extension. ``encode`` (record, table) gives
    its bytes; it raises ``InvalidInput``, ``NotAcceptable`` or ``Unavailable``. ``rows``: it holds one table, the
    requested one. ``document``: it is JSON to read, described by ``model`` if given, and not a file to download.
    """

    name: str
    media_type: str
    encode: Callable[[Record, str | None], bytes]
    rows: bool = False
    document: bool = False
    model: type[BaseModel] | None = None


def rows_of(record: Record, table: str | None) -> Rows:
    """Rows of the table of this name, or of the first one; raises ``InvalidInput`` or ``NotAcceptable``."""
    found = tables_of(record["outputs"], _declared(record))
    if not found:
        raise NotAcceptable(
            "this result holds no table; required application/json or application/x-npz",
            field="Accept",
            required="application/json or application/x-npz",
        )
    if table is None:
        return next(iter(found.values()))
    if table not in found:
        raise invalid("table", f"one of {', '.join(found)}", table)
    return found[table]


def _declared(record: Record) -> tuple[Table, ...]:
    """The tables that the process declares; none if the process no longer exists."""
    process_id = record.get("process", {}).get("id")
    return process(process_id).tables if process_id in PROCESS_IDS else ()
