"""The question of a missed-burn proof in its document's form; light to import.

Schema ``safestart-abort-proof/1`` is about impulses, a box of errors and a sphere around the target. ``/2`` has also
burns with durations, an ellipsoid of errors and zones.
"""

from __future__ import annotations

from typing import Any

from safestart.missed_burn.plan import Question
from safestart.missed_burn.zone import POINT, Zone
from safestart.proofs.statement import digest_of

SCHEMA, WIDER = "safestart-abort-proof/1", "safestart-abort-proof/2"


def sealed(question: Question, least: float, cases: list[dict[str, Any]]) -> dict[str, Any]:
    """The document of a PROVED plan: ``least`` m proved over all ``cases``."""
    document: dict[str, Any] = {
        "schema": WIDER if wider(question) else SCHEMA,
        "verdict": "PROVED",
        "least_distance_m": least,
        "question": question_document(question),
        "cases": cases,
    }
    document["digest"] = digest_of(document)
    return document


def wider(question: Question) -> bool:
    """Whether the question needs the wider schema."""
    burns = any(burn.duration > 0.0 for burn in question.plan.burns)
    return burns or bool(question.errors.ellipsoid) or question.zones != (POINT,)


def question_document(question: Question) -> dict[str, Any]:
    """The question in the document's form."""
    plan, errors, failures, wide = question.plan, question.errors, question.failures, wider(question)
    columns = [list(column) for column in errors.ellipsoid]
    # About the Earth the states before the burns are given, and the plan's own start is not asked about.
    start = plan.start if question.earth is None else question.earth.before[0]
    return {
        **_model(question),
        "mean_motion_rad_s": plan.mean_motion,
        "start": {"position_m": list(start[:3]), "velocity_m_s": list(start[3:])},
        "burns": [
            {
                "time_s": burn.time,
                "impulse_m_s": list(burn.impulse),
                **({"duration_s": burn.duration} if wide else {}),
            }
            for burn in plan.burns
        ],
        "keep_out_m": question.keep_out,
        **({"zones": [zone_document(zone) for zone in question.zones]} if wide else {}),
        "horizon_s": question.horizon,
        "errors": {
            "position_m": list(errors.position),
            "velocity_m_s": list(errors.velocity),
            "thrust_share": errors.thrust_share,
            "thrust_rad": errors.thrust_angle,
            "at_each_burn": errors.at_each_burn,
            **({"ellipsoid": columns} if wide else {}),
        },
        "failures": {
            "late_s": failures.late,
            "partial": failures.partial,
            "stuck_s": failures.stuck,
            # What no burn does is not stated: a reader would have to know that it means nothing.
            "acceleration_m_s2": failures.acceleration if failures.stuck > 0.0 else 0.0,
            "misdirected_rad": failures.misdirected,
        },
    }


def zone_document(zone: Zone) -> dict[str, Any]:
    """A zone: its centre and its axes, m."""
    return {"kind": zone.kind, "centre_m": list(zone.centre), "axes_m": [list(axis) for axis in zone.axes]}


def _model(question: Question) -> dict[str, Any]:
    if question.earth is not None:
        from safestart.dynamics.two_body import J2
        from safestart.model.orbit import EARTH_RADIUS, MU

        target = question.earth.target
        return {
            "model": "earth",
            "target": {
                "position_m": list(target[:3]),
                "velocity_m_s": list(target[3:]),
                "mu_m3_s2": MU,
                "j2": J2,
                "earth_radius_m": EARTH_RADIUS,
            },
            "before": [
                {"position_m": list(state[:3]), "velocity_m_s": list(state[3:])}
                for state in question.earth.before
            ],
        }
    if question.radius is not None:
        return {"model": "nonlinear", "semi_major_axis_m": question.radius}
    return {"model": "linear"}
