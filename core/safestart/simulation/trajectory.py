"""One flight with its whole history, for plots and for comparison with other solvers."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from safestart.attitude.body_frame import transport
from safestart.constraints.corridor import corridor_of
from safestart.control.forecast import SUBSTEPS, flight_plan
from safestart.control.gains import TUNED, Gains
from safestart.control.regimes import REGIMES
from safestart.errors import invalid
from safestart.model.scenario import Bools, Floats, Rest, Scenario
from safestart.simulation.compiled_loop import SUB_STEPPED, roll_out
from safestart.simulation.truth import NO_DRAWS


@dataclass(frozen=True, slots=True)
class Trajectory:
    """A flight at its S + 1 checked instants (start included) and K control steps.

    ``times`` (S+1,) s; ``states`` (S+1, 6) LVLH, m and m/s; ``body`` (S+1, 3) body-frame positions, m; ``slacks``
    (S+1, F) distances to the faces, m (F = 3 in the plane, 5 in space), negative outside. ``commands`` (K, 3)
    m/s^2, each held for ``dt``; ``regimes`` (K,) names; ``feasible`` (K,) whether (7) was. The flight ends at its
    first violation.
    """

    times: Floats
    states: Floats
    body: Floats
    slacks: Floats
    commands: Floats
    regimes: tuple[str, ...]
    feasible: Bools
    dt: float
    safe: bool
    margin: float
    delta_v: float


def start_states(scenario: Scenario, positions: Floats, rest: Rest) -> Floats:
    """LVLH states (M, 6) of chasers at rest in LVLH or in the body frame at ``positions`` (M, 2 or 3), metres.

    At t = 0 the frames coincide; a chaser at rest in the body frame moves with omega x r (eq. 5).
    """
    positions = np.asarray(positions, dtype=np.float64)
    if positions.ndim != 2 or positions.shape[1] not in (2, 3):
        raise invalid("positions", "an array of shape (M, 2) or (M, 3), metres", positions.shape)
    states = np.zeros((len(positions), 6))
    states[:, : positions.shape[1]] = positions
    if rest is Rest.BODY:
        states[:, 3:] = transport(states[:, :3], scenario.target.tumble_rate)
    return states


def fly_start(
    scenario: Scenario,
    position: Floats,
    *,
    rest: Rest = Rest.LVLH,
    gains: Gains = TUNED,
    t_sim: float = 60.0,
    dt: float = 2.0,
    nodes: int = 6,
) -> Trajectory:
    """Fly one start at rest at body-frame ``position`` (2,) or (3,), metres, for ``t_sim`` seconds or to a violation.

    A position of two coordinates, or with z = 0, is flown in the plane. Raises ``InvalidInput`` for positions or times
    that are not finite, or out of range.
    """
    position = np.asarray(position, dtype=np.float64)
    if position.shape not in ((2,), (3,)) or not np.isfinite(position).all():
        raise invalid("position", "2 or 3 finite coordinates, metres", position)
    planar = len(position) == 2 or position[2] == 0.0
    start = start_states(scenario, position[None], rest)
    plan = flight_plan(scenario, gains, dt, steps_of(t_sim, dt), nodes=nodes, planar=planar)
    steps = len(plan.normals)
    counts, sums = np.empty((1, 3), np.int64), np.empty((1, 4))
    states = np.full((steps * SUBSTEPS, 6), np.nan)
    commands, codes = np.empty((steps, 3)), np.empty((steps, 2), np.int64)
    roll_out(plan, SUB_STEPPED, NO_DRAWS, start, counts, sums, states, commands, codes)
    flown = int(counts[0, 0])
    states = np.concatenate([start, states[~np.isnan(states[:, 0])]])
    times: Floats = np.arange(len(states), dtype=np.float64) * (dt / SUBSTEPS)
    angle = scenario.target.tumble_rate * times
    cos, sin = np.cos(angle), np.sin(angle)
    body = np.stack(
        [
            cos * states[:, 0] + sin * states[:, 1],
            cos * states[:, 1] - sin * states[:, 0],
            states[:, 2],
        ],
        axis=-1,
    )
    corridor = corridor_of(scenario.corridor, 2 if planar else 3)
    return Trajectory(
        times,
        states,
        body,
        corridor.slack(body[:, : 2 if planar else 3]) / corridor.lengths,
        commands[:flown],
        tuple(REGIMES[code] for code in codes[:flown, 0]),
        codes[:flown, 1] != 0,
        dt,
        bool(counts[0, 2] and sums[0, 0] >= 0.0),
        float(sums[0, 0]),
        float(sums[0, 1]),
    )


def steps_of(t_sim: float, dt: float) -> int:
    """Number of control steps that cover ``t_sim`` seconds: the flight ends at the first node at or after it.

    Raises ``InvalidInput`` unless both are positive and finite.
    """
    for name, value in (("t_sim", t_sim), ("dt", dt)):
        if not (math.isfinite(value) and value > 0.0):
            raise invalid(name, "a time of more than 0 s", value)
    return max(1, math.ceil(t_sim / dt - 1e-9))
