"""The paper's conditions at every start; each method's answer shows them beside its own verdict."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from safestart.closed_form.explain import binding_of
from safestart.closed_form.paper import certify
from safestart.closed_form.paper_point import certify_point, prepare
from safestart.errors import invalid
from safestart.model.scenario import Floats
from safestart.processes.go_no_go.spec import GoNoGoInputs

BLOCK = 5_000
"""Starts whose conditions are computed together: what lies between start and margin takes more memory than both."""


class Conditions(NamedTuple):
    """Faces and range limit (m, inf without one), and over the starts, in metres: smallest margin, margin after erosion
    by face (an array for many starts), range margin, the binding condition, and the faces that the start itself
    violates.
    """

    faces: tuple[str, ...]
    limit: float
    margin: list[float]
    face_margin: list[list[float]] | Floats
    range_margin: list[float]
    binding: list[str]
    violated: list[list[str]]


def conditions_of(inputs: GoNoGoInputs) -> Conditions:
    """Conditions at every start; a single start, computed in plain floats, gets the same bits as among others."""
    return _alone(inputs) if len(inputs.states) == 1 else _together(inputs)


def points_of(inputs: GoNoGoInputs) -> Floats:
    """The starts (S, 2) or (S, 3), body frame, m; raises ``InvalidInput`` when planar and spatial ones are mixed."""
    spatial = [state.z_m is not None for state in inputs.states]
    if any(spatial) and not all(spatial):
        raise invalid("states", "z_m in every state or in none", f"z_m in {sum(spatial)} of {len(spatial)}")
    if spatial[0]:
        return np.array([(state.x_m, state.y_m, state.z_m) for state in inputs.states])
    return np.array([(state.x_m, state.y_m) for state in inputs.states])


def _together(inputs: GoNoGoInputs) -> Conditions:
    scenario, points = inputs.scenario(), points_of(inputs)
    margin: list[float] = []
    face_margins: list[Floats] = []
    range_margins: list[float] = []
    binding: list[str] = []
    violated: list[list[str]] = []
    sets: dict[tuple[str, ...], list[str]] = {}  # there are few: starts share them
    for first in range(0, len(points), BLOCK):
        found = certify(scenario, points[first : first + BLOCK], inputs.rest)
        range_margin = found.range_margin.tolist()
        for start in zip(found.slack.tolist(), found.face_margin.tolist(), range_margin, strict=True):
            binds, outside = binding_of(found.faces, *start)
            binding.append(binds)
            violated.append(sets.setdefault(tuple(outside), outside))
        margin += found.margin.tolist()
        face_margins.append(found.face_margin)
        range_margins += range_margin
    return Conditions(
        found.faces, found.range_limit, margin, np.concatenate(face_margins), range_margins, binding, violated
    )


def _alone(inputs: GoNoGoInputs) -> Conditions:
    corridor, state = inputs.corridor, inputs.states[0]
    shape = (corridor.c_x, corridor.c_z, corridor.x0_m, corridor.z0_m, corridor.r_h_m)
    point = (state.x_m, state.y_m) if state.z_m is None else (state.x_m, state.y_m, state.z_m)
    prepared = prepare(
        inputs.omega_t_deg_s, inputs.a_max_m_s2, inputs.mean_motion_rad_s, shape, inputs.rest, len(point)
    )
    found = certify_point(prepared, point)
    binding, violated = binding_of(prepared.faces, found.slack, found.face_margin, found.range_margin)
    return Conditions(
        prepared.faces,
        prepared.limit,
        [found.margin],
        [found.face_margin],
        [found.range_margin],
        [binding],
        [violated],
    )
