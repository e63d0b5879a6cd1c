"""One start by flat names, asked either way: at rest (``x_m``, ``y_m``), or in space (``position_m``)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from safestart.errors import invalid
from safestart.processes.flat import Parameter
from safestart.processes.go_no_go import run
from safestart.processes.go_no_go.method_registry import PROVING, method_of
from safestart.processes.go_no_go.one_start import ONE_START
from safestart.processes.go_no_go.spec import SPEC, GoNoGoInputs
from safestart.processes.start_in_space import one_start as in_space
from safestart.processes.start_in_space.spec import SPEC as SPACE
from safestart.processes.start_in_space.spec import SpaceInputs
from safestart.runtime.progress import Context

OneStart = GoNoGoInputs | SpaceInputs
_START = "position_m"
_WIDER = ("omega_t_deg_s",)
"""Names of both questions whose range is wider in space."""
_OTHER = {"omega_t_deg_s": "of either sign", "disturbance_m_s2": "one thrust history, without a feedback"}
"""What is different with ``position_m``."""


def _parameters() -> dict[str, Parameter]:
    """Those of both questions; none is needed for both."""
    out: dict[str, Parameter] = {}
    for name, one in ONE_START.parameters.items():
        field = in_space.PARAMETERS[name].field if name in _WIDER else one.field
        needed = f" Needed without {_START}." if one.required and name not in in_space.PARAMETERS else ""
        other = f" With {_START} {_OTHER[name]}." if name in _OTHER else ""
        out[name] = replace(one, field=field, text=one.text + needed + other, required=False)
    for name, one in in_space.PARAMETERS.items():
        if name not in out:
            out[name] = replace(one, text=f"In space (with {_START}): {one.text}", required=False)
    return out


PARAMETERS = _parameters()


def parse(values: Mapping[str, Any]) -> OneStart:
    """Validate flat values, which may be texts; raises ``InvalidInput`` under the flat name."""
    if _START in values:
        return in_space.parse(values)
    for name in values:
        if name not in ONE_START.parameters and name in in_space.PARAMETERS:
            raise invalid(_START, f"the start, instead of x_m and y_m, where {name} is given", None)
    return ONE_START.parse(values)


def cost(inputs: OneStart) -> float:
    """Seconds of one core, roughly."""
    return (SPACE if isinstance(inputs, SpaceInputs) else SPEC).cost(inputs)


def at_once(inputs: OneStart, context: Context) -> dict[str, Any] | None:
    """The document of a question that takes microseconds, else None."""
    found = None if isinstance(inputs, SpaceInputs) else run.at_once(inputs, context)
    return None if found is None else found.document_of_one()


def document_of_one(inputs: OneStart, context: Context) -> dict[str, Any]:
    """``SpaceAnswer`` or ``GoNoGoAnswer``."""
    if isinstance(inputs, SpaceInputs):
        return in_space.document_of_one(inputs, context)
    return run.answer(inputs, context).document_of_one()


def sound(inputs: OneStart) -> bool:
    """Whether every GO of the method can be flown."""
    return isinstance(inputs, SpaceInputs) or method_of(inputs.method).sound


def with_proof(inputs: OneStart) -> OneStart:
    """The same question, answered with its proof by a method that has one."""
    if isinstance(inputs, SpaceInputs) or method_of(inputs.method).proves:
        return inputs.model_copy(update={"proofs": True})
    return inputs.model_copy(update={"method": PROVING, "proofs": True})
