"""Paper 001: the values it prints, its statements about the escapes and eq. (12), and where a grid is wrong."""

import numpy as np
import pytest

from safestart.cli.reproduce import collision_avoidance as avoidance
from safestart.collision_avoidance.bounds.certified import lower, upper
from safestart.collision_avoidance.encounters.slot import EVASIVE, RECOVERY, Slot
from safestart.collision_avoidance.game import Game, Players
from safestart.collision_avoidance.tube import solve_tube
from safestart.collision_avoidance.tube_settings import TubeSettings
from safestart.constraints.thrust import InputSet

pytestmark = pytest.mark.slow

# Section IV-A: mean motion (rad/s), bounds of both players by axis (m/s^2).
MOTION, THRUST, DISTURBANCE = 0.0011, 0.1, 0.05
# What the paper does not print is as small as it can be.
FEW = {
    "grid": {"nodes_position": 13, "nodes_speed": 9, "kept": 3},
    "encounters": 30,
    "supervised": 6,
    "supervised_s": 1500,
    "threat_s": 120,
    "pilots": ["certified", "coast"],
    "adversaries": ["worst", "mirror"],
    "slices_m_s": [[-4, 0]],
}


def game(keep_out_m: float) -> Game:
    return Game(MOTION, InputSet("box", (THRUST,) * 2), InputSet("box", (DISTURBANCE,) * 2), keep_out_m)


@pytest.fixture(scope="module")
def document() -> dict:
    return avoidance.collision_avoidance_document(FEW)


def test_what_is_reproduced_is_the_paper_s(document: dict) -> None:
    inputs = document["inputs"]
    assert (inputs["mean_motion_rad_s"], inputs["thrust_m_s2"], inputs["disturbance_m_s2"]) == (
        MOTION,
        THRUST,
        DISTURBANCE,
    )
    # Eq. (18) bounds Player 2 by axis; eq. (19) is the recovery box.
    assert inputs["shape"] == "box"
    assert inputs["slot"] == {"x_m": 1000, "y_m": 0, "half_x_m": 50, "half_y_m": 25, "half_speed_m_s": 0.01}
    assert Slot() == Slot((1000.0, 0.0, 0.0, 0.0), (50.0, 25.0, 0.01, 0.01))
    # Table I: nominal and recovery, evasive.
    assert (RECOVERY.position, RECOVERY.speed) == ((1.0e-4, 1.0e-4), (2.0e-2, 2.0e-2))
    assert (EVASIVE.position, EVASIVE.speed) == ((5.0e-4, 5.0e-4), (4.4e-2, 4.4e-2))


def test_evasion_holds_and_what_is_proved_lost_is_lost(
    document: dict, capsys: pytest.CaptureFixture[str]
) -> None:
    """The abstract: outside the unsafe set a control exists that avoids, inside none does."""
    assert [row["verdict"] for row in document["requirements"]] == ["HELD"] * 5
    lost = {row["pilot"]: row["lost"] for row in document["encounters"] if row["starts"] == "outside"}
    assert lost["certified"] == 0
    assert lost["coast"] == 30
    avoidance.show(document)
    assert "certified evasion keeps the separation" in capsys.readouterr().out


def test_escapes_are_not_all_what_section_iii_c_says(document: dict) -> None:
    """A tangential burn of dv lowers (raises) the orbit by 2 dv / w and drifts the other way at 3 dv."""
    rows = document["escape"]
    burnt = 60.0 * THRUST
    for row, side in zip(rows, (0, 0, 1, -1), strict=True):
        assert row["drift_m_s"] == pytest.approx(3.0 * side * burnt, rel=1e-3)
        assert row["altitude_m"] == pytest.approx(-2.0 * side * burnt / MOTION, rel=1e-3, abs=1e-6)
    assert [row["paper_says"].endswith("same altitude") for row in rows] == [False, False, True, True]
    # Back where it braked at w t = 1.2757, counted from the middle of the burn.
    assert rows[2]["overtakes_s"] == pytest.approx(1.2757 / MOTION + 30.0, abs=10.0)


def test_capture_at_the_three_radial_speeds_of_figure_3(document: dict) -> None:
    found = {row["radial_m_s"]: row["captured_percent"] for row in document["capture"]}
    assert found == pytest.approx({-4.0: 45.5, 0.0: 47.0, 4.0: 45.5}, abs=0.5)
    # The box of eq. (19) is far thinner than a cell of a 4-D grid, which therefore loses the set.
    assert document["capture_level_set"]["both"] < document["capture_level_set"]["flown_only"]


def nodes(axes: list[np.ndarray]) -> np.ndarray:
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)


def test_a_level_set_alone_calls_lost_states_safe() -> None:
    """1 km, 60 s, 41 x 41 x 15 x 15, first order: at least 1260 of at least 46 493 provably lost nodes."""
    settings = TubeSettings("low", (41, 15), (3000.0, 20.0), kept=2, together=False, join=False)
    tube = solve_tube(game(1000.0), 60.0, settings)
    lost = upper(tube.game, nodes(tube.lattice.axes), 60.0) <= 0.0
    assert 46_493 <= lost.sum() <= 46_645
    assert 1260 <= (lost & (tube.raw[-1] > 0.0)).sum() <= 1500


def test_equation_12_as_printed_is_the_collision_that_player_1_can_seek() -> None:
    """Its set holds the unsafe one, and states from which separation is proved to be kept."""
    settings = TubeSettings("low", (17, 9), (1500.0, 20.0), kept=2, players=Players.PAPER, join=False)
    tube = solve_tube(game(1000.0), 60.0, settings)
    states = nodes(tube.lattice.axes)
    printed = tube.raw[-1] <= 0.0
    lost = upper(tube.game, states, 60.0) <= 0.0
    kept = lower(tube.game, states, 60.0, goal_m=1e-6, effort=0) > 0.0
    assert printed[lost].all()
    assert (printed & kept).sum() > 100
