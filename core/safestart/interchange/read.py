"""Read a file as a record, by its content: CCSDS messages in KVN and XML, CSV, Parquet, MATLAB."""

from __future__ import annotations

from pathlib import Path

from safestart.errors import invalid
from safestart.interchange.attitude_course import AttitudeCourse
from safestart.interchange.ccsds import acm, aem, cdm, ocm, oem, parameters
from safestart.interchange.ccsds.cdm import Encounter
from safestart.interchange.ccsds.message import message_of
from safestart.interchange.ccsds.parameters import Manoeuvre
from safestart.interchange.covariance import Sense
from safestart.interchange.ephemeris import Ephemeris
from safestart.interchange.source import bytes_of
from safestart.interchange.tables import columns as tables


def ephemeris_of(path: Path | str, sense: Sense | None = None) -> Ephemeris:
    """The states of an OEM, OPM, OCM or table; raises ``InvalidInput`` for another file, ``Unavailable``."""
    return ephemeris_from(bytes_of(path), str(path), sense)


def ephemeris_from(data: bytes, name: str = "", sense: Sense | None = None) -> Ephemeris:
    """Read an ephemeris from a file's bytes; its ``name`` tells tables apart."""
    if tables.is_table(data, name):
        return tables.ephemeris_of(data, name)
    message = message_of(data)
    if message.kind == "OEM":
        return oem.ephemeris_of(message, sense)
    if message.kind == "OPM":
        return parameters.orbit_of(message, sense).state
    if message.kind == "OCM":
        return ocm.ephemeris_of(message, sense)
    raise invalid("file", "states: OEM, OPM, OCM, CSV, Parquet or MATLAB", message.kind)


def attitude_of(path: Path | str) -> AttitudeCourse:
    """The attitudes of an AEM, ACM, APM or table; raises ``InvalidInput`` for another file, ``Unavailable``."""
    return attitude_from(bytes_of(path), str(path))


def attitude_from(data: bytes, name: str = "") -> AttitudeCourse:
    """Read an attitude from a file's bytes."""
    if tables.is_table(data, name):
        return tables.attitude_of(data, name)
    message = message_of(data)
    if message.kind == "AEM":
        return aem.attitude_of(message)
    if message.kind == "ACM":
        return acm.attitude_of(message)
    if message.kind == "APM":
        return parameters.attitude_of(message)
    raise invalid("file", "attitudes: AEM, ACM, APM, CSV, Parquet or MATLAB", message.kind)


def course_from(data: bytes, name: str = "", sense: Sense | None = None) -> Ephemeris | AttitudeCourse:
    """States or attitudes, whichever the bytes hold; raises as the two do."""
    if tables.is_table(data, name):
        return (
            tables.attitude_of(data, name)
            if tables.holds_turns(data, name)
            else tables.ephemeris_of(data, name)
        )
    if message_of(data).kind in ("AEM", "ACM", "APM"):
        return attitude_from(data, name)
    return ephemeris_from(data, name, sense)


def manoeuvres_from(data: bytes) -> tuple[Manoeuvre, ...]:
    """The burns of an OPM or OCM, in the order of the file; raises ``InvalidInput`` for another one."""
    message = message_of(data)
    if message.kind == "OPM":
        return parameters.orbit_of(message).manoeuvres
    if message.kind == "OCM":
        return ocm.manoeuvres_of(message)
    raise invalid("file", "manoeuvres: OPM or OCM", message.kind)


def encounter_of(path: Path | str, sense: Sense) -> Encounter:
    """The two objects of a CDM; ``sense`` gives the sense of its RTN covariances. Raises ``InvalidInput``."""
    message = message_of(bytes_of(path))
    if message.kind != "CDM":
        raise invalid("file", "CDM", message.kind)
    return cdm.encounter_of(message, sense)
