"""A flight as CZML, for CesiumJS and other viewers. The first file loads NumPy."""

from __future__ import annotations

from typing import TYPE_CHECKING

from safestart.processes.registry import PROCESS_IDS, process
from safestart.runtime.named import load
from safestart_service.documents.formats.base import Format, Record
from safestart_service.errors import NotAcceptable

if TYPE_CHECKING:
    from safestart.interchange.flights import FlightCourses


def courses_in(record: Record) -> FlightCourses:
    """The courses of a flight's record; raises ``NotAcceptable`` for another process, ``InvalidInput``."""
    process_id = record.get("process", {}).get("id")
    named = process(process_id).courses if process_id in PROCESS_IDS else None
    found: FlightCourses | None = None
    if named:
        found = load(named, f"courses of process {process_id}")(record["inputs"], record["outputs"])
    if found is None:
        raise NotAcceptable(
            "this result is not a flight; required application/json",
            field="Accept",
            required="application/json",
        )
    return found


def _encode(record: Record, _: str | None) -> bytes:
    from safestart.interchange.flights import czml_of

    found = courses_in(record)
    return czml_of(found.chaser, found.target)


FORMAT = Format("czml", "application/vnd.safestart.czml+json", _encode)
