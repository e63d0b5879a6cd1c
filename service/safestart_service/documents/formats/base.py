"""The definition of a result format, and the choice of table for a format with rows."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel

from safestart.errors import invalid
from safestart.processes.tables import TypedTable, typed_tables
from safestart.runtime.named import misregistered
from safestart_service.errors import NotAcceptable

_MEDIA_TYPE = re.compile(r"[a-z]+/[a-z0-9][a-z0-9.+-]*(;.*)?")

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

    def __post_init__(self) -> None:
        """Raise ``Misregistered`` for a media type of another form than ``type/subtype``."""
        if not _MEDIA_TYPE.fullmatch(self.media_type):
            raise misregistered(f"media type of format {self.name}", "type/subtype", self.media_type)


def rows_of(record: Record, table: str | None) -> list[dict[str, Any]]:
    """Rows of a table, as :func:`table_of` finds it."""
    return table_of(record, table).as_rows()


def table_of(record: Record, table: str | None) -> TypedTable:
    """The table of this name, or the first one; raises ``InvalidInput`` or ``NotAcceptable``."""
    found = typed_tables(record)
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
