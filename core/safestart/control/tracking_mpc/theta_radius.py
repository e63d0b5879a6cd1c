"""The distance from the target up to which the input suffices to stay on an equilibrium, for every attitude.

``printed`` is paper 002, (35)-(41): it omits the centripetal term and is NOT safe near spins about a principal axis.
``ball`` bounds u_e(k) = P r(k+2) + Q r(k+1) + R r(k) by Taylor's formula about the middle position: with
|r'| <= Omega |theta| and |r''| <= alpha |theta|, alpha = Omega^2 + max |omega dot|,

    |u_e| <= (|P + Q + R| + T |P - R| Omega + T^2 (|P| + |R|) alpha / 2) |theta|.

``bracket`` encloses the exact maximum over all phases of the polhode and all attitudes in which LVLH may see it. With
held thrust ``ball`` is the lower end of the bracket.
"""

from __future__ import annotations

import math

import numpy as np

from safestart.control.tracking_mpc.sampled import Sampled
from safestart.control.tracking_mpc.tumble import Tumble
from safestart.control.tracking_mpc.tuning import InputLimit
from safestart.model.scenario import Floats

_PHASES = 20_000
_ATTITUDES = 400
_KEPT = 60


def printed_radius(tumble: Tumble, motion: Sampled, u_max: float) -> float:
    """theta_max of paper 002, (39) and (41), m: block row norms, radii 1, h / I_min and sqrt(varpi) T; inf at rest."""
    a, period, p = motion.a, motion.period, motion.p
    rest, vv = np.eye(3) - a[:3, :3], a[3:, 3:]
    blocks = (
        p @ rest - vv @ p @ rest - a[3:, :3],
        period * (p @ rest - vv @ p + p),
        period * p,
    )
    moments, squares = tumble.principal()
    momentum = float(np.sqrt((moments**2 * squares).sum()))
    double_energy = float((moments * squares).sum())
    most = 0.0
    for i in range(3):
        for j in range(3):
            if i != j:
                left = momentum**2 - moments[i] * double_energy
                right = momentum**2 - moments[j] * double_energy
                scale = (moments[i] + moments[j]) ** 2 / (moments[i] * moments[j]) ** 3
                most = max(most, -scale * left * right)
    radii = (1.0, momentum / float(moments[0]), math.sqrt(most) * period)
    need = sum(r * np.linalg.norm(block, axis=1) for r, block in zip(radii, blocks, strict=True))
    worst = float(np.max(need))
    return u_max / worst if worst > 0.0 else math.inf


def ball_radius(tumble: Tumble, motion: Sampled, u_max: float) -> float:
    """A radius, m, within which |u_e| <= u_max at all times and attitudes (rigorous); inf if no input is needed."""
    if motion.held:
        return bracket(tumble, motion, u_max, "ball")[0]
    omega, alpha = _seen_rates(tumble)
    p, q, r, period = motion.p, motion.q, motion.r, motion.period
    need = (
        _norm(p + q + r)
        + period * _norm(p - r) * omega
        + 0.5 * period**2 * (_norm(p) + _norm(r)) * (omega**2 + alpha)
    )
    return u_max / need if need > 0.0 else math.inf


def bracket(tumble: Tumble, motion: Sampled, u_max: float, limit: InputLimit = "box") -> tuple[float, float]:
    """(low, high), m: the exact theta_max over all phases and attitudes lies between them; infinite where it is.

    theta's input is the sum over j of C U_j R_j C' D_j' with U_j the constants of u_e = sum U_j r(k+j), D_j the body's
    own turn over j steps, R_j that of LVLH and C any attitude. The part of U_j that is a multiple of the identity,
    about (1, -2, 1) / T, is the same for every C; it is taken at 20 000 phases, with a Lipschitz bound between them
    (|dD_j/dt| <= j T max |omega dot|). The rest is bounded by norms for ``low`` and sampled for ``high``.
    """
    period, body = motion.period, tumble.body
    omega, change = tumble.rates()
    omega, change = omega * (1.0 + 1e-12), change * (1.0 + 1e-12)
    times = body.polhode_period() * np.arange(_PHASES if omega > 0.0 else 1) / _PHASES
    shares = np.convolve([1.0, -2.0, 1.0], motion.weights) / period
    constants = _constants(motion)
    steps = np.arange(len(shares))
    turns = [body.turn_back(times, j * period) for j in steps[1:]]
    steady = sum(
        (w * turn for w, turn in zip(shares[1:], turns, strict=True)),
        np.tile(shares[0] * np.eye(3), (len(times), 1, 1)),
    )
    needs = _largest(steady, limit)
    gap = (
        0.5 * (times[1] - times[0]) * float(np.abs(shares) @ steps) * period * change
        if len(times) > 1
        else 0.0
    )
    moved = [matrix @ tumble.frame_turn(j * period) for j, matrix in enumerate(constants)]
    left = [matrix - w * np.eye(3) for matrix, w in zip(moved, shares, strict=True)]
    # Taylor's formula about the middle of the three positions that impulses need.
    span = period * (steps - 1.0)
    most = (
        float(needs.max())
        + gap
        + _norm(sum(left, np.zeros((3, 3))))
        + _norm(sum((t * m for t, m in zip(span, left, strict=True)), np.zeros((3, 3)))) * omega
        + 0.5 * sum(t * t * _norm(m) for t, m in zip(span, left, strict=True)) * (omega**2 + change)
    )
    worst = np.argsort(needs)[-_KEPT:]
    frames = _attitudes()
    seen = [frames @ matrix @ frames.swapaxes(1, 2) for matrix in moved]
    found = 0.0
    for index in worst.tolist():
        maps = sum((one @ turn[index] for one, turn in zip(seen[1:], turns, strict=True)), seen[0])
        found = max(found, float(_largest(maps, limit).max()))
    low = u_max / most if most > 0.0 else math.inf
    return low, (u_max / found if found > 0.0 else math.inf)


def _constants(motion: Sampled) -> list[Floats]:
    """U_j: u_e(k) = sum U_j r(k+j), LVLH."""
    out = [np.zeros((3, 3)) for _ in range(len(motion.weights) + 2)]
    for j, matrix in enumerate((motion.r, motion.q, motion.p)):
        for i, weight in enumerate(motion.weights):
            out[i + j] += weight * matrix
    return out


def _largest(maps: Floats, limit: InputLimit) -> Floats:
    """(K,): largest input per m of |theta| for ``maps`` (K, 3, 3): a component in a box, the length in a ball."""
    if limit == "box":
        rows: Floats = np.linalg.norm(maps, axis=2).max(axis=1)
        return rows
    out: Floats = np.linalg.norm(maps, 2, axis=(1, 2))
    return out


def _seen_rates(tumble: Tumble) -> tuple[float, float]:
    """Bounds on |omega| and |omega dot| against LVLH: those of the body, plus LVLH's own if included."""
    omega, change = tumble.rates()
    if tumble.reference == "lvlh":
        return omega, change
    return omega + tumble.mean_motion, change + omega * tumble.mean_motion


def _attitudes() -> Floats:
    """(A, 3, 3): rotations spread over all attitudes, the same every time."""
    units = np.random.default_rng(2).normal(size=(_ATTITUDES, 4))
    w, x, y, z = (units / np.linalg.norm(units, axis=1, keepdims=True)).T
    # Not quaternion.matrix_of, whose last bits differ: the bracket's upper end is a maximum over exactly these.
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    ).transpose(2, 0, 1)


def _norm(matrix: Floats) -> float:
    return float(np.linalg.norm(matrix, 2))
