"""Run go-no-go: the paper's conditions at every start, and the verdicts of the requested method."""

from __future__ import annotations

from safestart.processes.base import ProcessOutput
from safestart.processes.go_no_go.answer import Answer
from safestart.processes.go_no_go.conditions import conditions_of
from safestart.processes.go_no_go.method_registry import decide_by
from safestart.processes.go_no_go.spec import GoNoGoInputs
from safestart.runtime.progress import Context


def run(inputs: GoNoGoInputs, context: Context) -> ProcessOutput:
    """Answer for every start; planar and spatial ones may not be mixed."""
    return ProcessOutput(answer(inputs, context).document())


def answer(inputs: GoNoGoInputs, context: Context) -> Answer:
    """The answer, for one start or many."""
    conditions = conditions_of(inputs)
    return Answer(inputs, conditions, decide_by(inputs.method)(inputs, conditions, context))
