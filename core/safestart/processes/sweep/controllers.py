"""The controllers that a sweep flies, one line each. Light to import: a controller is loaded when it first flies."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from safestart.errors import invalid
from safestart.model.registry import by_name
from safestart.processes.wire import DT_S


@dataclass(frozen=True, slots=True)
class Offered:
    """A controller on offer.

    ``title`` names it in pictures and on pages, ``text`` describes it on the wire. ``make`` names the function,
    ``module:function``, from inputs, scenario, control interval (s), number of intervals and forecast nodes to the
    controller. ``dt``: its control interval, s, which divides 2 s. ``plan`` names the function, of the same arguments,
    that makes the tables of the filter's compiled loop; a controller without is flown one start after another.
    ``own_limit``: it minds the thrust limit itself; what others command beyond is cut to the limit.
    ``note`` is said of its flights in every result.
    """

    name: str
    title: str
    text: str
    make: str
    dt: float = DT_S
    plan: str = ""
    own_limit: bool = False
    note: str = ""

    def __post_init__(self) -> None:
        if not (self.dt > 0.0 and (DT_S / self.dt).is_integer()):
            raise invalid(f"dt of {self.name}", f"an interval that divides {DT_S:g} s", self.dt)


_HERE = "safestart.processes.sweep.fleet"
_ALL = (
    Offered("filter", "filter", "the paper's", f"{_HERE}:filter_of", plan=f"{_HERE}:plan_of", own_limit=True),
    Offered(
        *("filter_fine", "filter, 0.5 s", "the same commanded every 0.5 s", f"{_HERE}:filter_of"),
        dt=0.5,
        plan=f"{_HERE}:plan_of",
        own_limit=True,
    ),
    Offered(
        *("sequence", "sequence", "MPC over the whole thrust sequence", f"{_HERE}:sequence_of"),
        own_limit=True,
        note="the least impulse that keeps a margin; it may loiter. It is always checked at all times.",
    ),
)

CONTROLLERS = by_name("controllers", _ALL, lambda one: one.name)
TEXTS = "; ".join(f"{one.name}: {one.text}" for one in _ALL)
"""All of them in words."""

if TYPE_CHECKING:
    Controller = str
else:
    Controller = Literal[tuple(CONTROLLERS)]


def slow(names: Iterable[str]) -> bool:
    """Whether one of them is flown one start after another."""
    return not all(CONTROLLERS[name].plan for name in names)
