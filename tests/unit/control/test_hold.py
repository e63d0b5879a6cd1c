"""The hold: its reference, its LQR, the ellipsoid and the polyhedron, from their definitions and by flights."""

from __future__ import annotations

import math

import numpy as np
import pytest

from safestart.constraints.corridor import corridor_of
from safestart.control.hold.ellipsoid import ellipsoid
from safestart.control.hold.hold_lqr import Design
from safestart.control.hold.loop import Hold
from safestart.control.hold.polyhedron import polyhedron
from safestart.control.hold.turning_reference import TurningReference
from safestart.dynamics.cwh import planar_input, planar_transition
from safestart.errors import InvalidInput
from safestart.model.scenario import CorridorShape, Floats

N, STEP = 1.1e-3, 2.0


def hold_of(rate_deg: float, most: float, point: Floats, step: float = STEP) -> Hold:
    design = Design.of(N, step, 1.0, 0.1, most)
    reference = TurningReference.of(point, math.radians(rate_deg), N, step)
    return Hold.of(design, reference, corridor_of(CorridorShape()), most)


def body(angle: float, place: Floats) -> Floats:
    turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    return turn @ place


@pytest.mark.parametrize("rate_deg", [0.0, 1.0, 5.0, 20.0])
def test_the_reference_is_at_the_hold_point_at_every_node(rate_deg: float) -> None:
    point = np.array([0.4, 3.0])
    reference = TurningReference.of(point, math.radians(rate_deg), N, STEP)
    a, b = planar_transition(N, STEP), planar_input(N, STEP)
    state, _ = reference.at(0.7)
    for k in range(60):
        angle = 0.7 + math.radians(rate_deg) * STEP * k
        _, thrust = reference.at(angle)
        assert body(angle, state[:2]) == pytest.approx(point, abs=1e-9)
        assert math.hypot(*thrust) <= reference.most_thrust * (1.0 + 1e-12)
        for tau in (0.3, 1.0, 1.7):
            seen = (planar_transition(N, tau) @ state + planar_input(N, tau) @ thrust)[:2]
            place, radius = reference.between(tau)
            off = body(angle + math.radians(rate_deg) * tau, seen) - place
            assert math.hypot(*off) == pytest.approx(radius, abs=1e-9)
        state = a @ state + b @ thrust
    if rate_deg == 5.0:
        # Nearly the centripetal acceleration at the inertial rate: holds and tide are some thousandths of it.
        expected = (math.radians(5.0) + N) ** 2 * math.hypot(*point)
        assert reference.most_thrust == pytest.approx(expected, rel=3e-3)


def test_the_ellipsoid_shrinks_and_touches_a_limit() -> None:
    hold = hold_of(3.0, 0.1, np.array([0.0, 2.0]))
    cost, closed = hold.cost, hold.closed
    assert np.linalg.eigvalsh(closed.T @ cost @ closed - cost)[-1] < 0.0
    found = ellipsoid(hold)
    assert found.limited_by == "thrust"
    angles = np.linspace(0.0, 2.0 * np.pi, 721)
    sphere = np.linalg.inv(np.linalg.cholesky(cost)).T
    # The most thrust over the ellipsoid, and over all angles of the body: at the limit, less the polygon's 0.2 %.
    directions = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    spread = math.sqrt(found.level) * np.linalg.norm(directions @ hold.design.gain @ sphere, axis=1)
    assert hold.reference.most_thrust + spread.max() == pytest.approx(hold.usable, rel=1e-6)
    # Near the hold plane it is the corridor that limits.
    assert ellipsoid(hold_of(3.0, 0.1, np.array([0.0, 0.6]))).limited_by == "hold_plane"
    assert ellipsoid(hold_of(20.0, 0.05, np.array([0.0, 2.0]))).level == 0.0


def test_the_polyhedron_holds_the_ellipsoid_and_no_more_than_it_may() -> None:
    hold = hold_of(3.0, 0.1, np.array([0.0, 2.0]))
    inner = ellipsoid(hold)
    found = polyhedron(hold, inner, 0.4)
    assert found is not None
    inverse = np.linalg.inv(hold.cost)
    reach = np.sqrt(inner.level * np.einsum("ki,ij,kj->k", found.rows, inverse, found.rows))
    assert (reach <= found.bounds * (1.0 + 1e-9)).all()
    assert found.volume > 50.0 * inner.volume
    inside = found.vertices @ found.rows.T - found.bounds
    assert inside.max() < 1e-8
    assert (np.abs(inside) < 1e-7).sum(axis=1).min() >= 4
    # By brute force over 200 steps: points inside keep every limit, points 2 % beyond a vertex break one.
    random = np.random.Generator(np.random.Philox(5))
    chosen = found.vertices[random.permutation(len(found.vertices))[:60]]
    assert brute(hold, chosen, 0.4).min() >= -1e-9
    assert brute(hold, 1.02 * chosen, 0.4).max() < 0.0


def brute(hold: Hold, errors: Floats, phase: float) -> Floats:
    """Least room of each start over 200 steps watched 50 times each: m to a face, or 10 s^2 times thrust to spare."""
    normals = hold.corridor.normals / hold.corridor.lengths[:, None]
    offsets = hold.corridor.offsets / hold.corridor.lengths
    a, b = planar_transition(N, STEP), planar_input(N, STEP)
    least = np.full(len(errors), np.inf)
    states = hold.reference.at(phase)[0] + errors
    for k in range(200):
        angle = phase + hold.reference.rate * STEP * k
        wanted, thrust = hold.reference.at(angle)
        given = thrust - (states - wanted) @ hold.design.gain.T
        least = np.minimum(least, 10.0 * (hold.most - np.linalg.norm(given, axis=1)))
        for tau in np.arange(0.0, STEP, STEP / 50):
            places = states @ planar_transition(N, tau)[:2].T + given @ planar_input(N, tau)[:2].T
            turned = np.array([body(angle + hold.reference.rate * tau, place) for place in places])
            least = np.minimum(least, (offsets - turned @ normals.T).min(axis=1))
        states = states @ a.T + given @ b.T
    return least


def test_bad_designs_are_named() -> None:
    with pytest.raises(InvalidInput, match="dt_s"):
        TurningReference.of(np.array([0.0, 2.0]), 0.6, N, 2.0)
