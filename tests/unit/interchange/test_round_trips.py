"""Every format reads back to the last bit what it wrote, and a second library reads it, or wrote it."""

from dataclasses import replace

import brahe
import brahe.ccsds
import numpy as np
import pytest
from ccsds_ndm.ndm_io import NdmIo

from safestart.interchange.attitude_course import AttitudeCourse
from safestart.interchange.ccsds import cdm, ocm, oem, parameters
from safestart.interchange.ccsds.message import message_of
from safestart.interchange.ephemeris import Ephemeris
from safestart.interchange.epochs import SECOND
from safestart.interchange.read import attitude_from, ephemeris_from
from safestart.interchange.tables import columns as tables
from safestart.interchange.write import course_bytes, message_bytes
from tests.unit.interchange.sample import CREATED, course, turning


def _equal(one: Ephemeris, other: Ephemeris) -> None:
    assert (one.name, one.object_id, one.frame, one.time_system) == (
        other.name, other.object_id, other.frame, other.time_system,
    )  # fmt: skip
    np.testing.assert_array_equal(one.epochs, other.epochs)
    np.testing.assert_array_equal(one.states, other.states)


def _equal_attitudes(one: AttitudeCourse, other: AttitudeCourse) -> None:
    assert (one.reference, one.body, one.time_system) == (other.reference, other.body, other.time_system)
    np.testing.assert_array_equal(one.epochs, other.epochs)
    np.testing.assert_array_equal(one.quaternions, other.quaternions)


@pytest.mark.parametrize("form", ["kvn", "xml", "csv", "parquet", "mat"])
@pytest.mark.parametrize("system", ["UTC", "TAI", "TT", "GPS"])
def test_states_round_trip(form: str, system: str) -> None:
    given = course(system=system)
    given = replace(given, epochs=given.epochs + 123_456_789, covariances=given.covariances)
    back = ephemeris_from(course_bytes(given, form, CREATED), f"a.{form}")
    _equal(given, back)
    if form in ("kvn", "xml"):
        assert len(back.covariances) == 1
        assert back.covariances[0].frame == "RTN_ROTATING"
        assert back.covariances[0].epoch == given.covariances[0].epoch
        np.testing.assert_array_equal(back.covariances[0].matrix, given.covariances[0].matrix)


@pytest.mark.parametrize("form", ["kvn", "xml"])
def test_pieces_and_several_covariances_round_trip(form: str) -> None:
    given = course()
    more = tuple(replace(given.covariances[0], epoch=int(epoch)) for epoch in given.epochs[:3])
    given = replace(given, pieces=(0, 20), covariances=more)
    back = ephemeris_from(course_bytes(given, form, CREATED))
    _equal(given, back)
    assert back.pieces == (0, 20)
    assert [one.epoch for one in back.covariances] == [one.epoch for one in more]


@pytest.mark.parametrize("form", ["kvn", "xml", "csv", "parquet", "mat"])
def test_attitudes_round_trip(form: str) -> None:
    given = turning()
    _equal_attitudes(given, attitude_from(course_bytes(given, form, CREATED), f"a.{form}"))


def test_opm_and_ocm_round_trip() -> None:
    given = replace(course(count=1), covariances=course().covariances)
    burns = (
        parameters.Manoeuvre(int(given.epochs[0]) + 5 * SECOND, 2.0, (0.1, -0.02, 0.003)),
        parameters.Manoeuvre(int(given.epochs[0]) + 9 * SECOND, 0.0, (1.0 / 3.0, 0.0, 0.0)),
    )
    for form in ("kvn", "xml"):
        data = message_bytes(parameters.orbit_tokens(parameters.OrbitParameters(given, burns), CREATED), form)
        back = parameters.orbit_of(message_of(data))
        _equal(given, back.state)
        assert back.manoeuvres == burns
        np.testing.assert_array_equal(back.state.covariances[0].matrix, given.covariances[0].matrix)
    many = course()
    for form in ("kvn", "xml"):
        back_ocm = ocm.ephemeris_of(message_of(message_bytes(ocm.tokens_of(many, burns, CREATED), form)))
        _equal(many, back_ocm)
        np.testing.assert_array_equal(back_ocm.covariances[0].matrix, many.covariances[0].matrix)


@pytest.mark.parametrize("form", ["kvn", "xml"])
def test_another_library_reads_our_states(form: str) -> None:
    given = replace(course(), covariances=())
    found = brahe.ccsds.OEM.from_str(course_bytes(given, form, CREATED).decode())
    segment = found.segments[0]
    assert (segment.object_name, segment.ref_frame, segment.time_system) == ("TARGET", "EME2000", "UTC")
    states = np.array([[*state.position, *state.velocity] for state in segment.states])
    np.testing.assert_allclose(states, given.states, rtol=1e-15)
    second = NdmIo().from_string(course_bytes(given, form, CREATED).decode())
    line = second.body.segment[0].data.state_vector[7]
    assert float(line.x.value) * 1e3 == pytest.approx(given.states[7, 0], rel=1e-15)


@pytest.mark.parametrize("form", ["kvn", "xml"])
def test_another_library_reads_our_attitudes_and_parameters(form: str) -> None:
    given = turning()
    found = brahe.ccsds.AEM.from_str(course_bytes(given, form, CREATED).decode())
    segment = found.segments[0]
    assert (segment.ref_frame_a, segment.ref_frame_b) == ("EME2000", "SC_BODY_1")
    for state, turn in list(zip(segment.states, given.quaternions, strict=True))[::20]:
        np.testing.assert_allclose(_scalar_first(state), turn, atol=1e-15)
    burn = parameters.Manoeuvre(int(given.epochs[0]), 2.0, (0.1, -0.02, 0.003))
    tokens = parameters.orbit_tokens(
        parameters.OrbitParameters(course(count=1, covariance=None), (burn,)), CREATED
    )
    opm = brahe.ccsds.OPM.from_str(message_bytes(tokens, form).decode())
    np.testing.assert_allclose(opm.position, course().states[0, :3], rtol=1e-15)
    np.testing.assert_allclose(opm.maneuvers[0].dv, burn.delta_v, rtol=1e-15)


def _scalar_first(state: object) -> np.ndarray:
    turn = state.quaternion  # type: ignore[attr-defined]
    return np.array([turn.w, turn.x, turn.y, turn.z]) if hasattr(turn, "w") else np.asarray(turn)


def test_another_library_reads_our_ocm() -> None:
    burn = parameters.Manoeuvre(int(course().epochs[0]), 2.0, (0.1, -0.02, 0.003))
    given = course()
    text = message_bytes(ocm.tokens_of(given, (burn,), CREATED), "xml").decode()
    data = NdmIo().from_string(text).body.segment.data
    assert data.traj[0].traj_ref_frame == "EME2000"
    lines = [line.split() for line in data.traj[0].traj_line]
    np.testing.assert_allclose(
        np.array([line[1:] for line in lines], dtype=float) * 1e3, given.states, rtol=1e-15
    )
    (burnt,) = data.man[0].man_line
    np.testing.assert_allclose([float(dv) * 1e3 for dv in burnt.split()[2:]], burn.delta_v, rtol=1e-15)


@pytest.mark.parametrize("form", ["KVN", "XML"])
def test_we_read_what_another_library_wrote(form: str) -> None:
    given = replace(course(), covariances=())
    other = brahe.ccsds.OEM.from_str(course_bytes(given, "kvn", CREATED).decode())
    back = ephemeris_from(other.to_string(form).encode())
    # It writes six decimals of a kilometre in KVN.
    np.testing.assert_allclose(back.states[:, :3], given.states[:, :3], atol=1e-3)
    np.testing.assert_array_equal(back.epochs, given.epochs)
    turns = turning()
    other_turns = brahe.ccsds.AEM.from_str(course_bytes(turns, "kvn", CREATED).decode())
    back_turns = attitude_from(other_turns.to_string(form).encode())
    np.testing.assert_allclose(back_turns.quaternions, turns.quaternions, atol=1e-9)


def test_scalar_first_and_b_to_a_are_the_same_attitude() -> None:
    given = turning()
    text = course_bytes(given, "kvn", CREATED).decode()
    lines = []
    for line in text.splitlines():
        parts = line.split()
        if len(parts) == 5 and parts[0].startswith("2026"):
            x, y, z = ((part[1:] if part.startswith("-") else f"-{part}") for part in parts[1:4])
            line = " ".join([parts[0], parts[4], x, y, z])
        lines.append(line)
    old = "ATTITUDE_TYPE = QUATERNION\nATTITUDE_DIR = B2A\nQUATERNION_TYPE = FIRST"
    other = "\n".join(lines).replace("VERS = 2.0", "VERS = 1.0").replace("ATTITUDE_TYPE = QUATERNION", old)
    np.testing.assert_array_equal(attitude_from(other.encode()).quaternions, given.quaternions)


def test_an_apm_of_either_version_gives_its_quaternion() -> None:
    old = (
        "CCSDS_APM_VERS = 1.0\nCREATION_DATE = 2026-01-01T00:00:00\nORIGINATOR = A\nOBJECT_NAME = T\n"
        "OBJECT_ID = 2020-001A\nCENTER_NAME = EARTH\nTIME_SYSTEM = UTC\nEPOCH = 2026-060T12:00:00\n"
        "Q_FRAME_A = EME2000\nQ_FRAME_B = SC_BODY_1\nQ_DIR = A2B\nQ1 = 0.0\nQ2 = 0.0\nQ3 = 0.6\nQC = 0.8\n"
    )
    new = (
        "CCSDS_APM_VERS = 2.0\nCREATION_DATE = 2026-01-01T00:00:00\nORIGINATOR = A\nMETA_START\nOBJECT_NAME = T\n"
        "OBJECT_ID = 2020-001A\nTIME_SYSTEM = UTC\nMETA_STOP\nEPOCH = 2026-060T12:00:00\nQUAT_START\n"
        "REF_FRAME_A = EME2000\nREF_FRAME_B = SC_BODY_1\nQ1 = 0.0\nQ2 = 0.0\nQ3 = 0.6\nQC = 0.8\nQUAT_STOP\n"
    )
    for text in (old, new):
        found = attitude_from(text.encode())
        np.testing.assert_array_equal(found.quaternions, [[0.8, 0.0, 0.0, 0.6]])
        np.testing.assert_array_equal(found.epochs, turning().epochs[:1])


def test_a_cdm_gives_both_objects() -> None:
    target, chaser = course(count=1), course(count=1, mean=0.3 + 1e-5)
    text = _cdm(target, chaser)
    for form in ("kvn", "xml"):
        data = text.encode() if form == "kvn" else brahe.ccsds.CDM.from_str(text).to_string("XML").encode()
        found = cdm.encounter_of(message_of(data), "inertial")
        np.testing.assert_allclose(found.first.states, target.states, rtol=1e-9)
        np.testing.assert_allclose(found.second.states, chaser.states, rtol=1e-9)
        assert found.first.covariances[0].frame == "RTN_INERTIAL"
        np.testing.assert_allclose(
            np.diagonal(found.second.covariances[0].matrix), [4.0, 9.0, 1.0, 1e-4, 1e-4, 1e-4]
        )


def _cdm(first: Ephemeris, second: Ephemeris) -> str:
    miss = float(np.linalg.norm(first.states[0, :3] - second.states[0, :3]))
    lines = [
        "CCSDS_CDM_VERS = 1.0", "CREATION_DATE = 2026-01-01T00:00:00", "ORIGINATOR = A", "MESSAGE_ID = 1",
        "TCA = 2026-03-01T12:00:00.000", f"MISS_DISTANCE = {miss!r} [m]",
    ]  # fmt: skip
    for k, one in enumerate((first, second), 1):
        lines += [
            f"OBJECT = OBJECT{k}", f"OBJECT_DESIGNATOR = {k}", "CATALOG_NAME = SATCAT", f"OBJECT_NAME = {one.name}",
            f"INTERNATIONAL_DESIGNATOR = {one.object_id}", "EPHEMERIS_NAME = NONE", "COVARIANCE_METHOD = CALCULATED",
            "MANEUVERABLE = NO", "REF_FRAME = EME2000",
        ]  # fmt: skip
        for j, (name, value) in enumerate(zip(parameters.STATE, one.states[0].tolist(), strict=True)):
            lines.append(f"{name} = {value / 1e3!r} [{'km' if j < 3 else 'km/s'}]")
        diagonal = iter((4.0, 9.0, 1.0, 1e-4, 1e-4, 1e-4))
        for name in cdm.TRIANGLE:
            row, column = name[1:].split("_")
            unit = ("m**2", "m**2/s", "m**2/s**2")[name.count("DOT")]
            lines.append(f"{name} = {next(diagonal) if row == column else 0.0!r} [{unit}]")
    return "\n".join(lines) + "\n"


def test_leap_seconds_and_days_of_the_year() -> None:
    given = replace(course(count=3, covariance=None))
    from safestart.interchange.epochs import epochs_of, text_of

    texts = [
        "2016-12-31T23:59:59.500000000",
        "2016-12-31T23:59:60.250000000",
        "2017-01-01T00:00:00.000000000",
    ]
    found = epochs_of(texts, "UTC")
    np.testing.assert_array_equal(np.diff(found), [750_000_000, 750_000_000])
    assert text_of(found, "UTC") == texts
    assert epochs_of(["2016-366T23:59:60.25"], "UTC")[0] == found[1]
    assert text_of(found, "TAI")[2] == "2017-01-01T00:00:37.000000000"
    assert text_of(found, "GPS")[2] == "2017-01-01T00:00:18.000000000"
    assert text_of(found, "TT")[2] == "2017-01-01T00:01:09.184000000"
    assert tables.columns_of(given)["epoch"][0] == "2026-03-01T12:00:00"
    assert oem.tokens_of(given, CREATED)[0].name == "CCSDS_OEM_VERS"
