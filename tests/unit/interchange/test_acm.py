"""Attitude Comprehensive Messages: as the standard writes them, as another library rewrites them, and with faults."""

import numpy as np
import pytest
from ccsds_ndm.mapping import NDMFileFormats
from ccsds_ndm.ndm_io import NdmIo

from safestart.errors import InvalidInput
from safestart.interchange.ccsds.tokens import decimal
from safestart.interchange.epochs import SECOND
from safestart.interchange.read import attitude_from, course_from
from tests.unit.interchange.sample import turning

GIVEN = turning()


def _rows(rates: str = "") -> str:
    begin = GIVEN.epochs[0]
    return "\n".join(
        f"{float(at - begin) / SECOND!r} {decimal(x)} {decimal(y)} {decimal(z)} {decimal(scalar)}{rates}"
        for at, (scalar, x, y, z) in zip(GIVEN.epochs.tolist(), GIVEN.quaternions.tolist(), strict=True)
    )


ACM = f"""CCSDS_ACM_VERS = 2.0
CREATION_DATE = 2026-01-01T00:00:00
ORIGINATOR = TESTS
META_START
OBJECT_NAME = {GIVEN.name}
INTERNATIONAL_DESIGNATOR = {GIVEN.object_id}
TIME_SYSTEM = UTC
EPOCH_TZERO = 2026-03-01T12:00:00
META_STOP
ATT_START
REF_FRAME_A = {GIVEN.reference}
REF_FRAME_B = {GIVEN.body}
NUMBER_STATES = 4
ATT_TYPE = QUATERNION
{_rows()}
ATT_STOP
PHYS_START
WET_MASS = 100.0 [kg]
PHYS_STOP
"""


def _same(text: str | bytes) -> None:
    found = attitude_from(text.encode() if isinstance(text, str) else text)
    assert (found.name, found.object_id) == (GIVEN.name, GIVEN.object_id)
    assert (found.reference, found.body, found.time_system) == (GIVEN.reference, GIVEN.body, "UTC")
    np.testing.assert_array_equal(found.epochs, GIVEN.epochs)
    np.testing.assert_array_equal(found.quaternions, GIVEN.quaternions)


def test_an_acm_says_the_same_as_the_course() -> None:
    _same(ACM)
    assert course_from(ACM.encode()).name == GIVEN.name


def test_rates_behind_the_quaternion_are_left_out() -> None:
    with_rates = ACM.replace("NUMBER_STATES = 4", "NUMBER_STATES = 7\nRATE_TYPE = ANGVEL")
    _same(with_rates.replace(_rows(), _rows(" 0.1 0.2 0.3")))


def _xml() -> str:
    """The same message in the form of 505.0-B-3."""
    meta, att = (
        ACM[ACM.index(f"{name}_START") :].split(f"{name}_STOP")[0].splitlines()[1:]
        for name in ("META", "ATT")
    )
    elements = {
        name: "".join(
            f"<{key.strip()}>{value.strip()}</{key.strip()}>"
            for key, _, value in (line.partition("=") for line in lines if "=" in line)
        )
        for name, lines in (("metadata", meta), ("att", att))
    }
    lines = "".join(f"<attLine>{line}</attLine>" for line in att if "=" not in line)
    return (
        '<?xml version="1.0" encoding="UTF-8"?><acm id="CCSDS_ACM_VERS" version="2.0"><header>'
        "<CREATION_DATE>2026-01-01T00:00:00</CREATION_DATE><ORIGINATOR>TESTS</ORIGINATOR></header><body><segment>"
        f"<metadata>{elements['metadata']}</metadata><data><att>{elements['att']}{lines}</att></data></segment></body></acm>"
    )


def test_another_library_reads_its_xml_and_writes_it_anew() -> None:
    """Its reader of KVN (3.1) puts the frames of ATT into another block, so that only XML is compared."""
    message = NdmIo().from_string(_xml())
    (att,) = message.body.segment.data.att
    assert (att.ref_frame_a, att.ref_frame_b, att.number_states) == (GIVEN.reference, GIVEN.body, 4)
    assert len(att.att_line) == len(GIVEN.epochs)
    _same(NdmIo().to_string(message, NDMFileFormats.XML))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (ACM.replace("ATT_TYPE = QUATERNION", "ATT_TYPE = EULER_ANGLES"), "ATT_TYPE QUATERNION"),
        (ACM.replace("NUMBER_STATES = 4", "NUMBER_STATES = 7"), "NUMBER_STATES 4"),
        (ACM.replace("NUMBER_STATES = 4", "NUMBER_STATES = 4\nRATE_TYPE = SPIN"), "RATE_TYPE NONE"),
        (ACM.replace("ATT_TYPE", "DIRECTION = A2B\nATT_TYPE"), "a keyword of ATT"),
        (ACM.replace("META_STOP", "STOP_TIME = 2027-01-01T00:00:00\nMETA_STOP"), "truncated"),
        (ACM[: ACM.index("ATT_START")], "attitudes (ATT_START)"),
        (ACM.replace(_rows(), ""), "attitudes in ATT"),
        (ACM.replace("ATT_STOP", "ATTI_STOP"), "ATT"),
        (ACM.replace("PHYS", "ORB"), "a block of ACM"),
        (ACM.replace("VERS = 2.0", "VERS = 1.0"), "version 2.0 of ACM"),
        (ACM.replace("REF_FRAME_A = ", "REF_FRAME_A = X"), "REF_FRAME"),
        (ACM.replace(_rows(), _rows(" 1")), "a time and 4 numbers"),
        (ACM.replace("ATT_STOP", f"{_rows().splitlines()[0]}\nATT_STOP"), "epochs that rise"),
    ],
)
def test_faults_are_refused_by_name(text: str, message: str) -> None:
    with pytest.raises(InvalidInput) as caught:
        attitude_from(text.encode())
    assert message in caught.value.detail
