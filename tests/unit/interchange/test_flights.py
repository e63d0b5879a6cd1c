"""The files of a flight say what the flight says, and others read them."""

import io
import json
import zipfile

import brahe.ccsds
import numpy as np
import pytest

from safestart.errors import InvalidInput
from safestart.interchange.ccsds import parameters
from safestart.interchange.ccsds.message import message_of
from safestart.interchange.flights import BEGIN, courses_of
from safestart.interchange.read import attitude_from, ephemeris_from
from safestart.interchange.relative import relative_states
from safestart.interchange.sampling import quaternions_at
from safestart.interchange.tables.matlab_read import arrays_in
from safestart.processes.execute import Execution, execute
from safestart_service.documents.formats.registry import BY_NAME
from safestart_service.errors import NotAcceptable


@pytest.fixture(scope="module")
def flown() -> Execution:
    start = {"x_m": 5, "y_m": 40, "z_m": 3}
    return execute("flight", {"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "start": start, "horizon_s": 20})


@pytest.fixture(scope="module")
def files(flown: Execution) -> dict[str, bytes]:
    return {artifact.name: artifact.data for artifact in flown.artifacts}


def test_the_courses_give_the_flight_back(flown: Execution, files: dict[str, bytes]) -> None:
    outputs = flown.document["outputs"]
    chaser, target = ephemeris_from(files["chaser.oem"]), ephemeris_from(files["target.oem"])
    seen = relative_states(chaser, target, chaser.epochs)
    np.testing.assert_allclose(seen.states[:, :3], outputs["lvlh_m"], atol=1e-8)
    np.testing.assert_allclose(seen.states[:, 3:], outputs["lvlh_m_s"], atol=1e-11)
    np.testing.assert_allclose(seen.mean_motions(), 1.1e-3, rtol=1e-12)
    attitude = attitude_from(files["target.aem"])
    from safestart.attitude.quaternion import matrix_of

    turns = matrix_of(quaternions_at(attitude, chaser.epochs)) @ seen.axes.swapaxes(1, 2)
    body = np.einsum("kij,kj->ki", turns, seen.states[:, :3])
    np.testing.assert_allclose(body, outputs["body_m"], atol=1e-8)


def test_velocity_is_the_derivative_of_position(flown: Execution) -> None:
    outputs = flown.document["outputs"]
    at, fast = np.array(outputs["lvlh_m"]), np.array(outputs["lvlh_m_s"])
    # Over half a second of held thrust: the mean velocity, to the third derivative.
    np.testing.assert_allclose(np.diff(at, axis=0) / 0.5, 0.5 * (fast[1:] + fast[:-1]), atol=2e-5)


def test_burns_add_up(flown: Execution, files: dict[str, bytes]) -> None:
    outputs = flown.document["outputs"]
    found = parameters.orbit_of(message_of(files["chaser.opm"]))
    spent = sum(float(np.linalg.norm(burn.delta_v)) for burn in found.manoeuvres)
    assert spent == pytest.approx(outputs["delta_v_m_s"], rel=1e-12)
    assert sum(burn.duration for burn in found.manoeuvres) <= 20.0
    other = brahe.ccsds.OPM.from_str(files["chaser.opm"].decode())
    assert len(other.maneuvers) == len(found.manoeuvres) > 1
    np.testing.assert_allclose(other.maneuvers[1].dv, found.manoeuvres[1].delta_v, rtol=1e-14)


def test_others_read_the_pair_and_the_scene(flown: Execution, files: dict[str, bytes]) -> None:
    states = brahe.ccsds.OEM.from_str(files["chaser.oem"].decode()).segments[0].states
    chaser = ephemeris_from(files["chaser.oem"])
    assert [len(states), int(chaser.epochs[0])] == [41, BEGIN]
    np.testing.assert_allclose(states[7].position, chaser.states[7, :3], rtol=1e-15)
    assert len(brahe.ccsds.AEM.from_str(files["target.aem"].decode()).segments[0].states) == 41
    document, target, scene = json.loads(files["flight.czml"])
    assert document["clock"]["interval"] == "2000-01-01T11:59:28Z/2000-01-01T11:59:48.000000Z"
    rows = np.array(scene["position"]["cartesian"]).reshape(-1, 4)
    np.testing.assert_array_equal(rows[:, 1:], chaser.states[:, :3])
    assert (target["id"], scene["position"]["referenceFrame"]) == ("TARGET", "INERTIAL")


def test_the_service_gives_them_too(flown: Execution, files: dict[str, bytes]) -> None:
    record = flown.document
    with zipfile.ZipFile(io.BytesIO(BY_NAME["zip"].encode(record, None))) as bundle:
        assert {name: bundle.read(name) for name in bundle.namelist()} == files
    assert BY_NAME["czml"].encode(record, None) == files["flight.czml"]
    arrays = arrays_in(BY_NAME["mat"].encode(record, None), 10_000)
    np.testing.assert_array_equal(arrays["time_s"], record["outputs"]["time_s"])
    np.testing.assert_array_equal(arrays["lvlh_m"], np.ravel(record["outputs"]["lvlh_m"]))
    assert BY_NAME["mat"].encode(record, None) == BY_NAME["mat"].encode(record, None)
    other = {**record, "process": {"id": "coverage"}}
    for name in ("zip", "czml"):
        with pytest.raises(NotAcceptable, match="not a flight"):
            BY_NAME[name].encode(other, None)


def test_without_an_orbit_there_are_no_files() -> None:
    inputs = {"omega_t_deg_s": 1, "a_max_m_s2": 0.1, "mean_motion_rad_s": 0, "start": {"x_m": 2, "y_m": 40}}
    assert execute("flight", {**inputs, "horizon_s": 10}).artifacts == ()
    from safestart.attitude.spin import Spin

    with pytest.raises(InvalidInput, match="mean_motion_rad_s"):
        courses_of(np.arange(3.0), np.zeros((3, 6)), np.zeros((2, 3)), 0.0, Spin(0.0))
