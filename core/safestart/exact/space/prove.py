"""Proof documents in space; :mod:`safestart.proofs.space` checks them, sharing no code."""

from __future__ import annotations

from typing import Any

import numpy as np

from safestart.attitude.in_lvlh import InLvlh
from safestart.attitude.spin import Spin
from safestart.attitude.table import Table
from safestart.attitude.torque_free import TorqueFree
from safestart.attitude.turning import SmoothAttitude
from safestart.errors import invalid
from safestart.exact.answer import Answer, Verdict
from safestart.exact.prove import GO_STAND_BACK_M, NO_GO_STAND_BACK_M, limits_of, refuted_by
from safestart.exact.space.demands.demanded import lost_at_start
from safestart.exact.space.demands.rules import PLUME, VIEW, Demands
from safestart.exact.space.question import SpaceQuestion
from safestart.exact.space.unknowns import Unknowns
from safestart.model.scenario import Floats
from safestart.proofs.space.statement import SCHEMA
from safestart.proofs.statement import digest_of


def proof_in_space(
    question: SpaceQuestion, state: Floats, answer: Answer, half: Floats | None = None
) -> dict[str, Any]:
    """JSON-able proof of a GO or NO_GO for the start ``state`` (6,); see :func:`safestart.exact.prove.proof_of`.

    ``half`` (6,) are the half-widths of a box of starts, for an answer of :mod:`safestart.exact.space.start_box`.
    Raises ``InvalidInput`` for an UNDECIDED answer.
    """
    start = np.asarray(state, dtype=np.float64)
    document: dict[str, Any] = {
        "schema": SCHEMA,
        "verdict": answer.verdict.value,
        "question": question_of(question),
        "start": {"frame": "lvlh", "position_m": start[:3].tolist(), "velocity_m_s": start[3:].tolist()},
    }
    if half is not None:
        document["start"] |= {
            "position_half_width_m": half[:3].tolist(),
            "velocity_half_width_m_s": half[3:].tolist(),
        }
    if answer.verdict is Verdict.GO and answer.thrust is not None:
        document["margin_m"] = max(answer.lower - GO_STAND_BACK_M, 0.5 * answer.lower)
        document["thrust_m_s2" if question.thrust.kind == "ball" else "throttle"] = answer.thrust.tolist()
    elif answer.verdict is Verdict.NO_GO:
        document["margin_m"] = min(answer.upper + NO_GO_STAND_BACK_M, 0.5 * answer.upper)
        at_start = lost_at_start(question.demands, answer)
        if at_start:
            document["violated"] = at_start
        else:
            document |= refuted_by(answer, question.latest, free=question.goal is not None)
    else:
        raise invalid("answer", "a GO or NO_GO", answer.verdict.value)
    document["digest"] = digest_of(document)
    return document


def question_of(question: SpaceQuestion) -> dict[str, Any]:
    """The question as a document states it, in SI units."""
    orbit, limit = question.orbit, question.thrust
    thrust: dict[str, Any] = {"kind": limit.kind, "a_max_m_s2": list(limit.a_max)}
    if limit.kind != "ball":
        thrust["frame"] = limit.frame
    if limit.kind == "thrusters":
        thrust["directions"] = [[float(e) for e in direction] for direction in limit.directions]
    return {
        "kind": question.kind,
        "dt_s": float(question.dt),
        "steps": question.steps,
        "orbit": {
            "mean_motion_rad_s": float(orbit.mean_motion),
            "eccentricity": float(orbit.eccentricity),
            "true_anomaly_rad": float(orbit.true_anomaly),
        },
        "attitude": _attitude(question.attitude),
        "faces": [
            {
                "name": face.name,
                "normal": [float(e) for e in face.normal],
                "offset_m": float(face.offset),
                "frame": face.frame,
            }
            for face in question.faces
        ],
        "thrust": thrust,
        **limits_of(question.goal, (question.goal and question.goal.hold) or (), question.speed_limit),
        **_demands(question.demands),
        **_unknowns(question.unknowns),
    }


def _unknowns(unknowns: Unknowns) -> dict[str, Any]:
    if not unknowns:
        return {}
    return {
        "unknowns": {
            "attitude_rad": float(unknowns.angle),
            "rate_rad_s": float(unknowns.rate),
            "inertia_share": float(unknowns.inertia),
            "disturbance_m_s2": float(unknowns.disturbance),
        }
    }


def _demands(demands: Demands) -> dict[str, Any]:
    """The demands as they are asked, not the convex parts by which they were answered."""
    out: dict[str, Any] = {}
    if demands.keep_outs:
        out["keep_outs"] = [
            {
                "name": one.name,
                "centre_m": [float(e) for e in one.centre],
                **({"radius_m": one.size[0]} if len(one.size) == 1 else {"half_widths_m": list(one.size)}),
                "frame": one.frame,
            }
            for one in demands.keep_outs
        ]
    view, plume = demands.view, demands.plume
    if view is not None:
        out[VIEW] = {
            "axis": [float(e) for e in view.axis],
            "half_angle_rad": float(view.half_angle),
            "point_m": [float(e) for e in view.point],
            "frame": view.frame,
        }
    if plume is not None:
        out[PLUME] = {
            "half_angle_rad": float(plume.half_angle),
            "range_m": float(plume.reach),
            "point_m": [float(e) for e in plume.point],
            "frame": plume.frame,
        }
    return out


def _attitude(attitude: SmoothAttitude) -> dict[str, Any]:
    """How the body turns, by what it turns against."""
    reference = "inertial" if isinstance(attitude, InLvlh) else "lvlh"
    inner = attitude.inertial if isinstance(attitude, InLvlh) else attitude
    if isinstance(inner, Spin):
        return {
            "kind": "spin",
            "axis": list(inner.axis),
            "axis_frame": reference,
            "rate_rad_s": float(inner.rate),
            "phase_rad": float(inner.phase),
        }
    if isinstance(inner, Table):
        return {
            "kind": "table",
            "times_s": list(inner.times),
            "attitude_wxyz": [list(entry) for entry in inner.quaternions],
            "reference": reference,
        }
    if isinstance(inner, TorqueFree) and reference == "inertial":
        return {
            "kind": "torque_free",
            "inertia_kg_m2": [list(row) for row in inner.inertia],
            "attitude_wxyz": list(inner.attitude),
            "body_rate_rad_s": list(inner.body_rate),
            "reference": reference,
        }
    raise invalid("attitude", "a spin, a torque-free body or a table", type(inner).__name__)
