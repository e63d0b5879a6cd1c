"""The state box a Hamilton-Jacobi grid has to cover, and when its spacing is too coarse to mean anything.

State order (x, y, vx, vy) in the body frame, metres and m/s. A box that cuts the motion off ruins the answer
beyond what a better scheme can repair: a start at rest in LVLH runs round a whole circle in the body frame, at
speed omega_t r.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from safestart.dynamics.body_frame import transport
from safestart.engines.base import Problem
from safestart.engines.hj_settings import ENGINE, Settings, Shape
from safestart.engines.region import start_velocity
from safestart.errors import invalid
from safestart.scenario import Floats

CFL_NUMBER = 0.75
MAX_STEPS = 200_000
MIN_SPEED = 1e-3


@dataclass(frozen=True, slots=True)
class Domain:
    """Symmetric box: ``half`` (4,) half widths of (x, y, vx, vy) in m and m/s.

    ``padded_for`` is the time in seconds of full thrust that the padding allows for, None for an explicit box.
    """

    half: Floats
    padded_for: float | None

    def spacing(self, shape: Shape) -> Floats:
        """Node spacing (4,) in m and m/s."""
        return 2.0 * self.half / (np.array(shape) - 1.0)


def start_states(problem: Problem) -> Floats:
    """Body-frame states (ny, nx, 4) of the grid's starts: v_B = 0 (body rest) or -omega x p_B (LVLH rest)."""
    points = problem.points()
    velocity = points @ start_velocity(problem.scenario, problem.rest).T
    velocity -= transport(points, problem.scenario.target.tumble_rate)
    return np.concatenate([points, velocity], axis=-1)


def size_domain(problem: Problem, settings: Settings) -> Domain:
    """Box for a problem: the settings' own, or r + a T'^2 / 2 in position and omega_t r + a T' in velocity.

    r is the radius of the farthest start and T' = min(T, sqrt(r / a_max)). Past sqrt(r / a_max), when thrust
    alone moves the chaser by r / 2, a wider box loses more by its spacing than it gains by its padding.
    Raises ``InvalidInput`` when an explicit box does not hold every start.
    """
    states = start_states(problem)
    if settings.domain is not None:
        x, y, v = settings.domain
        half = np.array([x, y, v, v])
        need = np.abs(states).reshape(-1, 4).max(axis=0)
        if (need > half).any():
            wanted = {"x_m": need[0], "y_m": need[1], "v_m_s": max(need[2], need[3])}
            shown = ", ".join(f"{name} >= {value:.6g}" for name, value in wanted.items())
            raise invalid(
                f"options.{ENGINE}.domain", f"to hold every start: {shown}", [float(h) for h in half[:3]]
            )
        return Domain(half, None)
    return _roomy(problem)


def _roomy(problem: Problem) -> Domain:
    states = start_states(problem)
    a = problem.scenario.chaser.max_acceleration
    radius = float(np.hypot(states[..., 0], states[..., 1]).max())
    time = min(problem.horizon, math.sqrt(radius / a))
    position = radius + 0.5 * a * time * time
    speed = max(problem.scenario.target.tumble_rate * radius + a * time, MIN_SPEED)
    return Domain(np.array([position, position, speed, speed]), time)


def _rates(problem: Problem, domain: Domain) -> Floats:
    """Largest |dx/dt| per axis over the box, (4,), for the Lax-Friedrichs dissipation and the CFL bound."""
    w, n = problem.scenario.target.tumble_rate, problem.scenario.target.mean_motion
    x, y, vx, vy = domain.half
    turn, push = 2.0 * (w + n), w * w + 2.0 * n * w + 1.5 * n * n
    a = problem.scenario.chaser.max_acceleration
    return np.array([vx, vy, turn * vy + push * x + a, turn * vx + push * y + a])


def count_steps(problem: Problem, domain: Domain, shape: Shape) -> int:
    """Time steps the CFL bound asks for; raises ``InvalidInput`` when nobody would wait for them."""
    rate = float((_rates(problem, domain) / domain.spacing(shape)).sum())
    steps = max(1, math.ceil(problem.horizon * rate / CFL_NUMBER))
    if steps > MAX_STEPS:
        raise invalid(
            f"options.{ENGINE}",
            f"a grid and horizon that need at most {MAX_STEPS} time steps",
            f"spacing {domain.spacing(shape).tolist()} over {problem.horizon:g} s: {steps} steps",
        )
    return steps


def warnings(problem: Problem, domain: Domain, settings: Settings) -> list[str]:
    """Say where the grid is too coarse for its answer to mean much; empty when nothing is wrong.

    Thresholds from runs against the exact set: with less than two velocity cells of control authority the
    fixed-time set loses half its cells, and first-order dissipation spreads the value by
    sqrt(alpha dv T), which should stay within the box.
    """
    spacing, rates = domain.spacing(settings.shape), _rates(problem, domain)
    a, horizon = problem.scenario.chaser.max_acceleration, problem.horizon
    found = []
    authority = a * horizon / max(spacing[2], spacing[3])
    if authority < 2.0:
        found.append(
            f"velocity spacing {max(spacing[2], spacing[3]):.3g} m/s: thrust changes the speed by only "
            f"{authority:.2g} cells over the horizon (want at least 2)"
        )
    reach = 0.5 * a * horizon**2 / max(spacing[0], spacing[1])
    if reach < 1.0:
        found.append(
            f"position spacing {max(spacing[0], spacing[1]):.3g} m: thrust moves the chaser by only "
            f"{reach:.2g} cells over the horizon (want at least 1)"
        )
    smear = float(np.sqrt(rates[2:] * spacing[2:] * horizon).max() / domain.half[2:].min())
    if settings.accuracy == "low" and smear > 1.0:
        found.append(
            f"first-order dissipation spreads the value over {smear:.2g} half widths of the velocity axes"
        )
    roomy = _roomy(problem)
    if domain.padded_for is None and (domain.half < 0.95 * roomy.half).any():
        wanted = ", ".join(f"{half:.4g}" for half in roomy.half[:3])
        found.append(f"the box cuts the motion off: half widths of {wanted} (m, m, m/s) would not")
    if domain.padded_for is not None and domain.padded_for < horizon:
        found.append(
            f"the box allows for {domain.padded_for:.3g} s of thrust, not {horizon:g} s: starts that need a "
            "longer way out are cut off"
        )
    return found
