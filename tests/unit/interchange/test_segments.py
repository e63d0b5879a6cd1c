"""Segments that meet, useable times, gaps of attitudes: what a file does not say is not known."""

from dataclasses import replace

import numpy as np
import pytest

from safestart.errors import InvalidInput
from safestart.interchange.attitude_course import AttitudeCourse
from safestart.interchange.ccsds import ocm
from safestart.interchange.epochs import SECOND
from safestart.interchange.read import attitude_from, ephemeris_from
from safestart.interchange.sampling import states_at
from safestart.interchange.write import course_bytes, message_bytes
from tests.unit.interchange.sample import BEGIN, CREATED, course, turning


def _at(*seconds: float) -> np.ndarray:
    return BEGIN + np.rint(np.array(seconds) * SECOND).astype(np.int64)


def _burnt() -> tuple:
    """A course of two segments that meet at 300 s, where the velocity jumps by 1 m/s; its plain halves."""
    one = course(covariance=None)
    first, second = slice(0, 31), slice(30, 61)
    late = one.states[second] + np.array([0, 0, 0, 1.0, 0, 0])
    joined = replace(
        one,
        epochs=np.concatenate([one.epochs[first], one.epochs[second]]),
        states=np.concatenate([one.states[first], late]),
        pieces=(0, 31),
    )
    return joined, one, late


@pytest.mark.parametrize("form", ["kvn", "xml"])
def test_segments_may_meet_and_the_later_one_holds_there(form: str) -> None:
    joined, one, late = _burnt()
    found = ephemeris_from(course_bytes(joined, form, CREATED))
    np.testing.assert_array_equal(found.states, joined.states)
    np.testing.assert_array_equal(found.epochs, joined.epochs)
    assert found.pieces == (0, 31)
    states, known = states_at(replace(found, frame="GCRF"), _at(295, 299.9, 300, 305, 600, 601))
    assert known.tolist() == [True] * 5 + [False]
    plain, _ = states_at(replace(one, frame="GCRF"), _at(295, 299.9))
    np.testing.assert_allclose(states[:2], plain, atol=1e-4)
    np.testing.assert_array_equal(states[2], late[0])
    second = replace(joined, epochs=joined.epochs[31:], states=joined.states[31:], pieces=(0,), frame="GCRF")
    np.testing.assert_array_equal(states[3], states_at(second, _at(305))[0][0])


def test_epochs_rise_inside_of_segments_and_segments_do_not_overlap() -> None:
    joined, _, _ = _burnt()
    with pytest.raises(InvalidInput, match="epochs that rise"):
        replace(joined, pieces=(0,))
    epochs = joined.epochs.copy()
    epochs[31:] -= SECOND
    with pytest.raises(InvalidInput, match="epochs that rise"):
        replace(joined, epochs=epochs)


@pytest.mark.parametrize("form", ["kvn", "xml", "ocm kvn", "ocm xml"])
def test_outside_of_useable_times_nothing_is_known(form: str) -> None:
    begin, end, more = _at(25, 555, 400).tolist()
    windows = ((begin, 2**62), (more, end))
    given = replace(course(covariance=None, frame="GCRF"), pieces=(0, 30), useable=windows)
    if form.startswith("ocm"):
        data = message_bytes(ocm.tokens_of(given, (), CREATED), form[4:])
    else:
        data = course_bytes(given, form, CREATED)
    found = ephemeris_from(data)
    assert found.useable == windows
    asked = _at(0, 24.9, 25, 100, 290, 300, 399.9, 400, 555, 555.1, 600)
    states, known = states_at(found, asked)
    assert known.tolist() == [False, False, True, True, True, False, False, True, True, False, False]
    # The states outside still help to interpolate.
    whole = replace(given, useable=())
    np.testing.assert_array_equal(states[known], states_at(whole, asked)[0][known])
    text = data.decode()
    if form == "kvn":
        with pytest.raises(InvalidInput, match="USEABLE_STOP_TIME after"):
            ephemeris_from(text.replace("USEABLE_STOP_TIME = 2026", "USEABLE_STOP_TIME = 2025").encode())


def test_an_ocm_that_stops_before_its_stop_time_is_truncated() -> None:
    text = message_bytes(ocm.tokens_of(course(), (), CREATED)).decode()
    lines = [line for line in text.splitlines() if not line.startswith("2026-03-01T12:10:00 ")]
    assert len(lines) == len(text.splitlines()) - 1
    with pytest.raises(InvalidInput, match="truncated"):
        ephemeris_from("\n".join(lines).encode())


def _body(seconds: np.ndarray, rate_deg_s: float, pieces: tuple[int, ...] = (0,)) -> AttitudeCourse:
    half = np.radians(rate_deg_s) * seconds / 2
    turns = np.stack([np.cos(half), 0 * half, 0 * half, np.sin(half)], axis=1)
    return AttitudeCourse("T", "1", "GCRF", "SC_BODY_1", "UTC", _at(*seconds), turns, pieces)


def _spans(one: AttitudeCourse) -> list[list[float]]:
    return ((one.spans() - BEGIN) / SECOND).tolist()


def test_a_hole_in_which_the_body_may_have_turned_is_a_gap() -> None:
    """At 1 deg/s it turns by 280 degrees in 280 s: slerp would turn it back by 80."""
    assert _spans(_body(np.r_[0:100:10, 370:500:10], 1.0)) == [[0, 90], [370, 490]]
    assert _spans(_body(np.r_[0:100:10, 130:500:10], 1.0)) == [[0, 490]]
    assert _spans(_body(np.r_[0:100:10, 401:500:10], 0.0)) == [[0, 90], [401, 491]]
    assert _spans(_body(np.array([0.0]), 1.0)) == [[0, 0]]
    assert _spans(_body(np.r_[0:500:80], 1.0)) == [[0, 480]]


@pytest.mark.parametrize("form", ["kvn", "xml"])
def test_segments_and_useable_times_of_attitudes(form: str) -> None:
    apart = _body(np.r_[0:100:10, 110:200:10], 1.0, (0, 10))
    windows = (None, tuple(_at(120, 185).tolist()))
    back = attitude_from(course_bytes(replace(apart, useable=windows), form, CREATED))
    assert (back.pieces, back.useable) == ((0, 10), windows)
    np.testing.assert_array_equal(back.quaternions, apart.quaternions)
    assert _spans(back) == [[0, 90], [120, 185]]


def test_attitude_segments_that_meet_are_one() -> None:
    one = turning()
    text = course_bytes(one, "kvn", CREATED).decode()
    head, _, rows = text.partition("DATA_START\n")
    meta = head[head.index("META_START") :]
    lines = rows.splitlines()[:-1]
    stop, start = lines[30].split()[0], lines[30].split()[0]
    first = head.replace(f"STOP_TIME = {lines[-1].split()[0]}", f"STOP_TIME = {stop}")
    second = meta.replace(f"START_TIME = {lines[0].split()[0]}", f"START_TIME = {start}")

    def whole(begin: list[str]) -> bytes:
        parts = [first, "DATA_START", *lines[:31], "DATA_STOP", second, "DATA_START", *begin, *lines[31:]]
        return "\n".join([*parts, "DATA_STOP"]).encode()

    found = attitude_from(whole([lines[30]]))
    np.testing.assert_array_equal(found.quaternions, one.quaternions)
    np.testing.assert_array_equal(found.epochs, one.epochs)
    with pytest.raises(InvalidInput, match=r"one attitude at .* where two segments meet"):
        attitude_from(whole([f"{start} 0 0 0 1"]))


@pytest.mark.parametrize(
    ("kind", "rates"),
    [
        ("QUATERNION/RATE", "0 0 {rate}"),
        ("QUATERNION/ANGVEL", "{rate} 0 0"),
        ("QUATERNION/DERIVATIVE", "0 0 0 {half}"),
    ],
)
def test_the_rates_of_a_file_show_that_its_entries_are_too_far_apart(kind: str, rates: str) -> None:
    """A body at 37 deg/s, every 10 s, looks like one at 1 deg/s."""

    def text(rate: float) -> bytes:
        plain = course_bytes(_body(np.r_[0:100:10], 1.0), "kvn", CREATED).decode()
        more = rates.format(rate=rate, half=np.radians(rate) / 2)
        lines = [f"{line} {more}" if line.startswith("2026-03") else line for line in plain.splitlines()]
        return "\n".join(lines).replace("ATTITUDE_TYPE = QUATERNION", f"ATTITUDE_TYPE = {kind}").encode()

    assert len(attitude_from(text(1.0)).epochs) == 10
    with pytest.raises(InvalidInput, match=r"at the file's own rates, received '?370"):
        attitude_from(text(37.0))
