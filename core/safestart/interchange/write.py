"""Records as files of the field, by the name's end: OEM, AEM, OPM, OCM in KVN; XML; CSV, Parquet, MATLAB."""

from __future__ import annotations

from collections.abc import Iterable

from safestart.errors import invalid
from safestart.interchange.attitude_course import AttitudeCourse
from safestart.interchange.ccsds import aem, kvn, oem, xml_out
from safestart.interchange.ccsds.tokens import Token
from safestart.interchange.ephemeris import Ephemeris
from safestart.interchange.tables import columns as tables
from safestart.interchange.tables.matlab_write import matlab_of
from safestart.interchange.tables.parquet import parquet_of

FORMS = ("kvn", "xml", "csv", "parquet", "mat")


def course_bytes(course: Ephemeris | AttitudeCourse, form: str, created: str) -> bytes:
    """A course as OEM or AEM (``kvn``, ``xml``) or a table (``csv``, ``parquet``, ``mat``).

    ``created`` is the message's CREATION_DATE, UTC. Raises ``InvalidInput`` for another form.
    """
    if form in ("kvn", "xml"):
        tokens = (
            oem.tokens_of(course, created)
            if isinstance(course, Ephemeris)
            else aem.tokens_of(course, created)
        )
        return message_bytes(tokens, form)
    writers = {"csv": tables.csv_of, "parquet": parquet_of, "mat": matlab_of}
    if form not in writers:
        raise invalid("format", f"one of {', '.join(FORMS)}", form)
    return writers[form](tables.columns_of(course))


def message_bytes(tokens: Iterable[Token], form: str = "kvn") -> bytes:
    """The bytes of a message in KVN or XML; raises ``InvalidInput`` for a text with a line end."""
    return (kvn.text_of(tokens) if form == "kvn" else xml_out.text_of(tokens)).encode()
