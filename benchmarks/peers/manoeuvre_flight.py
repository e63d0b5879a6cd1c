"""Flights of a manoeuvre that share nothing with it: CWH written out, integrated by DOP853 from the start at rest."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from safestart.closed_form.manoeuvre import Manoeuvre
from safestart.model.scenario import Floats, Rest, Scenario


@dataclass(frozen=True)
class Flown:
    """Least distance to a face (m), largest thrust over a_max, distance (m) and speed (m/s) from the planned end."""

    least: float
    thrust: float
    off: float
    drift: float


def distances(scenario: Scenario, places: Floats, dimensions: int) -> Floats:
    """Distance of body-frame ``places`` (T, 3) to each face, (T, F), from the paper's inequalities scalar by scalar."""
    shape = scenario.corridor
    x, y, z = places.T
    side = (shape.x0 + shape.c_x * (y - shape.hold_radius) - np.abs(x)) / math.hypot(1.0, shape.c_x)
    top = (shape.z0 + shape.c_z * (y - shape.hold_radius) - np.abs(z)) / math.hypot(1.0, shape.c_z)
    rows = [y - shape.hold_radius, side]
    return np.stack(rows + [top] * (dimensions == 3), axis=-1)


def fly(
    scenario: Scenario,
    rest: Rest,
    point: Floats,
    plan: Manoeuvre,
    after: float,
    samples: int = 400,
    tolerance: float = 1e-10,
    velocity: Floats | None = None,
) -> Flown:
    """Fly ``plan``'s thrust open loop in LVLH from ``point`` at rest, and for ``after`` seconds beyond its end.

    ``velocity`` (3,), m/s in LVLH, stands in the place of the rest.
    ``samples`` of each part are looked at; ``tolerance`` is the integrator's, relative and, times 10, in metres.
    """
    n, w = scenario.target.mean_motion, scenario.target.tumble_rate
    place = np.zeros(3)
    place[: len(point)] = point
    if velocity is None:
        velocity = w * np.array([-place[1], place[0], 0.0]) if rest is Rest.BODY else np.zeros(3)

    def rate(t: float, s: Floats) -> Floats:
        ux, uy, uz = plan.thrust_lvlh(np.array([t]))[0]
        x, _, z, vx, vy, vz = s
        return np.array(
            [vx, vy, vz, 3.0 * n * n * x + 2.0 * n * vy + ux, -2.0 * n * vx + uy, -n * n * z + uz]
        )

    state, places, times = np.concatenate([place, velocity]), [], []
    # In two parts: the thrust jumps where the curve ends.
    legs = [(0.0, plan.duration), (plan.duration, plan.duration + after)]
    for begin, end in legs:
        if end <= begin:
            continue
        nudge = 1e-12 * (end - begin) if begin > 0.0 else 0.0
        grid = np.linspace(begin + nudge, end, samples)
        out = solve_ivp(
            rate, (grid[0], grid[-1]), state, "DOP853", grid, rtol=tolerance, atol=10.0 * tolerance
        )
        assert out.success
        state = out.y[:, -1]
        places.append(out.y[:3].T)
        times.append(grid)
    t, r = np.concatenate(times), np.concatenate(places)
    c, s = np.cos(w * t), np.sin(w * t)
    body = np.stack([c * r[:, 0] + s * r[:, 1], c * r[:, 1] - s * r[:, 0], r[:, 2]], axis=-1)
    thrust = np.sqrt((plan.thrust(t) ** 2).sum(axis=-1)).max() / scenario.chaser.max_acceleration
    x, y, _, vx, vy, vz = state
    still = np.array([vx + w * y, vy - w * x, vz])
    return Flown(
        float(distances(scenario, body, len(point)).min()),
        float(thrust),
        float(np.linalg.norm(body[-1] - plan.start - plan.away[-1])),
        float(np.linalg.norm(still)),
    )
