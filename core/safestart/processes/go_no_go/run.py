"""Run go-no-go: the verdicts of the requested method, and the paper's conditions at every start beside them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from safestart.processes.base import ProcessOutput
from safestart.processes.go_no_go.answer import Answer
from safestart.processes.go_no_go.conditions import conditions_of
from safestart.processes.go_no_go.method_registry import decide_by, first_of, method_of
from safestart.processes.go_no_go.spec import GoNoGoInputs
from safestart.runtime.progress import Context


def run(inputs: GoNoGoInputs, context: Context) -> ProcessOutput:
    """Answer for every start; planar and spatial ones may not be mixed."""
    return ProcessOutput(answer(inputs, context).document())


def parts(inputs: GoNoGoInputs, context: Context) -> Iterator[tuple[str, Any]]:
    """The members of that document one after the other, for very many starts."""
    return answer(inputs, context).parts()


def answer(inputs: GoNoGoInputs, context: Context) -> Answer:
    """The answer, for one start or many."""
    if len(inputs.states) == 1:
        found = at_once(inputs, context)
        if found is not None:
            return found
    conditions = conditions_of(inputs)
    return Answer(inputs, conditions, decide_by(inputs.method)(inputs, conditions, context))


def output_at_once(inputs: GoNoGoInputs, context: Context) -> ProcessOutput | None:
    """The output where every start takes microseconds."""
    found = at_once(inputs, context)
    return None if found is None else ProcessOutput(found.document())


def at_once(inputs: GoNoGoInputs, context: Context) -> Answer | None:
    """The answer where every start takes microseconds; None where one takes longer."""
    if method_of(inputs.method).at_once:
        conditions = conditions_of(inputs)
        return Answer(inputs, conditions, decide_by(inputs.method)(inputs, conditions, context))
    first = first_of(inputs.method)
    if first is None:
        return None
    conditions = conditions_of(inputs)
    verdicts = first(inputs, conditions)
    return None if verdicts is None else Answer(inputs, conditions, verdicts)
