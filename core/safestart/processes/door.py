"""One start by flat names, asked either way: at rest (``x_m``, ``y_m``), or in space (``position_m``)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Protocol

from safestart.errors import invalid
from safestart.model.plain_numbers import is_number, require_plain
from safestart.processes.flat import Parameter
from safestart.processes.go_no_go.one_start import ONE_START, OneAtRest
from safestart.processes.start_in_space import one_start as in_space
from safestart.runtime.progress import Context


class OneStart(Protocol):
    """A validated question about one start, whichever process answers it; a helper process can be sent one."""

    def cost(self) -> float:
        """Seconds of one core that the answer takes, roughly."""
        ...

    def at_once(self, context: Context) -> dict[str, Any] | None:
        """The document of a question that takes microseconds, else None."""
        ...

    def document(self, context: Context) -> dict[str, Any]:
        """The answer: verdict, reason, and what else its process says."""
        ...

    def sound(self) -> bool:
        """Whether every GO of the method can be flown."""
        ...

    def with_proof(self) -> OneStart:
        """The same question, answered with its proof by a method that has one."""
        ...

    def remarks(self, document: Mapping[str, Any]) -> list[str]:
        """Lines for a reader about an answer, beside its verdict and reason."""
        ...


_START = "position_m"
_WIDER = ("omega_t_deg_s",)
"""Names of both questions whose range is wider in space."""
_OTHER = {"omega_t_deg_s": "of either sign", "disturbance_m_s2": "one thrust history, without a feedback"}
"""What is different with ``position_m``."""


def _parameters() -> dict[str, Parameter]:
    """Join the parameters of both questions; none is needed for both."""
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
_NUMBERS = frozenset(
    name for name, one in PARAMETERS.items() if not one.json_text and is_number(one.field.annotation)
)


def parse(values: Mapping[str, Any]) -> OneStart:
    """Validate flat values of JSON, strictly and as a POST does; raises ``InvalidInput`` under the flat name."""
    if _in_space(values):
        return in_space.OneInSpace(in_space.parse(values))
    return OneAtRest(ONE_START.parse(values))


def read(texts: Mapping[str, str]) -> OneStart:
    """As :func:`parse` for the texts of a query: plain scalars, and JSON for objects and lists."""
    for name in _NUMBERS.intersection(texts):
        require_plain(name, texts[name])
    if _in_space(texts):
        return in_space.OneInSpace(in_space.read(texts))
    return OneAtRest(ONE_START.read(texts))


def _in_space(given: Mapping[str, Any]) -> bool:
    """Whether the question is the one in space; raises ``InvalidInput`` for its names without its start."""
    if _START in given:
        return True
    for name in given:
        if name not in ONE_START.parameters and name in in_space.PARAMETERS:
            raise invalid(_START, f"the start, instead of x_m and y_m, where {name} is given", None)
    return False
