"""A flight by another integrator, the reference for the exact answers' margins."""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import solve_ivp

from safestart.attitude.body_frame import rotation
from safestart.exact.question import Question
from safestart.model.scenario import Floats


def fly(question: Question, state: Floats, thrust: Floats) -> float:
    """Smallest margin (m) of the flight, by DOP853 on the CWH equations, thousands of samples a second near it."""
    d, scenario = question.dimensions, question.scenario
    n, w, shape = scenario.target.mean_motion, scenario.target.tumble_rate, scenario.corridor
    x = np.zeros(6)
    x[:d], x[3 : 3 + d] = state[:d], state[d:]
    lowest = math.inf
    for k, held in enumerate(thrust):
        u = np.zeros(3)
        u[:d] = held

        def rate(_t: float, y: Floats, u: Floats = u) -> list[float]:
            return [
                *y[3:],
                3 * n * n * y[0] + 2 * n * y[4] + u[0],
                -2 * n * y[3] + u[1],
                -n * n * y[2] + u[2],
            ]

        begin = k * question.dt
        flown = solve_ivp(
            rate, (0.0, question.dt), x, "DOP853", rtol=1e-12, atol=1e-12, dense_output=True, max_step=0.25
        )
        low, high, best = 0.0, question.dt, math.inf
        for _ in range(3):
            times = np.linspace(low, high, 401)
            r = flown.sol(times)[:3]
            c, s = np.cos(w * (begin + times)), np.sin(w * (begin + times))
            bx, by, bz = c * r[0] + s * r[1], c * r[1] - s * r[0], r[2]
            sides = [by - shape.hold_radius]
            for slope, width, across in ((shape.c_x, shape.x0, bx), (shape.c_z, shape.z0, bz))[: d - 1]:
                room = width + slope * (by - shape.hold_radius)
                sides += [(room - across) / math.hypot(1, slope), (room + across) / math.hypot(1, slope)]
            if question.speed_limit is not None:
                sides.append(10.0 * (question.speed_limit - np.linalg.norm(flown.sol(times)[3:], axis=0)))
            distance = np.min(sides, axis=0)
            at = int(np.argmin(distance))
            best = min(best, float(distance[at]))
            low, high = times[max(at - 1, 0)], times[min(at + 1, 400)]
        lowest = min(lowest, best)
        x = flown.y[:, -1]
    if question.goal is not None:
        goal, end = question.goal, len(thrust) * question.dt
        turn = np.eye(3)
        turn[:2, :2] = rotation(-w * end)
        hold = np.zeros(3)
        hold[:d] = question.hold
        away = np.linalg.norm(turn @ x[:3] - hold)
        # The velocity of the body frame at r is w x r.
        speed = np.linalg.norm(x[3:] - w * np.array([-x[1], x[0], 0.0]))
        lowest = min(lowest, goal.radius - away, goal.radius / goal.rest * (goal.rest - speed))
    return lowest
