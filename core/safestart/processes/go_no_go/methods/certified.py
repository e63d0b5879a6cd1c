"""Method certified: GO by a manoeuvre whose room and thrust are proved (docs/theory/certified.md), else undecided.

Every start is computed in plain floats, so a single start gets the same bits as among others.
"""

from __future__ import annotations

import math
from functools import lru_cache

from safestart.closed_form.certified import OUT_OF_REACH, ROUNDING
from safestart.closed_form.certified_point import PointCertificate, Prepared, certify_point, prepare
from safestart.model.scenario import CorridorShape, Rest
from safestart.processes.go_no_go.answer import Verdicts
from safestart.processes.go_no_go.conditions import Conditions
from safestart.processes.go_no_go.methods.plain import more_asked, refuse_more
from safestart.processes.go_no_go.spec import GoNoGoInputs
from safestart.runtime.progress import Context

NAME = "certified"


def decide(inputs: GoNoGoInputs, conditions: Conditions, context: Context) -> Verdicts:
    """GO by the certificate, NO_GO outside the corridor, else UNDECIDED: other histories may stay."""
    refuse_more(inputs)
    found = certificates(inputs)
    context.step(1, 1)
    verdict: list[str] = []
    margin: list[float | None] = []
    reason: list[str] = []
    for one, violated in zip(found, conditions.violated, strict=True):
        told: tuple[str, float | None, str]
        if one.go:
            told = "GO", one.margin, sentence(one)
        elif violated and one.margin < -2.0 * ROUNDING:
            told = "NO_GO", one.margin, f"outside the corridor: violates {', '.join(violated)}"
        else:
            told = "UNDECIDED", None, _undecided(one)
        verdict.append(told[0])
        margin.append(told[1])
        reason.append(told[2])
    return Verdicts(
        verdict, margin, reason, decided_by=[None if word == "UNDECIDED" else NAME for word in verdict]
    )


def go_at_once(inputs: GoNoGoInputs, _: Conditions) -> Verdicts | None:
    """The answer if every start is GO, in microseconds each; None if another method must decide one."""
    if not answers(inputs):
        return None
    found = certificates(inputs)
    if not all(one.go for one in found):
        return None
    return Verdicts(
        ["GO"] * len(found),
        [one.margin for one in found],
        [sentence(one) for one in found],
        decided_by=[NAME] * len(found),
    )


def answers(inputs: GoNoGoInputs) -> bool:
    """Whether the certificate covers the question and no proof document is requested, as it has none."""
    return not inputs.proofs and covers(inputs)


def covers(inputs: GoNoGoInputs) -> bool:
    """Whether the certificate covers the question; its GO is then the answer, whatever document is requested."""
    return more_asked(inputs) is None


def certificates(inputs: GoNoGoInputs) -> list[PointCertificate]:
    """The certificate of every start; planar and spatial ones are not mixed."""
    corridor, states = inputs.corridor, inputs.states
    spatial = states[0].z_m is not None
    given = _prepared(
        (inputs.omega_t_deg_s, inputs.a_max_m_s2, inputs.mean_motion_rad_s),
        (corridor.c_x, corridor.c_z, corridor.x0_m, corridor.z0_m, corridor.r_h_m),
        inputs.rest,
        spatial,
    )
    if spatial:
        return [certify_point(given, state.x_m, state.y_m, state.z_m or 0.0) for state in states]
    return [certify_point(given, state.x_m, state.y_m) for state in states]


@lru_cache(maxsize=1024)
def _prepared(
    point: tuple[float, float, float],
    shape: tuple[float, float, float, float, float],
    rest: Rest,
    spatial: bool,
) -> Prepared:
    """The operating point (deg/s, m/s^2, rad/s) and corridor by their numbers: the core's terms take longer to make."""
    tumble, thrust, motion = point
    return prepare(math.radians(tumble), motion, thrust, CorridorShape(*shape), rest, spatial)


def sentence(one: PointCertificate) -> str:
    """Why a start is GO."""
    return f"a known manoeuvre stays for ever, at least {one.margin:.2f} m from every face, nearest {one.binding}"


def _undecided(one: PointCertificate) -> str:
    lacks = (
        "no manoeuvre of the certificate has the thrust to come from so far"
        if one.binding == OUT_OF_REACH
        else f"the certificate's manoeuvre lacks room at {one.binding}"
    )
    return f"undecided: {lacks} ({-one.margin:.2f} m short); another thrust history may stay"
