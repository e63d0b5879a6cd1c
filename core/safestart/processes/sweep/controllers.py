"""The controllers that a sweep flies, one line each. Light to import: a controller is loaded when it first flies."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from safestart.processes.wire import DT_S


@dataclass(frozen=True, slots=True)
class Offered:
    """A controller on offer.

    ``title`` names it in pictures and on pages, ``text`` describes it on the wire. ``make`` names the function,
    ``module:function``, from inputs, scenario, control interval (s), number of intervals and forecast nodes to the
    controller. ``dt``: its control interval, s, which divides 2 s. ``compiled``: the filter's compiled loop can fly it;
    the others are flown one start after another. ``note`` is said of its flights in every result.
    """

    name: str
    title: str
    text: str
    make: str
    dt: float = DT_S
    compiled: bool = False
    note: str = ""


_HERE = "safestart.processes.sweep.fleet"
_ALL = (
    Offered("filter", "filter", "the paper's", f"{_HERE}:filter_of", compiled=True),
    Offered(
        *("filter_fine", "filter, 0.5 s", "the same commanded every 0.5 s", f"{_HERE}:filter_of"),
        dt=0.5,
        compiled=True,
    ),
    Offered(
        *("sequence", "sequence", "MPC over the whole thrust sequence", f"{_HERE}:sequence_of"),
        note="the least impulse that keeps a margin; it may loiter. It is always checked at all times.",
    ),
)

CONTROLLERS = {one.name: one for one in _ALL}
TEXTS = "; ".join(f"{one.name}: {one.text}" for one in _ALL)
"""All of them in words."""

if TYPE_CHECKING:
    Controller = str
else:
    Controller = Literal[tuple(CONTROLLERS)]


def slow(names: Iterable[str]) -> bool:
    """Whether one of them is flown one start after another."""
    return not all(CONTROLLERS[name].compiled for name in names)
