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


class Conditions(NamedTuple):
    """Faces and range limit (m, inf without one), and over the starts, in metres: smallest margin, margin after erosion
    by face, range margin, the binding condition, and the faces that the start itself violates.
    """

    faces: tuple[str, ...]
    limit: float
    margin: list[float]
    face_margin: list[list[float]]
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
    found = certify(inputs.scenario(), points_of(inputs), inputs.rest)
    face_margin, range_margin = found.face_margin.tolist(), found.range_margin.tolist()
    binding: list[str] = []
    violated: list[list[str]] = []
    for start in zip(found.slack.tolist(), face_margin, range_margin, strict=True):
        binds, outside = binding_of(found.faces, *start)
        binding.append(binds)
        violated.append(outside)
    return Conditions(
        found.faces, found.range_limit, found.margin.tolist(), face_margin, range_margin, binding, violated
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
