"""Tables that do not depend on the start: forecast rows, face normals and transition matrices, computed once."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from safestart.constraints.corridor import corridor_of, faces_about_z
from safestart.control.gains import Gains
from safestart.control.regimes import Law, control_law
from safestart.dynamics.cwh import Cwh, input_matrix, transition_matrix
from safestart.errors import invalid
from safestart.model.scenario import Floats, Scenario
from safestart.optim.prediction import held_through

SUBSTEPS = 3
"""Truth sub-steps per control interval, at each of which the corridor is checked (paper 000, section 2.1)."""

MAX_NODES = 50
MAX_FORECASTS = 200_000
"""Bound on steps times nodes: tables of some 100 MB."""


class Plan(NamedTuple):
    """Tables of a closed loop, as the compiled kernels take them.

    d = 2 (motion in the plane z = 0) or 3; F = 3 or 5 faces; N forecast nodes; K control steps; S sub-steps.
    Commands are scaled, w = u / a_max. A row r of the filter reads
    ``normals[k, :, r] @ w <= bounds[k, r] - state[k, :, r] @ x`` with unit normals; x holds the 2 d state
    components ``components``. Rows in order: F N corridor rows, one keep-out row (if on; the filter fills it
    in), 2 d speed rows (if on), 2 d box rows. ``weights[k, r]`` turns a violation into metres of
    distance, 0 for rows that the fallback leaves out.

    ``faces[k, s, :, i]`` is the unit normal of face i, turned into LVLH, at sub-step s of step k, ``start_faces`` at
    the start; ``offsets[i]`` = b_i / |A_i|, metres. ``rotation[k]`` = (cos, sin) of theta at the start of step k.
    """

    law: Law
    effort_weight: float
    move_weight: float
    closing_factor: float
    keep_out_radius: float
    keep_out_row: int
    disk_limit: float
    dt: float
    components: np.ndarray[tuple[int], np.dtype[np.int64]]
    normals: Floats
    state: Floats
    bounds: Floats
    weights: Floats
    start_faces: Floats
    faces: Floats
    offsets: Floats
    rotation: Floats
    node_transition: Floats
    node_input: Floats
    transition: Floats
    input: Floats


def flight_plan(
    scenario: Scenario,
    gains: Gains,
    dt: float,
    steps: int,
    *,
    nodes: int = 6,
    planar: bool = True,
    substeps: int = SUBSTEPS,
) -> Plan:
    """Tabulate ``steps`` control intervals of ``dt`` seconds with a forecast of ``nodes`` intervals (eq. 7).

    ``planar`` flies motion in z = 0 with the three faces that matter there, otherwise all five in space. Raises
    ``InvalidInput`` for counts out of range or a ``dt`` that is not positive.
    """
    if not (math.isfinite(dt) and dt > 0.0):
        raise invalid("dt", "a control interval of more than 0 s", dt)
    if not 1 <= nodes <= MAX_NODES:
        raise invalid("nodes", f"1 to {MAX_NODES} forecast nodes", nodes)
    if not 1 <= steps <= MAX_FORECASTS // nodes:
        raise invalid("steps", f"1 to {MAX_FORECASTS // nodes} control steps with {nodes} nodes", steps)
    n, a_max = scenario.target.mean_motion, scenario.chaser.max_acceleration
    d = 2 if planar else 3
    components = np.array([0, 1, 3, 4] if planar else [0, 1, 2, 3, 4, 5])
    corridor = corridor_of(scenario.corridor, d)
    count = len(corridor.offsets)
    transition, held = held_through(Cwh(n), 0.0, dt * np.arange(1.0, nodes + 1.0))
    phi, gamma = np.ascontiguousarray(transition[:, :, components]), held[:, :, :d] * a_max

    # Corridor rows, k-major: the face normals at node j of step k, times Phi_j and B_j.
    rate = scenario.target.tumble_rate
    angles: Floats = rate * dt * (np.arange(steps)[:, None] + np.arange(1.0, nodes + 1.0))
    turned = faces_about_z(corridor.normals, angles)
    state = np.einsum("kjic,jcx->kxij", turned, phi[:, :d]).reshape(steps, len(components), count * nodes)
    normals = np.einsum("kjic,jcu->kuij", turned, gamma[:, :d]).reshape(steps, d, count * nodes)
    tightened = corridor.offsets - gains.corridor_margin
    bounds = np.broadcast_to(np.repeat(tightened, nodes), (steps, count * nodes))
    length = np.sqrt((normals**2).sum(axis=1))
    weights = length / np.repeat(corridor.lengths, nodes)

    blocks = [(normals / length[:, None], state / length[:, None], bounds / length, weights)]
    keep_out_row = -1
    if gains.keep_out_radius > 0.0:
        keep_out_row = count * nodes
        blocks.append(_constant(steps, np.zeros((d, 1)), np.zeros((len(components), 1)), np.zeros(1)))
    if gains.speed_limit > 0.0:
        both = np.concatenate([np.eye(d), -np.eye(d)], axis=1)
        limit = np.full(2 * d, gains.speed_limit)
        blocks.append(
            _constant(steps, gamma[0, 3 : 3 + d].T @ both, phi[0, 3 : 3 + d].T @ both, limit, unit=True)
        )
    box = np.concatenate([np.eye(d), -np.eye(d)], axis=1)
    blocks.append(_constant(steps, box, np.zeros((len(components), 2 * d)), np.ones(2 * d)))

    instants = np.arange(steps)[:, None] + np.arange(1, substeps + 1) / substeps
    faces = faces_about_z(corridor.normals / corridor.lengths[:, None], rate * dt * instants)
    theta = rate * dt * np.arange(steps)
    normals, state, bounds, weights = (
        np.ascontiguousarray(np.concatenate(parts, axis=-1)) for parts in zip(*blocks, strict=True)
    )
    return Plan(
        control_law(scenario, gains, dt),
        gains.effort_weight,
        gains.move_weight,
        gains.closing_factor,
        gains.keep_out_radius,
        keep_out_row,
        gains.disk_limit,
        dt,
        components,
        normals,
        state,
        bounds,
        weights,
        np.ascontiguousarray((corridor.normals / corridor.lengths[:, None]).T),
        np.ascontiguousarray(faces.swapaxes(-1, -2)),
        corridor.offsets / corridor.lengths,
        np.stack([np.cos(theta), np.sin(theta)], axis=-1),
        transition_matrix(n, dt),
        input_matrix(n, dt),
        transition_matrix(n, dt / substeps),
        input_matrix(n, dt / substeps),
    )


def _constant(
    steps: int, normals: Floats, state: Floats, bounds: Floats, *, unit: bool = False
) -> tuple[Floats, Floats, Floats, Floats]:
    """Rows that are the same at every step and have no weight in the fallback; ``unit`` divides by their length."""
    if unit:
        length = np.sqrt((normals**2).sum(axis=0))
        normals, state, bounds = normals / length, state / length, bounds / length
    repeat = [np.broadcast_to(a, (steps, *a.shape)) for a in (normals, state, bounds)]
    return repeat[0], repeat[1], repeat[2], np.zeros((steps, len(bounds)))
