"""The state box that a Hamilton-Jacobi grid must cover, and warnings about a too coarse spacing.

State order (x, y, vx, vy) in the frame of the settings, metres and m/s. If the box cuts the motion off, no better
scheme can repair the answer: in the body frame a start at rest in LVLH moves round a whole circle at speed omega_t r;
in LVLH a start at rest in the body frame flies off at that speed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from safestart.attitude.body_frame import transport
from safestart.engines.base import Problem
from safestart.engines.hj.frame import Frame, coefficients
from safestart.engines.hj.settings import Settings, Shape
from safestart.engines.region import start_velocity
from safestart.errors import invalid
from safestart.model.scenario import Floats, SetKind

CFL_NUMBER = 0.75
# Compared with steps of an eighth of a cell, half a cell changes margins by at most 1.8 m, a whole cell by 3.3 m and no
# limit by 7.6 m (41 x 41 x 15 x 15, spacing 17.6 m, 40 s, 3 to 10 deg/s), and the mask by at most one cell.
TURN_CELLS = 0.5
MAX_STEPS = 200_000
MIN_SPEED = 1e-3


@dataclass(frozen=True, slots=True)
class Domain:
    """Symmetric box: ``half`` (4,) half widths of (x, y, vx, vy) in m and m/s.

    ``padded_for`` is the time in seconds of full thrust that the padding allows for.
    """

    half: Floats
    padded_for: float

    def spacing(self, shape: Shape) -> Floats:
        """Node spacing (4,) in m and m/s."""
        return 2.0 * self.half / (np.array(shape) - 1.0)

    def axes(self, shape: Shape) -> list[Floats]:
        """Node coordinates of the four axes."""
        return [np.linspace(-half, half, count) for half, count in zip(self.half, shape, strict=True)]


def start_states(problem: Problem, frame: Frame) -> Floats:
    """States (ny, nx, 4) of the grid's starts at t = 0, where the frames' axes coincide.

    LVLH velocity is 0 (LVLH rest) or omega x p (body rest, eq. 5); the body frame's is less by omega x p.
    """
    points = problem.points()
    velocity = points @ start_velocity(problem.scenario, problem.rest).T
    if frame is Frame.BODY:
        velocity -= transport(points, problem.scenario.target.tumble_rate)
    return np.concatenate([points, velocity], axis=-1)


def size_domain(problem: Problem, frame: Frame) -> Domain:
    """Box with room for T' = min(T, sqrt(r / a_max)) of full thrust.

    r is the radius of the farthest start. Half widths are r + a T'^2 / 2 and omega_t r + a T' in the body frame;
    in LVLH, with s the speed of the fastest start and n the mean motion, r + s T' + a T'^2 / 2 and s + a T', both plus
    the effect of the gravity gradient 3 n^2 x. Beyond sqrt(r / a_max), when thrust alone moves the chaser by r / 2, the
    coarser spacing of a wider box costs more than its padding gains.
    """
    states = start_states(problem, frame)
    a = problem.scenario.chaser.max_acceleration
    radius = _radius(states)
    time = min(problem.horizon, math.sqrt(radius / a))
    position = radius + 0.5 * a * time * time
    if frame is Frame.BODY:
        speed = problem.scenario.target.tumble_rate * radius + a * time
    else:
        start = float(np.hypot(states[..., 2], states[..., 3]).max())
        position += start * time
        # The Coriolis term turns velocities but never lengthens them.
        pull = coefficients(problem.scenario.target, frame).gx * position
        position += 0.5 * pull * time * time
        speed = start + (a + pull) * time
    speed = max(speed, MIN_SPEED)
    return Domain(np.array([position, position, speed, speed]), time)


def _radius(states: Floats) -> float:
    return float(np.hypot(states[..., 0], states[..., 1]).max())


def _rates(problem: Problem, domain: Domain, frame: Frame) -> Floats:
    """Largest |dx/dt| per axis over the box, (4,), for the Lax-Friedrichs dissipation and the CFL bound."""
    turn, gx, gy = coefficients(problem.scenario.target, frame)
    x, y, vx, vy = domain.half
    a = problem.scenario.chaser.max_acceleration
    return np.array([vx, vy, turn * vy + gx * x + a, turn * vx + gy * y + a])


def count_steps(problem: Problem, domain: Domain, settings: Settings) -> tuple[int, float]:
    """Time steps over the horizon and their CFL number.

    The CFL number is 0.75, or less if a tube's target turns: at the farthest start it may move by ``TURN_CELLS`` cells
    per step, since a step sees it only at its end. Raises ``InvalidInput`` for too many steps.
    """
    spacing = domain.spacing(settings.shape)
    rate = float((_rates(problem, domain, settings.frame) / spacing).sum())
    courant = CFL_NUMBER
    if settings.frame is Frame.LVLH and problem.kind is SetKind.TUBE:
        sweep = problem.scenario.target.tumble_rate * _radius(start_states(problem, settings.frame))
        if sweep > 0.0:
            courant = min(courant, rate * TURN_CELLS * float(spacing[:2].min()) / sweep)
    steps = max(1, math.ceil(problem.horizon * rate / courant))
    if steps > MAX_STEPS:
        raise invalid(
            "hamilton_jacobi",
            f"a grid and horizon that need at most {MAX_STEPS} time steps",
            f"spacing {spacing.tolist()} over {problem.horizon:g} s: {steps} steps",
        )
    return steps, courant


def warnings(problem: Problem, domain: Domain, settings: Settings) -> list[str]:
    """Warnings where the grid is too coarse for a meaningful answer; empty when nothing is wrong.

    Thresholds from runs against the exact set: with less than two velocity cells of control authority the
    fixed-time set loses half its cells, and first-order dissipation spreads the value by
    sqrt(alpha dv T), which should stay within the box.
    """
    spacing, rates = domain.spacing(settings.shape), _rates(problem, domain, settings.frame)
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
    # Diffusion a dv / 2 of the velocity, integrated twice; measured margins were low by up to this.
    blur = math.sqrt(a * max(spacing[2], spacing[3]) * horizon**3 / 3.0)
    if settings.accuracy == "low" and blur > 0.125 * a * horizon**2:
        found.append(
            f"first-order dissipation blurs positions by some {blur:.2g} m where thrust moves the chaser by "
            f"{0.5 * a * horizon**2:.2g} m: starts near the edge of the set are lost; take a higher accuracy"
        )
    smear = float(np.sqrt(rates[2:] * spacing[2:] * horizon).max() / domain.half[2:].min())
    if settings.accuracy == "low" and smear > 1.0:
        found.append(
            f"first-order dissipation spreads the value over {smear:.2g} half widths of the velocity axes"
        )
    if domain.padded_for < horizon:
        found.append(
            f"the box allows for {domain.padded_for:.3g} s of thrust, not {horizon:g} s: starts that need a "
            "longer way out are cut off"
        )
    return found
