"""Plans from CSV, OPM and OCM: what is read back, and what is refused by name."""

import math

import numpy as np
import pytest

from safestart.dynamics.two_body_kernel import STAGES, WEIGHTS, drifted, placed, pushed, target_with
from safestart.errors import InvalidInput
from safestart.interchange.ccsds import kvn, ocm, oem
from safestart.interchange.ccsds.parameters import Manoeuvre, OrbitParameters, orbit_tokens
from safestart.interchange.ephemeris import Ephemeris
from safestart.interchange.epochs import SECOND
from safestart.interchange.flights import BEGIN, CREATED
from safestart.interchange.read import ephemeris_from, manoeuvres_from
from safestart.interchange.relative import lvlh_axes
from safestart.missed_burn.plan_file import elements_of, plan_in_message
from safestart.missed_burn.plan_text import burns_in_csv, is_message

TIMES, IMPULSES = (0.0, 1800.0, 3000.0), np.array([[0.1, -0.02, 0.0], [0.03, 0.2, -0.05], [-0.1, 0.0, 0.02]])
START = np.array([-50.0, 800.0, 10.0, 0.02, -0.1, 0.01])


def _course(name: str, seconds: tuple[float, ...], states: list[np.ndarray]) -> Ephemeris:
    epochs = BEGIN + np.rint(np.array(seconds) * SECOND).astype(np.int64)
    return Ephemeris(name, name, "GCRF", "TAI", epochs, np.array(states))


def _flown(axes_of: str) -> tuple[bytes, bytes, bytes]:
    """OPM and OCM of a chaser 200 s before its first burn, whose burns are given in its own axes; the target's OEM."""
    target = target_with(7.2e6, 0.02, 1.1, 0.4, 2.0)
    flight = placed(target, START)
    begun = flight.copy()
    burns = []
    flight, _ = drifted(flight, 200.0, STAGES, WEIGHTS)
    first = flight.copy()
    for k, dv in enumerate(IMPULSES):
        if k:
            flight, _ = drifted(flight, TIMES[k] - TIMES[k - 1], STAGES, WEIGHTS)
        inertial = lvlh_axes(flight[None, :6])[0][0].T @ dv
        chaser = flight[:6] + flight[6:]
        if axes_of == "TNW":
            along, across = chaser[3:] / np.linalg.norm(chaser[3:]), np.cross(chaser[:3], chaser[3:])
            across /= np.linalg.norm(across)
            own = np.array([along, np.cross(across, along), across]) @ inertial
        else:
            own = inertial if axes_of == "GCRF" else lvlh_axes(chaser[None])[0][0] @ inertial
        at = BEGIN + round((200.0 + TIMES[k]) * SECOND)
        burns.append(Manoeuvre(at, 0.0, tuple(own.tolist()), axes_of))
        pushed(flight, dv)
    chaser = _course("CHASER", (0.0,), [begun[:6] + begun[6:]])
    opm = kvn.text_of(orbit_tokens(OrbitParameters(chaser, tuple(burns)), CREATED)).encode()
    both = kvn.text_of(ocm.tokens_of(chaser, burns, CREATED)).encode()
    around = _course("TARGET", (0.0, 200.0), [begun[:6], first[:6]])
    return opm, both, kvn.text_of(oem.tokens_of(around, CREATED)).encode()


@pytest.mark.parametrize("axes_of", ["RTN", "TNW", "GCRF"])
def test_a_message_gives_the_plan_back(axes_of: str) -> None:
    opm, _, target = _flown(axes_of)
    found = plan_in_message(opm, target)
    assert [burn.time for burn in found.burns] == list(TIMES)
    np.testing.assert_allclose([burn.impulse for burn in found.burns], IMPULSES, atol=2e-9)
    flight, _ = drifted(placed(target_with(7.2e6, 0.02, 1.1, 0.4, 2.0), START), 200.0, STAGES, WEIGHTS)
    assert found.start is not None
    np.testing.assert_allclose(placed(flight[:6], found.start)[6:9], flight[6:9], atol=1e-5)
    assert found.target is not None
    assert found.target.eccentricity == pytest.approx(0.02, abs=1e-3)


def test_an_ocm_s_burns_are_an_opm_s() -> None:
    opm, both, target = _flown("RTN")
    assert [one.epoch for one in manoeuvres_from(both)] == [one.epoch for one in manoeuvres_from(opm)]
    one, other = plan_in_message(opm, target), plan_in_message(both, target)
    np.testing.assert_allclose([b.impulse for b in one.burns], [b.impulse for b in other.burns], atol=1e-12)
    text = both.decode().replace("DC_TYPE = CONTINUOUS", "DC_TYPE = TIME")
    with pytest.raises(InvalidInput, match="DC_TYPE CONTINUOUS"):
        manoeuvres_from(text.encode())
    with pytest.raises(InvalidInput, match="DV_X"):
        manoeuvres_from(both.decode().replace("MAN_DURA, DV_X", "MAN_DURA, THR_X").encode())
    with pytest.raises(InvalidInput, match="km/s"):
        manoeuvres_from(both.decode().replace("[n/a, s, km/s", "[n/a, s, m/s").encode())


@pytest.mark.parametrize(
    ("named", "told"),
    [("TRAJ_UNITS = [m, m, m, m/s, m/s, m/s]", "km,km"), ("TRAJ_UNITS = [km, km, km, km/s, km/s, km/s]", "")],
)
def test_units_of_an_ocm_s_course(named: str, told: str) -> None:
    """In KVN a list in brackets is the units of its keyword, and was passed over."""
    text = _flown("RTN")[1].decode().replace("TRAJ_TYPE = CARTPV", f"TRAJ_TYPE = CARTPV\n{named}")
    if not told:
        assert len(ephemeris_from(text.encode()).states) == 1
        return
    with pytest.raises(InvalidInput, match=told):
        ephemeris_from(text.encode())


def test_csv_with_and_without_durations() -> None:
    plain = burns_in_csv("time_s,dv_x_m_s,dv_y_m_s,dv_z_m_s\n0,0.1,0,-0.2\n60.5, 0,1e-3,0\n")
    assert [(b.time, b.impulse, b.duration) for b in plain.burns] == [
        (0.0, (0.1, 0.0, -0.2), 0.0),
        (60.5, (0.0, 1e-3, 0.0), 0.0),
    ]
    designer = (
        "burn,time_s,distance_m,x_m,y_m,z_m,dv_x_m_s,dv_y_m_s,dv_z_m_s\r\n1,0,2000,0,2000,0,0.1,0,0\r\n"
    )
    assert burns_in_csv(designer).burns[0].impulse == (0.1, 0.0, 0.0)
    assert (
        burns_in_csv("time_s,duration_s,dv_x_m_s,dv_y_m_s,dv_z_m_s\n0,20,1,0,0\n").burns[0].duration == 20.0
    )
    assert is_message(" CCSDS_OPM_VERS = 2.0")
    assert is_message("<?xml version")
    assert not is_message(designer)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "columns"),
        ("time_s,dv_x_m_s\n0,1\n", "columns"),
        ("time_s,dv_x_m_s,dv_y_m_s,dv_z_m_s,mass\n0,1,0,0,9\n", "columns"),
        ("time_s,dv_x_m_s,dv_y_m_s,dv_z_m_s\n", "1 to 1000 burns"),
        ("time_s,dv_x_m_s,dv_y_m_s,dv_z_m_s\n0,1,0\n", "line 2"),
        ("time_s,dv_x_m_s,dv_y_m_s,dv_z_m_s\n0,1,0,nan\n", "dv_z_m_s"),
    ],
)
def test_csv_that_is_no_plan(text: str, told: str) -> None:
    with pytest.raises(InvalidInput, match=told):
        burns_in_csv(text)


def test_messages_that_give_no_plan() -> None:
    opm, _, target = _flown("RTN")
    with pytest.raises(InvalidInput, match="manoeuvres"):
        plan_in_message(target, target)
    late = opm.decode().replace("EPOCH = 2000-01-01T12:00:00", "EPOCH = 2000-01-01T13:00:00", 1)
    assert late != opm.decode()
    with pytest.raises(InvalidInput, match="before the first manoeuvre"):
        plan_in_message(late.encode(), target)
    with pytest.raises(InvalidInput, match="MAN_REF_FRAME"):
        plan_in_message(opm.replace(b"MAN_REF_FRAME = RTN", b"MAN_REF_FRAME = ITRF2000"), target)


@pytest.mark.parametrize(
    "asked", [(0.02, 1.1, 0.4, 2.0), (0.3, 0.0, 0.7, -1.0), (0.0, 0.5, 0.0, 1.0), (0.7, 3.0, 4.0, 3.0)]
)
def test_elements_make_the_same_orbit(asked: tuple[float, float, float, float]) -> None:
    state = target_with(9.0e6, *asked)
    turn = 0.9
    about = np.array(
        [[math.cos(turn), -math.sin(turn), 0.0], [math.sin(turn), math.cos(turn), 0.0], [0, 0, 1]]
    )
    turned = np.concatenate([about @ state[:3], about @ state[3:]])
    one = elements_of(turned)
    again = target_with(one.semi_major_axis, one.eccentricity, one.inclination, one.perigee, one.anomaly)
    # The node does not count: heights above the equator and distances are those of the orbit.
    for part in (slice(0, 3), slice(3, 6)):
        assert np.linalg.norm(again[part]) == pytest.approx(np.linalg.norm(state[part]), rel=1e-9)
        assert again[part][2] == pytest.approx(state[part][2], abs=1e-6 * np.linalg.norm(state[part]))
    with pytest.raises(InvalidInput, match="closed orbit"):
        elements_of(np.array([9.0e6, 0.0, 0.0, 0.0, 12_000.0, 0.0]))
