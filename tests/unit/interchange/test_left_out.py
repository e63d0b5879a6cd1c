"""What a record does not hold is named, and realisations of ITRF stay apart."""

import numpy as np
import pytest

from safestart.cli import main
from safestart.errors import InvalidInput
from safestart.interchange.ccsds import ocm, parameters
from safestart.interchange.frames import frame_of
from safestart.interchange.read import attitude_from, ephemeris_from
from safestart.interchange.relative import relative_states
from safestart.interchange.write import course_bytes, message_bytes
from tests.unit.interchange.sample import CREATED, course, turning


def _with(text: str, more: str) -> bytes:
    return "\n".join(
        f"{line} {more}" if line.startswith("2026-03") else line for line in text.splitlines()
    ).encode()


def test_what_is_left_out_is_named(tmp_path, monkeypatch, capsys) -> None:
    plain = course(covariance=None)
    text = course_bytes(plain, "kvn", CREATED).decode()
    assert ephemeris_from(text.encode()).left_out == ()
    assert ephemeris_from(_with(text, "0 0 0")).left_out == ("accelerations",)
    burn = parameters.Manoeuvre(int(plain.epochs[0]), 2.0, (0.1, 0.0, 0.0))
    opm = message_bytes(
        parameters.orbit_tokens(parameters.OrbitParameters(course(count=1), (burn,)), CREATED)
    )
    assert ephemeris_from(opm).left_out == ("manoeuvres",)
    assert ephemeris_from(message_bytes(ocm.tokens_of(plain, (burn,), CREATED))).left_out == ("manoeuvres",)
    assert ephemeris_from(message_bytes(ocm.tokens_of(plain, (), CREATED))).left_out == ()
    turns = course_bytes(turning(), "kvn", CREATED).decode()
    assert attitude_from(turns.encode()).left_out == ()
    rated = turns.replace("ATTITUDE_TYPE = QUATERNION", "ATTITUDE_TYPE = QUATERNION/ANGVEL")
    assert attitude_from(_with(rated, "0 0 0")).left_out == ("rates",)
    (tmp_path / "a.oem").write_bytes(_with(text, "0 0 0"))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sys.argv", ["safestart", "convert", "a.oem", "b.oem"])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code in (0, None)
    assert "left out: accelerations" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("name", "frame"),
    [
        ("ITRF", "ITRF"),
        ("itrf-97", "ITRF97"),
        ("ITRF1997", "ITRF97"),
        ("ITRF_2014", "ITRF2014"),
        ("ITRF08", "ITRF2008"),
        ("ITRF2020", "ITRF2020"),
    ],
)
def test_realisations_keep_their_number(name: str, frame: str) -> None:
    assert frame_of(name) == frame
    text = course_bytes(course(covariance=None), "kvn", CREATED).decode().replace("EME2000", name)
    assert f"REF_FRAME = {frame}\n" in course_bytes(ephemeris_from(text.encode()), "kvn", CREATED).decode()


@pytest.mark.parametrize("name", ["ITRF1", "ITRF2099", "ITRF50", "ITRFX"])
def test_realisations_that_are_none(name: str) -> None:
    with pytest.raises(InvalidInput, match="REF_FRAME"):
        frame_of(name)


@pytest.mark.parametrize("pair", [("ITRF97", "ITRF2014"), ("ITRF", "ITRF2014"), ("ITRF2014", "GCRF")])
def test_courses_of_two_realisations_are_not_compared(pair: tuple[str, str]) -> None:
    chaser, target = (course(covariance=None, frame=name) for name in pair)
    with pytest.raises(InvalidInput, match="one realisation of ITRF"):
        relative_states(chaser, target, chaser.epochs[:1])
    same = course(covariance=None, frame="ITRF2014")
    np.testing.assert_array_equal(relative_states(same, same, same.epochs[:1]).states, np.zeros((1, 6)))
