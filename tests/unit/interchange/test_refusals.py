"""Files with false contents: each is refused with a message that names what was required and what came."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from safestart.errors import InvalidInput
from safestart.interchange.covariance import Covariance
from safestart.interchange.ephemeris import Ephemeris
from safestart.interchange.epochs import epochs_of
from safestart.interchange.foreign import refuse_foreign
from safestart.interchange.read import attitude_from, attitude_of, encounter_of, ephemeris_from, ephemeris_of
from safestart.interchange.source import MOST_BYTES
from safestart.interchange.write import course_bytes
from tests.unit.interchange.sample import CREATED, course, turning

OEM = course_bytes(course(), "kvn", CREATED).decode()
AEM = course_bytes(turning(), "kvn", CREATED).decode()
XML = course_bytes(course(), "xml", CREATED).decode()
LAST = OEM.splitlines()[70]


def _swapped(text: str) -> str:
    lines = text.splitlines()
    lines[20], lines[21] = lines[21], lines[20]
    return "\n".join(lines)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "empty file"),
        ("hello", "KEYWORD = value"),
        ("CREATION_DATE = 2026-01-01T00:00:00\n", "CCSDS_OEM_VERS"),
        (OEM.replace("VERS = 3.0", "VERS = 9.0"), "version 1.0 or 2.0 or 3.0 of OEM"),
        (OEM.replace("EME2000", "MOON_PA"), "REF_FRAME: required one of GCRF"),
        (OEM.replace("COV_REF_FRAME = RSW_ROTATING", "COV_REF_FRAME = RTN"), "RTN_ROTATING or RTN_INERTIAL"),
        (OEM.replace("COV_REF_FRAME = RSW_ROTATING", "COV_REF_FRAME = TNW"), "required one of GCRF"),
        (OEM.replace("TIME_SYSTEM = UTC", "TIME_SYSTEM = TDB"), "one of UTC, TAI, TT, GPS"),
        (OEM.replace("CENTER_NAME = EARTH", "CENTER_NAME = MARS"), "CENTER_NAME: required EARTH"),
        (OEM.replace("META_STOP", "REF_FRAME = GCRF\nMETA_STOP", 1), "REF_FRAME once in META"),
        (OEM.replace("META_STOP", "FRAME = GCRF\nMETA_STOP", 1), "a keyword of META"),
        (OEM.replace("REF_FRAME = EME2000\n", "", 1), "REF_FRAME in META"),
        (OEM.replace("META_STOP", "", 1), "META_STOP"),
        (OEM[: OEM.index("META_STOP")], "truncated"),
        (OEM[: OEM.index("META_STOP") + 9], "truncated"),
        ("\n".join(OEM.splitlines()[:40]), "truncated"),
        (OEM.replace("COVARIANCE_STOP", ""), "COVARIANCE_STOP"),
        ("\n".join(OEM.splitlines()[:-3]) + "\nCOVARIANCE_STOP\n", "six rows of a covariance"),
        (_swapped(OEM), "epochs that rise"),
        (OEM.replace(LAST, LAST.rpartition(" ")[0]), "an epoch and 6 numbers"),
        (OEM.replace(LAST, LAST.rpartition(" ")[0] + " nan"), "a finite number"),
        (OEM.replace(LAST, LAST.rpartition(" ")[0] + " 1_0"), "a finite number"),
        (OEM.replace(LAST, LAST.rpartition(" ")[0] + " ٣"), "a finite number"),
        (OEM.replace("2026-03-01T12:00:10 ", "2026-02-30T12:00:10 "), "a date of the calendar"),
        (OEM.replace("2026-03-01T12:00:10 ", "2026-03-01T12:00:60 "), "a time of day"),
        (OEM.replace("2026-03-01T12:00:10 ", "2026-03-01T25:00:10 "), "a time of day"),
        (OEM + OEM, "one message in a file"),
        (OEM + "\x00", "NUL"),
        (OEM.replace("ORIGINATOR", "COMMENT x\nORIGINATOR").replace("COMMENT", "C" * 5000), "characters in a line"),
        (AEM, "states: OEM, OPM, OCM"),
        (XML.replace("<X>", '<X units="m">', 1), "X in km"),
        (XML[:2000], "well-formed XML"),
        (XML.replace("<Z_DOT>", "<Z_DOTT>", 1).replace("</Z_DOT>", "</Z_DOTT>", 1), "Z_DOT in stateVector"),
        (XML.replace("<oem ", "<tdm ").replace("</oem>", "</tdm>"), "tracking data"),
        (XML.replace("<oem ", "<xyz ").replace("</oem>", "</xyz>"), "one message"),
        (XML.replace("CCSDS_OEM_VERS", "CCSDS_AEM_VERS"), 'id="CCSDS_OEM_VERS"'),
    ],
)  # fmt: skip
def test_states_that_are_refused(text: str, message: str) -> None:
    with pytest.raises(InvalidInput) as caught:
        ephemeris_from(text.encode())
    assert message in caught.value.detail


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            AEM.replace("ATTITUDE_TYPE = QUATERNION", "ATTITUDE_TYPE = EULER_ANGLE"),
            "ATTITUDE_TYPE QUATERNION",
        ),
        (AEM.replace("EME2000", "LVLH"), "LVLH has different axes"),
        (AEM.replace("EME2000", "ITRF"), "REF_FRAME: required one of"),
        (AEM.replace("DATA_STOP", ""), "truncated"),
        ("\n".join(AEM.splitlines()[:30]) + "\nDATA_STOP\n", "truncated"),
        (AEM.replace(" 1.0\n", " 3.0\n", 1), "length 1 within 0.001"),
        (_swapped(AEM), "epochs that rise"),
        (OEM, "attitudes: AEM, ACM, APM"),
    ],
)
def test_attitudes_that_are_refused(text: str, message: str) -> None:
    with pytest.raises(InvalidInput) as caught:
        attitude_from(text.encode())
    assert message in caught.value.detail


def test_metres_for_kilometres_are_noticed() -> None:
    given = course(covariance=None)
    rows = tuple(
        " ".join([row.split()[0], *(repr(1e3 * float(e)) for e in row.split()[1:])])
        for row in course_bytes(given, "kvn", CREATED).decode().splitlines()
        if row.startswith("2026")
    )
    head = OEM[: OEM.index("META_STOP") + 10]
    with pytest.raises(InvalidInput, match="files hold km"):
        ephemeris_from((head + "\n".join(rows)).encode())


@pytest.mark.parametrize(
    "declaration",
    [
        '<!DOCTYPE oem [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">]>',
        '<!DOCTYPE oem [<!ENTITY b SYSTEM "file:///etc/passwd">]>',
        '<!DOCTYPE oem SYSTEM "http://127.0.0.1:1/oem.dtd">',
        "<!DOCTYPE oem>",
    ],
)
def test_document_types_are_refused_unread(declaration: str) -> None:
    head, _, rest = XML.partition("\n")
    with pytest.raises(InvalidInput, match="without document type and entities"):
        ephemeris_from(f"{head}\n{declaration}\n{rest.replace('SAFESTART', '&b;')}".encode())


def test_a_gigabyte_is_refused_by_its_length(tmp_path: Path) -> None:
    huge = tmp_path / "huge.oem"
    with huge.open("wb") as file:
        file.truncate(1_000_000_000)  # a hole: nothing is written
    for read in (ephemeris_of, attitude_of, lambda path: encounter_of(path, "inertial")):
        with pytest.raises(InvalidInput, match=f"at most {MOST_BYTES} bytes"):
            read(huge)
    with pytest.raises(InvalidInput, match="a readable file"):
        ephemeris_of(tmp_path / "none.oem")
    with pytest.raises(InvalidInput, match="a readable file"):
        ephemeris_of(tmp_path)


def test_covariances_that_cannot_be() -> None:
    good = np.diag([1.0, 2.0, 3.0, 1e-6, 1e-6, 1e-6])
    Covariance(0, "GCRF", good)
    Covariance(0, "GCRF", np.zeros((6, 6)))
    bad = good.copy()
    bad[0, 1] = bad[1, 0] = 1.6
    skew = good.copy()
    skew[0, 1] = 0.1
    for matrix, message in (
        (bad, "positive semi-definite"),
        (-good, "positive semi-definite"),
        (skew, "symmetric"),
        (good[:3, :3], "6 x 6"),
        (np.full((6, 6), np.nan), "finite"),
    ):
        with pytest.raises(InvalidInput, match=message):
            Covariance(0, "GCRF", matrix)
    text = OEM.splitlines()
    first = next(k for k, line in enumerate(text) if line.startswith("COV_REF_FRAME")) + 1
    text[first] = "-1.0"
    with pytest.raises(InvalidInput, match="positive semi-definite"):
        ephemeris_from("\n".join(text).encode())


TLE = "1 27386U 02009A   26332.51782528  .00000071  00000-0  37432-4 0  9993\n2 27386  98.1 10 0001 90 270 14.38\n"


@pytest.mark.parametrize(
    ("data", "name"),
    [
        (b"#dP2026 11 29  0  0  0.00000000      96 ORBIT IGS20 FIT  IGS\n", "SP3"),
        (b"#cV2026  1  1  0  0  0.00000000      96 ORBIT IGS20 FIT  IGS\n", "SP3"),
        (b"stk.v.11.0\nBEGIN Ephemeris\n", "STK"),
        (b"DAF/SPK " + bytes(1000), "SPICE"),
        (b"KPL/FK\n", "SPICE"),
        (TLE.encode(), "TLE"),
        (b"ENVISAT\r\n" + TLE.encode(), "TLE"),
        (b"CCSDS_OMM_VERS = 2.0\n", "OMM"),
        (b'<?xml version="1.0"?>\n<omm id="CCSDS_OMM_VERS" version="2.0">', "OMM"),
        (b"CCSDS_TDM_VERS = 1.0\n", "tracking data"),
        (b"\x89HDF\r\n\x1a\n", "HDF5"),
        (b"MATLAB 7.3 MAT-file, Platform: GLNXA64", "HDF5"),
        (b"CDF\x01", "NetCDF"),
        (b"PK\x03\x04", "ZIP"),
        (b"\x1f\x8b\x08", "gzip"),
    ],
)
@pytest.mark.parametrize("ending", ["", "csv", "mat"])
def test_other_formats_of_the_field_are_refused_by_name(data: bytes, name: str, ending: str) -> None:
    for read in (ephemeris_from, attitude_from):
        with pytest.raises(InvalidInput, match=rf"required a CCSDS message .*received .*{name}"):
            read(data, f"a.{ending}")


def test_no_message_or_table_of_ours_is_taken_for_another_format() -> None:
    for form in ("kvn", "xml", "csv", "parquet", "mat"):
        for record in (course(), turning()):
            refuse_foreign(course_bytes(record, form, CREATED))


@pytest.mark.parametrize("form", ["csv", "parquet", "mat"])
def test_tables_that_are_refused(form: str) -> None:
    data = course_bytes(course(), form, CREATED)
    cut = data[: len(data) // 2] if form != "csv" else data[: data.rindex(b",")]
    with pytest.raises(InvalidInput):
        ephemeris_from(cut, f"a.{form}")
    with pytest.raises(InvalidInput, match="columns epoch, q_s"):
        attitude_from(data, f"a.{form}")
    with pytest.raises(InvalidInput):
        ephemeris_from(b"nothing of the kind", f"a.{form}")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("x_m", "x_km", "no x_m"),
        ("x_m", "y_m", "every column once"),
        ("EME2000", "", "one text in all rows"),
        ("time_system\n", "time_system,extra\n", "values"),
    ],
)
def test_csv_that_is_refused(old: str, new: str, message: str) -> None:
    text = course_bytes(course(), "csv", CREATED).decode()
    with pytest.raises(InvalidInput, match=message):
        ephemeris_from(text.replace(old, new, 1).encode(), "a.csv")


def test_other_epochs_that_are_refused() -> None:
    for text, system in (
        ("1971-12-31T00:00:00", "TAI"),
        ("2016-12-30T23:59:60", "UTC"),
        ("2016-12-31T23:59:60", "TAI"),
        ("2100-01-01T00:00:00", "UTC"),
        ("2025-366T00:00:00", "UTC"),
        ("2026-03-01 12:00:00", "UTC"),
        ("١٩٩٩-01-01T00:00:00", "UTC"),
    ):
        with pytest.raises(InvalidInput, match="epoch"):
            epochs_of([text], system)
    given = course(covariance=None)
    with pytest.raises(InvalidInput, match="epochs that rise"):
        Ephemeris("A", "1", "GCRF", "UTC", given.epochs[::-1], given.states)
    with pytest.raises(InvalidInput, match="finite"):
        replace(given, states=given.states * np.nan)
