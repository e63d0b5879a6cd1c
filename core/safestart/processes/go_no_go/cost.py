"""What an answer to go-no-go costs; light, because the service asks before it computes."""

from __future__ import annotations

from safestart.processes.costs import FIRST_S, program_s, region_s
from safestart.processes.go_no_go.method_registry import method_of
from safestart.processes.go_no_go.question_fields import QuestionFields

_CLOSED_FORM_S = 4e-6
_LOOK_UP_S = 1e-4
_UNCERTAIN = 4.0
MANY = 100
"""From so many starts on, method auto makes an atlas."""
MOST_PROGRAMS = 1000


def cost(inputs: QuestionFields, starts: int) -> float:
    """Seconds of one core, roughly, for so many starts."""
    if method_of(inputs.method).at_once:
        return _CLOSED_FORM_S * starts
    if method_of(inputs.method).start_s:
        return FIRST_S + method_of(inputs.method).start_s * starts
    horizon = inputs.within_s if inputs.question == "synchronize" else inputs.horizon_s
    one = program_s(horizon) * (_UNCERTAIN if inputs.uncertain or inputs.disturbance_m_s2 else 1.0)
    programs = FIRST_S + one * min(starts, MOST_PROGRAMS)
    if inputs.method == "auto" and starts >= MANY:
        return min(programs, region_s(horizon)) + _LOOK_UP_S * starts
    return programs
