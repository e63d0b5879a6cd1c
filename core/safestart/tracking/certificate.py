"""What a plan guarantees: candidates for all later steps, the cost's decrease, and errors of the target's model.

**Recursive feasibility.** A plan is also one for the next step: the same theta, the regulator one step longer, then
dead-beat. With the deviation e_i = F^i e_0 of the regulator, the candidate j steps later keeps all rows if the
regulator's hold at every node, and the dead-beat's from node N + j on. They are evaluated for j <= J. After that |e|_S
never grows (F'SF - S = -I), so nothing is off theta's own rows by more than ``beyond``. Theta's own rows hold in the
window of the program, and for ever where |theta| is inside the radius proved for all attitudes.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_discrete_lyapunov

from safestart.control.tracking_mpc import equilibrium
from safestart.control.tracking_mpc.controller import Plan, Program
from safestart.control.tracking_mpc.tumble import Tumble
from safestart.model.scenario import Floats
from safestart.tracking.flight import TrackedFlight

TOLERANCE = 1e-9
"""Rows may be overstepped by so much, m or m/s: the port lies on two of them."""
_LONGEST = 2000
OUTSIDE = 0.01
"""Metres outside the corridor at which an error in the target's model is said to break the verdict."""


@dataclass(frozen=True)
class Recursion:
    """``holds``: candidates exist for every later step; ``corridor`` m and ``inputs`` m/s: the least slacks.

    ``beyond``, m or m/s: bound on what later candidates can be off; ``shifts``: how many were evaluated one by one.
    """

    holds: bool
    corridor: float
    inputs: float
    beyond: float
    shifts: int


def shifts_needed(closed: Floats) -> int:
    """How many steps of a closed loop (6, 6) leave about 1e-12 of a deviation, at most 2000."""
    pace = float(np.abs(np.linalg.eigvals(closed)).max())
    return min(_LONGEST, math.ceil(math.log(1e-12) / math.log(pace)))


def recursion(program: Program, attitudes: Floats, plan: Plan, shifts: int) -> Recursion:
    """Certify one plan; ``attitudes`` (>= N_p + shifts + 2 + weights of the motion, 3, 3) from its step on."""
    motion, tuning, faces = program.motion, program.tuning, program.faces
    n_c, n_lqr = tuning.n_c, tuning.n_lqr
    frames = attitudes[n_c:]
    count = n_lqr + shifts + 1
    seen = frames[: count + 1 + motion.ahead]
    targets = equilibrium.states(motion, seen) @ plan.theta
    held = equilibrium.inputs(motion, seen) @ plan.theta
    spots = equilibrium.places(motion, seen) @ plan.theta
    sides, most = tuning.sides
    deviation = np.empty((count, 6))
    deviation[0] = plan.states[n_c] - targets[0]
    for i in range(1, count):
        deviation[i] = program.condensed.closed @ deviation[i - 1]
    last = motion.dead_beat()
    pushes = deviation @ program.condensed.gain.T
    late = deviation[n_lqr:]
    first = late @ last.T
    after = late @ motion.a.T + first @ motion.b.T
    second = after @ last.T

    def body(vectors: Floats, at: int) -> Floats:
        out: Floats = np.einsum("kij,kj->ki", frames[at : at + len(vectors)], vectors)
        return out

    places = [
        spots[:count] + body(deviation[:, :3], 0),
        spots[n_lqr + 1 : n_lqr + 1 + len(after)] + body(after[:, :3], n_lqr + 1),
    ]
    given = [
        held[:count] + body(pushes, 0),
        held[n_lqr : n_lqr + len(first)] + body(first, n_lqr),
        held[n_lqr + 1 : n_lqr + 1 + len(second)] + body(second, n_lqr + 1),
    ]
    corridor = min(float(faces.slack(place).min()) for place in places)
    inputs = most - max(float(np.abs(push @ sides.T).max()) for push in given)
    beyond = _beyond(program, deviation[-1], last)
    holds = corridor >= -TOLERANCE and inputs >= -TOLERANCE and beyond <= TOLERANCE
    return Recursion(holds, corridor, inputs, beyond, shifts)


def _beyond(program: Program, deviation: Floats, last: Floats) -> float:
    """Bound on every position, regulator and dead-beat input of deviations that follow ``deviation`` (6,)."""
    closed = program.condensed.closed
    form = solve_discrete_lyapunov(closed.T, np.eye(6))
    values = np.linalg.eigvalsh(form)
    size = math.sqrt(float(deviation @ form @ deviation) / float(values[0]))
    dead = program.motion.a + program.motion.b @ last
    gains = (np.eye(6), program.condensed.gain, last, dead, last @ dead)
    return size * max(float(np.linalg.norm(gain, 2)) for gain in gains)


def cost_decrease(program: Program, attitudes: Floats, flight: TrackedFlight) -> float:
    """Largest (V(k+1) - V(k) + stage cost) / V(k) over the steps; at most 0 where the cost falls as promised."""
    worst = -np.inf
    for k, (plan, after) in enumerate(itertools.pairwise(flight.plans)):
        seen = attitudes[k : k + program.motion.ahead]
        target = equilibrium.states(program.motion, seen)[0] @ plan.theta
        held = equilibrium.inputs(program.motion, seen)[0] @ plan.theta
        stage = float(((plan.states[0] - target) ** 2).sum())
        stage += program.tuning.rho * float(((plan.inputs[0] - held) ** 2).sum())
        if plan.cost > 1e-12:
            worst = max(worst, (after.cost - plan.cost + stage) / plan.cost)
    return worst


def holds_until(
    program: Program, tumble: Tumble, flight: TrackedFlight, inertia_error: float, spin_error: float
) -> float:
    """Seconds for which the flown path stays within 1 cm of the corridor of every body of an ensemble.

    Each principal moment is off by +-``inertia_error`` and the rate by +-``spin_error`` (shares), in all combinations.
    A sampled statement, not a proof.
    """
    first = len(flight.states)
    for signs in itertools.product((-1.0, 1.0), repeat=3):
        for spin in (1.0 - spin_error, 1.0 + spin_error):
            other = tumble.changed(inertia_error * np.array(signs), spin)
            frames = other.nodes(program.motion.period, len(flight.states))
            slack = program.faces.slack(np.einsum("kij,kj->ki", frames, flight.states[:, :3])).min(axis=1)
            outside = np.nonzero(slack < -OUTSIDE)[0]
            first = min(first, int(outside[0]) if len(outside) else first)
    return (first - 1) * program.motion.period
