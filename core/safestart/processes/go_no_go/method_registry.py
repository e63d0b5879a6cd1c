"""The methods by wire name; one line each. Light to import: a method's module is imported at its first use."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, Literal

from safestart.processes.sharding import load

Decide = Callable[..., Any]
"""(GoNoGoInputs, Conditions, Context) -> Verdicts."""


@dataclass(frozen=True, slots=True)
class Method:
    """A method to answer.

    ``text`` describes it on the wire. ``decide`` names the function, ``module:function``, from inputs, the paper's
    conditions at every start, and a context to :class:`Verdicts`; it raises ``InvalidInput`` for unsupported inputs.
    ``proves``: GO and NO_GO come with proof documents on request. ``at_once``: one start takes microseconds, so that a
    service may answer it on its event loop.
    """

    name: str
    text: str
    decide: str
    proves: bool = True
    at_once: bool = False


_HERE = "safestart.processes.go_no_go.methods"
_ALL = (
    Method(
        "closed_form",
        "the paper's conditions, at once",
        f"{_HERE}.closed_form:decide",
        proves=False,
        at_once=True,
    ),
    Method("exact", "cone programs, proved either way", f"{_HERE}.exact:decide"),
    Method(
        "auto",
        "the same verdicts, by an atlas where there is one or where there are many planar starts at rest in LVLH",
        f"{_HERE}.auto:decide",
    ),
)

METHODS = {method.name: method for method in _ALL}
DEFAULT, PROVING = "closed_form", "exact"
"""The default method, also for a proof when the named method has none."""

if TYPE_CHECKING:
    MethodName = str
else:
    MethodName = Literal[tuple(METHODS)]


@cache
def decide_by(name: str) -> Decide:
    """Import and return the function of a method."""
    return load(METHODS[name].decide)
