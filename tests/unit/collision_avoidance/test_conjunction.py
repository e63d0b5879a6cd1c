"""A CDM as an encounter of the game: the same state by another library's propagator and frames; refusals."""

import brahe
import numpy as np
import pytest

from safestart.errors import InvalidInput
from safestart.interchange.ephemeris import Ephemeris
from safestart.interchange.frames import to_gcrf
from safestart.model.orbit import MU
from safestart.processes.collision_avoidance.conjunction import asked, require_possible
from safestart.processes.collision_avoidance.spec import CollisionAvoidanceInputs
from tests.unit.interchange.sample import BEGIN, kepler
from tests.unit.interchange.test_round_trips import _cdm

ELEMENTS = (7.0e6, 0.001, (0.4, 0.9, 1.3), 0.3)


def _objects(eccentricity: float = 0.001, speed: float = -6.0) -> tuple[Ephemeris, Ephemeris]:
    """The other object, and a chaser that meets it at ``speed`` m/s along its course, 30 m apart."""
    a, _, angles, mean = ELEMENTS
    other = kepler(a, eccentricity, angles, mean, np.zeros(1))
    along = other[0, 3:] / np.linalg.norm(other[0, 3:])
    across = np.cross(other[0, :3], along) / np.linalg.norm(other[0, :3])
    own = other + np.concatenate([30.0 * across, speed * along])
    epochs = np.array([BEGIN])
    return (
        Ephemeris("CHASER", "2026-001A", "EME2000", "UTC", epochs, own),
        Ephemeris("OTHER", "2020-001A", "EME2000", "UTC", epochs, other),
    )


def _inputs(text: str, **more: object) -> CollisionAvoidanceInputs:
    return CollisionAvoidanceInputs.model_validate({"conjunction": {"cdm": text, **more}})


@pytest.mark.parametrize("form", ["KVN", "XML"])
@pytest.mark.parametrize("before", [0.0, 60.0, 600.0])
def test_the_state_is_that_of_another_library(form: str, before: float) -> None:
    chaser, other = _objects()
    text = _cdm(chaser, other)
    if form == "XML":
        text = brahe.ccsds.CDM.from_str(text).to_string("XML")
    inputs, found = asked(_inputs(text, before_s=before))
    assert found is not None
    back = []
    for one in (other, chaser):
        (state,) = to_gcrf(one.frame, one.epochs, one.states)
        elements = brahe.state_eci_to_koe(state, brahe.AngleFormat.RADIANS)
        a, *rest, mean = elements
        moved = np.array([a, *rest, mean - before * np.sqrt(MU / a**3)])
        back.append(brahe.state_koe_to_eci(moved, brahe.AngleFormat.RADIANS))
    radial, along, normal, *speeds = brahe.state_eci_to_rtn(*back)
    expected = [along, radial, normal, speeds[1], speeds[0], speeds[2]]
    # In XML the other library writes millimetres.
    np.testing.assert_allclose(found["state"], expected, atol=2e-2 if form == "XML" else 1e-5)
    assert inputs.states == [found["state"]]
    assert inputs.mean_motion_rad_s == pytest.approx(np.sqrt(MU / 7.0e6**3), rel=1e-6)
    assert (found["chaser"], found["other"]) == ("CHASER", "OTHER")
    assert found["closest_approach"] == "2026-03-01T12:00:00"
    assert found["miss_distance_m"] == pytest.approx(30.0)
    # Both have 2 m, 3 m, 1 m: radial, along, normal.
    np.testing.assert_allclose(found["sigma_m"], np.sqrt([18.0, 8.0, 2.0]), rtol=1e-4)
    if before == 60.0:
        assert found["state"][0] == pytest.approx(360.0, rel=0.01)


def test_the_other_object_may_be_the_chaser() -> None:
    first, second = _objects()
    one = asked(_inputs(_cdm(first, second)))[1]
    other = asked(_inputs(_cdm(second, first), chaser="OBJECT2"))[1]
    assert one is not None
    assert other is not None
    np.testing.assert_allclose(one["state"], other["state"], atol=1e-9)


def test_without_a_message_nothing_changes() -> None:
    plain = CollisionAvoidanceInputs.model_validate({})
    assert asked(plain) == (plain, None)
    require_possible(plain)


TEXT = _cdm(*_objects())


@pytest.mark.parametrize(
    ("text", "more", "message"),
    [
        ("hello", {}, "conjunction.cdm: line 1"),
        (TEXT[: TEXT.index("OBJECT = OBJECT2")], {}, "1 objects .truncated"),
        (TEXT.replace("CCSDS_CDM_VERS", "CCSDS_OPM_VERS").replace("= 1.0\n", "= 2.0\n"), {}, "required CDM"),
        (TEXT.replace("MISS_DISTANCE = ", "MISS_DISTANCE = 9"), {}, "the distance of the states"),
        (TEXT.replace("CT_T = 9.0", "CT_T = -9.0"), {}, "positive semi-definite"),
        (TEXT.replace("CT_R = 0.0", "CT_R = 7.0"), {}, "positive semi-definite"),
        (TEXT.replace("[m**2]", "[km**2]"), {}, "in m\\*\\*2"),
        (TEXT.replace("EME2000", "ITRF"), {}, "an inertial frame"),
        (TEXT.replace("EME2000", "MOON_PA"), {}, "REF_FRAME"),
        (_cdm(*_objects(0.05)), {}, "an eccentricity of at most"),
        (_cdm(*_objects(speed=-900.0)), {"before_s": 600}, "at most 100 km apart"),
    ],
)
def test_messages_that_are_refused_at_once(text: str, more: dict[str, object], message: str) -> None:
    with pytest.raises(InvalidInput, match=message) as caught:
        require_possible(_inputs(text, **more))
    assert str(caught.value.field).startswith("conjunction")


def test_epochs_of_the_message() -> None:
    assert asked(_inputs(TEXT.replace(":00.000", ":00.250")))[1]["closest_approach"].endswith(":00.25")  # type: ignore[index]
