"""The proof in NumPy: beside the compiled prover, against flights within the errors, and mutated."""

import math

import numpy as np
import pytest

from safestart.dynamics.cwh import transition_matrix
from safestart.hopping.approach import approach, mean_motion_of
from safestart.hopping_safety import quick_proof
from safestart.hopping_safety.fan import drifts_of, worst_drift
from safestart.hopping_safety.quick_proof import error_level, hop_bounds, position_rows
from safestart.missed_burn.plan import Errors, Plan, Question
from safestart.missed_burn.prove import greatest_scale, prove

N = mean_motion_of(8.1e6)
HORIZON = 2.0 * math.tau / N
SIGMA = Errors((0.5, 0.5, 0.5), (1e-3, 1e-3, 1e-3), 0.01, math.radians(0.5))


def plan_at(angle: float):
    return approach(N, angle, 2000.0, 100.0, 5)


def question_of(plan, errors: Errors = SIGMA) -> Question:
    flight = Plan.of(N, plan.states()[0].tolist(), plan.times[:-1].tolist(), plan.impulses[:-1])
    return Question(flight, 50.0, HORIZON, errors)


def test_the_rows_are_those_of_the_motion() -> None:
    times = np.array([0.0, 1.0, 900.0, HORIZON])
    for t, rows in zip(times, position_rows(N, times), strict=True):
        assert rows == pytest.approx(transition_matrix(N, float(t))[:3], rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("angle", [0.0, 1.0, 20.0, 40.0, 90.0, 130.0, 145.0, 180.0])
def test_it_says_what_the_compiled_prover_says(angle: float) -> None:
    plan = plan_at(angle)
    question = question_of(plan)
    found = [finding for finding in prove(question).findings if finding.case.kind == "made"]
    quick = hop_bounds(plan, 50.0, HORIZON, SIGMA)
    for one, other in zip(quick, found, strict=True):
        assert one.least <= other.nearest + 1e-6, "no bound above a member's distance"
        assert one.least >= 0.998 * other.least - 0.1
        assert one.nearest >= other.least - 1e-6
    assert error_level(plan, 50.0, HORIZON, SIGMA) == pytest.approx(greatest_scale(question), rel=0.01)


@pytest.mark.parametrize("angle", [0.0, 40.0, 130.0])
def test_no_flight_within_the_errors_comes_nearer_and_the_worst_nearly_as_near(angle: float) -> None:
    plan, rng = plan_at(angle), np.random.default_rng(3)
    matrices = position_rows(N, np.linspace(0.0, HORIZON, 700))
    for k, bounds in enumerate(hop_bounds(plan, 50.0, HORIZON, SIGMA)):
        half = np.array([0.5, 0.5, 0.5, 1e-3, 1e-3, 1e-3])
        states = plan.states()[k] + rng.uniform(-1.0, 1.0, (300, 6)) * half
        impulse = plan.impulses[k]
        angles = rng.uniform(-SIGMA.thrust_angle, SIGMA.thrust_angle, 300)
        turned = np.stack(
            [
                np.cos(angles) * impulse[0] - np.sin(angles) * impulse[1],
                np.sin(angles) * impulse[0] + np.cos(angles) * impulse[1],
                np.zeros(300),
            ],
            axis=1,
        )
        states[:, 3:] += turned * rng.uniform(0.99, 1.01, (300, 1))
        flown = np.linalg.norm(matrices @ states.T, axis=1).min()
        worst, near = worst_drift(plan, k, SIGMA, HORIZON, bounds.when, bounds.towards)
        assert bounds.least <= min(flown, near)
        assert near <= flown + 0.5
        assert near <= 1.001 * bounds.least + 0.2, "a flight shows that the bound is sharp"
        assert _within(plan, k, worst)
        assert all(_within(plan, k, state) for state in drifts_of(plan, k, SIGMA))


def _within(plan, k: int, state) -> bool:
    """Whether some admissible navigation error and burn give this state."""
    off = state - plan.states()[k]
    if (np.abs(off[:3]) > 0.5 + 1e-9).any():
        return False
    impulse = plan.impulses[k]
    # The nearest point of the box of velocities to a burn within its cone and share: tried over a grid of burns.
    size = np.linalg.norm(impulse)
    for share in np.linspace(0.99, 1.01, 41):
        for angle in np.linspace(-SIGMA.thrust_angle, SIGMA.thrust_angle, 41):
            c, s = math.cos(angle), math.sin(angle)
            burn = share * np.array([c * impulse[0] - s * impulse[1], s * impulse[0] + c * impulse[1], 0.0])
            if (np.abs(off[3:] - burn) <= 1e-3 + 1e-3 * size).all():
                return True
    return False


def test_errors_of_nothing_leave_the_planned_drift() -> None:
    plan, none = plan_at(40.0), Errors()
    matrices = position_rows(N, np.linspace(0.0, HORIZON, 20_001))
    for bounds, hop in zip(hop_bounds(plan, 50.0, HORIZON, none), plan.hops, strict=True):
        true = np.linalg.norm(matrices @ hop.left_with, axis=1).min()
        assert true - 0.1 <= bounds.least <= true


def test_without_the_bend_between_samples_it_would_be_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    """On coarse grids every bound stays below the truth; without the remainder some do not."""
    fine = position_rows(N, np.linspace(0.0, HORIZON, 20_001))
    plans = [plan_at(angle) for angle in (0.0, 20.0, 60.0, 90.0, 130.0)]
    true = [[np.linalg.norm(fine @ hop.left_with, axis=1).min() for hop in plan.hops] for plan in plans]
    monkeypatch.setattr(quick_proof, "_ROUNDS", 0)

    def excess() -> float:
        """The most by which a bound exceeds the truth, m."""
        found = []
        for grid in (5, 7, 9):
            monkeypatch.setattr(quick_proof, "_PER_ORBIT", grid)
            for plan, least in zip(plans, true, strict=True):
                bounds = hop_bounds(plan, 50.0, HORIZON, Errors())
                found += [one.least - known for one, known in zip(bounds, least, strict=True)]
        return max(found)

    assert excess() <= 1e-6
    flat = np.zeros((0, 6))
    monkeypatch.setattr(quick_proof, "_bends", lambda n, d: (np.resize(flat, (len(d), 6)),) * 2)
    assert excess() > 1.0


def test_without_the_direction_of_thrust_it_would_be_wrong() -> None:
    """The term counts: flights with the thrust off by its angle come nearer than a bound without it."""
    plan, blind = plan_at(90.0), Errors(SIGMA.position, SIGMA.velocity, SIGMA.thrust_share, 0.0)
    wide = Errors(SIGMA.position, SIGMA.velocity, SIGMA.thrust_share, math.radians(5.0))
    bounds = hop_bounds(plan, 50.0, HORIZON, wide)[-1]
    _, near = worst_drift(plan, 4, wide, HORIZON, bounds.when, bounds.towards)
    assert bounds.least <= near < hop_bounds(plan, 50.0, HORIZON, blind)[-1].least
