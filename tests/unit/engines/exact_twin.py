"""Plain NumPy twin of the exact engine: eq. (2) as printed, quadrature in time, and zooming instead of Newton.

It shares no code with the engine beyond the scenario: times x directions are sampled densely, then the best
few local maxima over time are sampled again and again on ten times finer grids.
"""

import numpy as np

from safestart.model.scenario import Floats, Rest, Scenario, SetKind

NODES, WEIGHTS = np.polynomial.legendre.leggauss(20)


def position_rows(n: float, tau: Floats) -> tuple[Floats, Floats]:
    """Phi_rr and Phi_rv in the plane, (..., 2, 2), from the printed eq. (2)."""
    one, zero = np.ones_like(tau), np.zeros_like(tau)
    if n == 0.0:
        rr, rv = [one, zero, zero, one], [tau, zero, zero, tau]
    else:
        c, s = np.cos(n * tau), np.sin(n * tau)
        rr = [4 - 3 * c, zero, 6 * (s - n * tau), one]
        rv = [s / n, 2 * (1 - c) / n, -2 * (1 - c) / n, (4 * s - 3 * n * tau) / n]
    shape = (*np.shape(tau), 2, 2)
    return np.stack(rr, -1).reshape(shape), np.stack(rv, -1).reshape(shape)


def offsets(scenario: Scenario, t: Floats, a: Floats) -> Floats:
    """S(t, a) + x0 |sin a| - r_h cos a for t (..., 1) and a (..., J)."""
    phi = 0.5 * np.pi - a + scenario.target.tumble_rate * t
    e = np.cos(phi), np.sin(phi)
    total = np.zeros(np.broadcast_shapes(np.shape(t), np.shape(a)))
    for node, weight in zip(NODES, WEIGHTS, strict=True):
        rv = position_rows(scenario.target.mean_motion, 0.5 * t * (node + 1.0))[1]
        pushed = [rv[..., 0, i] * e[0] + rv[..., 1, i] * e[1] for i in (0, 1)]
        total += weight * np.hypot(*pushed)
    shape = scenario.corridor
    reach = 0.5 * t * scenario.chaser.max_acceleration * total
    return reach + shape.x0 * np.abs(np.sin(a)) - shape.hold_radius * np.cos(a)


def drift(scenario: Scenario, rest: Rest, p: Floats, t: Floats) -> tuple[Floats, Floats]:
    """Body-axis position without thrust of starts p (..., 2) at times t (...)."""
    rr, rv = position_rows(scenario.target.mean_motion, t)
    omega = scenario.target.tumble_rate
    start = omega if rest is Rest.BODY else 0.0
    velocity = start * np.stack([-p[..., 1], p[..., 0]], -1)
    x, y = np.moveaxis((rr @ p[..., None] + rv @ velocity[..., None])[..., 0], -1, 0)
    c, s = np.cos(omega * t), np.sin(omega * t)
    return c * x + s * y, c * y - s * x


def margin_at(scenario: Scenario, rest: Rest, p: Floats, t: Floats) -> Floats:
    """Margin of starts p (P, 2) at times t (P, T), shape (P, T).

    Far inside the set there can be several local minima over the angle: four sectors are zoomed apart.
    """
    limit = np.arctan2(1.0, scenario.corridor.c_x)
    qx, qy = (q[..., None, None] for q in drift(scenario, rest, p[:, None, :], t))
    edges = np.linspace(-limit, limit, 5)
    centre, half = 0.5 * (edges[1:] + edges[:-1])[:, None], limit / 4
    a, width = np.broadcast_to(centre + half * np.linspace(-1.0, 1.0, 17), (*t.shape, 4, 17)), half / 8
    for _ in range(4):
        f = qx * np.sin(a) + qy * np.cos(a) + offsets(scenario, t[..., None, None], a)
        best = np.take_along_axis(a, f.argmin(-1)[..., None], -1)
        a = np.clip(best + width * np.linspace(-1.0, 1.0, 17), centre - half, centre + half)
        width /= 8
    return f.min((-2, -1))


def margin(
    scenario: Scenario, points: Floats, horizon: float, rest: Rest, kind: SetKind, rounds: int = 7
) -> Floats:
    """Margin (P,) of starts (P, 2), accurate to about 1e-6 m."""
    if kind is SetKind.FIXED:
        return margin_at(scenario, rest, points, np.full((len(points), 1), horizon))[:, 0]
    t = np.linspace(0.0, horizon, 241)
    limit = np.arctan2(1.0, scenario.corridor.c_x)
    a = np.linspace(-limit, limit, 49)
    extra = offsets(scenario, t[:, None], a)
    qx, qy = (q[..., None] for q in drift(scenario, rest, points[:, None, :], t[None, :]))
    coarse = (qx * np.sin(a) + qy * np.cos(a) + extra).min(-1)
    padded = np.pad(coarse, ((0, 0), (1, 1)), constant_values=-np.inf)
    peaks = (coarse >= padded[:, :-2]) & (coarse >= padded[:, 2:])
    result = np.full(len(points), -np.inf)
    order = np.argsort(np.where(peaks, coarse, -np.inf), axis=1)
    for choice in (-1, -2):
        at, width = t[order[:, choice]], t[1]
        for _ in range(rounds):
            around = np.clip(at[:, None] + width * np.linspace(-1.0, 1.0, 11), 0.0, horizon)
            now = margin_at(scenario, rest, points, around)
            at = np.take_along_axis(around, now.argmax(1)[:, None], 1)[:, 0]
            result = np.maximum(result, now.max(1))
            width /= 5
    return result
