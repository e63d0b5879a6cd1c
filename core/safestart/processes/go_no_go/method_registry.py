"""The methods by wire name; one line each. Light to import: a method's module is imported at its first use."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, Literal

from safestart.model.registry import by_name
from safestart.runtime.named import load

Decide = Callable[..., Any]
"""(GoNoGoInputs, Conditions, Context) -> Verdicts."""


@dataclass(frozen=True, slots=True)
class Method:
    """A method to answer.

    ``text`` describes it on the wire. ``decide`` names the function, ``module:function``, from inputs, the paper's
    conditions at every start, and a context to :class:`Verdicts`; it raises ``InvalidInput`` for unsupported inputs.
    ``proves``: GO and NO_GO come with proof documents on request. ``sound``: every GO can be flown. ``at_once``: one
    start takes microseconds, so that a service may answer it on its event loop. ``first`` names a function that is
    tried before on a single start, from inputs and conditions to :class:`Verdicts` in microseconds, or None.
    ``start_s``: seconds that a start takes, 0 for that of a cone program.
    """

    name: str
    text: str
    decide: str
    proves: bool = True
    sound: bool = False
    at_once: bool = False
    first: str = ""
    start_s: float = 0.0


_HERE = "safestart.processes.go_no_go.methods"
_ALL = (
    Method(
        "certified",
        "explicit manoeuvres with a proof, at once; GO is for ever, what is not certified is UNDECIDED",
        f"{_HERE}.certified:decide",
        proves=False,
        sound=True,
        at_once=True,
    ),
    Method(
        "paper",
        "the conditions of Iskender et al., at once; NOT SOUND, a GO may be impossible to fly",
        f"{_HERE}.paper:decide",
        proves=False,
        at_once=True,
    ),
    Method("exact", "cone programs, proved either way", f"{_HERE}.exact:decide", sound=True),
    Method(
        "auto",
        "certified where that says GO, else exact, by an atlas where many planar starts at rest in LVLH are left",
        f"{_HERE}.auto:decide",
        sound=True,
        first=f"{_HERE}.certified:go_at_once",
    ),
    Method(
        "tracking",
        "the tracking MPC of Rebollo et al. flown to rest at the port, its thrust history proved and its plans "
        "certified; beside it the exact answer, which decides NO_GO",
        f"{_HERE}.tracking:decide",
        sound=True,
        start_s=0.5,
    ),
)

METHODS = by_name("methods", _ALL, lambda method: method.name)
RENAMED = {"closed_form": "paper"}
"""Deprecated names, still accepted."""
DEFAULT, PROVING = "auto", "exact"
"""The default method, and the method for a proof when the named one has none."""
UNPROVED = tuple(name for name in (*METHODS, *RENAMED) if not METHODS[RENAMED.get(name, name)].sound)
"""Names of methods whose GO may be impossible to fly."""

if TYPE_CHECKING:
    MethodName = str
else:
    MethodName = Literal[(*METHODS, *RENAMED)]


def method_of(name: str) -> Method:
    """The method called ``name``, by its present or a deprecated name."""
    return METHODS[RENAMED.get(name, name)]


@cache
def decide_by(name: str) -> Decide:
    """Import and return the function of a method."""
    found: Decide = load(method_of(name).decide, f"decide of method {name}")
    return found


@cache
def first_of(name: str) -> Decide | None:
    """Import and return what a method asks of one start before, None where it asks nothing."""
    first = method_of(name).first
    return load(first, f"first of method {name}") if first else None
