"""The three regimes against a NumPy twin written from the paper's equations, and the gains' presets."""

import math
from dataclasses import fields, replace

import numpy as np
import pytest

from safestart.attitude.body_frame import body_to_lvlh, lvlh_to_body, rotation, transport
from safestart.control.gains import PAPER, PRESETS, TUNED, Gains, preset
from safestart.control.regimes import CLOSE, FAR, HOLD, control_law, nominal_command
from safestart.dynamics.cwh import system_matrix
from safestart.errors import InvalidInput
from safestart.model.scenario import Scenario
from tests.unit.dynamics.plain_cwh import feedforward


def compiled(
    scenario: Scenario, gains: Gains, x: np.ndarray, time: float, r0: float
) -> tuple[np.ndarray, int]:
    theta = scenario.target.tumble_rate * time
    v_max = gains.closing_factor * math.sqrt(scenario.chaser.max_acceleration * r0)
    law = control_law(scenario, gains, 2.0)
    *command, regime = nominal_command(*x.tolist(), time, math.cos(theta), math.sin(theta), r0, v_max, law)
    return np.array(command), regime


def limited(v: np.ndarray, limit: float) -> np.ndarray:
    return v * min(1.0, limit / max(np.linalg.norm(v), 1e-300))


def twin(scenario: Scenario, gains: Gains, x: np.ndarray, time: float, r0: float) -> tuple[np.ndarray, int]:
    """Section 5.1 with vectors and the frame transforms of eqs. (3) and (5)."""
    omega, a_max = scenario.target.tumble_rate, scenario.chaser.max_acceleration
    p, v = x[:3], x[3:]
    forward = feedforward(scenario.target.mean_motion, p, v)
    v_max = gains.closing_factor * math.sqrt(a_max * r0)
    hold = np.array([0.0, scenario.corridor.hold_radius + gains.hold_clearance, 0.0])
    if np.linalg.norm(p) > scenario.sync_radius:
        achievable = min(a_max * time / 2.0, v_max)
        times = np.linspace(0.0, time, 20_001)
        speeds = np.minimum(a_max * times / 2.0, v_max)
        closed = r0 - float(np.trapezoid(speeds, times))
        arrived = closed < hold[1]
        reference = np.array([0.0, hold[1] if arrived else closed, 0.0])
        moving = np.array([0.0, 0.0 if arrived else -achievable, 0.0])
        at, velocity = body_to_lvlh(reference, moving, omega, time)
        wanted = limited(velocity + gains.kp_far / gains.kd_far * (at - p), achievable)
        return gains.kd_far * (wanted - v) + forward, FAR
    p_b, v_b = lvlh_to_body(p, v, omega, time)
    error = hold - p_b
    near = abs(np.linalg.norm(p) - hold[1]) <= gains.hold_band
    if near and np.linalg.norm(v_b) < gains.switch_speed:
        regime, demand = HOLD, gains.kp_hold * error - gains.kd_hold * v_b
    else:
        limit = v_max
        if gains.braking_share > 0.0:
            limit = min(limit, math.sqrt(2.0 * gains.braking_share * a_max * np.linalg.norm(error)))
        regime = CLOSE
        demand = gains.kd * (limited(gains.kp / gains.kd * error, limit) - v_b)
    # d/dt of eq. (5): a_L = R (a_B + 2 omega x v_B + omega x (omega x p_B))
    inertial = demand + 2.0 * transport(v_b, omega) + transport(transport(p_b, omega), omega)
    turned = inertial.copy()
    turned[:2] = rotation(omega * time) @ inertial[:2]
    return turned + forward, regime


@pytest.mark.parametrize("gains", [TUNED, PAPER], ids=["tuned", "paper"])
def test_command_equals_its_twin(gains: Gains) -> None:
    rng = np.random.default_rng(3)
    seen = {FAR: 0, CLOSE: 0, HOLD: 0}
    for _ in range(1200):
        scenario = Scenario.of(rng.uniform(0.0, 5.0), rng.choice([0.02, 0.05, 0.1]))
        time = rng.uniform(0.0, 60.0)
        r0 = rng.uniform(5.0, 150.0)
        if rng.random() < 0.3:
            angle = scenario.target.tumble_rate * time + math.pi / 2.0 + rng.normal() * 0.1
            p = rng.uniform(0.9, 3.1) * np.array([math.cos(angle), math.sin(angle), 0.05 * rng.normal()])
            v = transport(p, scenario.target.tumble_rate) + 0.05 * rng.normal(size=3)
        else:
            p, v = rng.normal(size=3) * r0, rng.normal(size=3)
        x = np.concatenate([p, v])
        ours, regime = compiled(scenario, gains, x, time, r0)
        other, expected = twin(scenario, gains, x, time, r0)
        assert regime == expected
        np.testing.assert_allclose(ours, other, rtol=1e-6, atol=1e-7)
        seen[regime] += 1
    assert min(seen.values()) > 50


def test_holding_needs_no_correction() -> None:
    # At the hold point, co-rotating: the command is exactly the acceleration that keeps it there.
    scenario = Scenario.of(4.0, 0.1)
    omega = scenario.target.tumble_rate
    hold = np.array([0.0, scenario.corridor.hold_radius + TUNED.hold_clearance, 0.0])
    for time in (0.0, 7.0, 31.0):
        p, v = body_to_lvlh(hold, np.zeros(3), omega, time)
        x = np.concatenate([p, v])
        command, regime = compiled(scenario, TUNED, x, time, 40.0)
        acceleration = (system_matrix(scenario.target.mean_motion) @ x)[3:] + command
        assert regime == HOLD
        np.testing.assert_allclose(acceleration, -(omega**2) * p, atol=1e-15)


def test_no_tumble_means_close_approach_everywhere() -> None:
    scenario = Scenario.of(0.0, 0.1)
    _, regime = compiled(scenario, TUNED, np.array([0.0, 5000.0, 0.0, 0.0, 0.0, 0.0]), 0.0, 5000.0)
    assert regime == CLOSE


def test_long_intervals_soften_the_gains() -> None:
    scenario = Scenario.of(1.0, 0.1)
    short, long = control_law(scenario, TUNED, 2.0), control_law(scenario, TUNED, 10.0)
    assert (short.kp, short.kd) == (TUNED.kp, TUNED.kd)
    assert long.kd * 10.0 + long.kp * 50.0 < 2.0
    assert long.kd**2 / long.kp == pytest.approx(TUNED.kd**2 / TUNED.kp)


def test_presets() -> None:
    assert preset("tuned") is TUNED
    assert preset("paper") is PAPER
    # The two weights that the paper gives.
    assert (PAPER.effort_weight, PAPER.move_weight) == (0.1, 2.0)
    with pytest.raises(InvalidInput, match="one of tuned, paper"):
        preset("best")
    for gains in PRESETS.values():
        for kp, kd in ((gains.kp, gains.kd), (gains.kp_hold, gains.kd_hold), (gains.kp_far, gains.kd_far)):
            assert kd * 2.0 + kp * 2.0 < 2.0


@pytest.mark.parametrize("name", [item.name for item in fields(Gains)])
def test_gains_reject_bad_values(name: str) -> None:
    for bad in (-1.0, math.nan, math.inf, "0.1", True):
        with pytest.raises(InvalidInput, match=name):
            replace(TUNED, **{name: bad})
