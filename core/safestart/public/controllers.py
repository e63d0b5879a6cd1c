"""`controller`: our controllers for any simulator, one command at a time."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal

import numpy as np

from safestart.control.controller import Command, Controller
from safestart.errors import invalid
from safestart.exact.question import MAX_STEPS, Question
from safestart.model.float_array import float_array
from safestart.model.scenario import Floats, Scenario, number
from safestart.simulation.starts import steps_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

Name = Literal["filter", "sequence"]
NODES = 6
LONGEST = 1e6
"""Longest flight, s."""


class Pilot:
    """A controller of ours: begin a flight, then ask for a command in every interval of ``dt_s`` seconds.

    It knows only the given state, so any simulator can fly its commands. The target's body frame
    coincides with LVLH at interval 0.
    """

    def __init__(self, name: str, inner: Controller, dt_s: float, steps: int) -> None:
        self.name, self.dt_s, self.steps = name, dt_s, steps
        self._inner = inner
        self._begun = False

    def begin(self, state: ArrayLike) -> None:
        """A new flight starts at the LVLH ``state`` (6,), m and m/s."""
        self._inner.begin(_state(state))
        self._begun = True

    def command(self, k: int, state: ArrayLike) -> Command:
        """The command for interval ``k`` (from 0) and the LVLH ``state`` (6,), m and m/s.

        Hold its ``thrust`` (3,), m/s², LVLH, until the next interval; ``feasible`` is False when the controller found
        no admissible command and gives its best; ``label`` names its mode. Raises ``InvalidInput`` for an interval
        outside [0, steps), a state of another shape, and before :meth:`begin`.
        """
        if not self._begun:
            raise invalid("command", "begin(state) before the first command", "none")
        if isinstance(k, bool) or not isinstance(k, int | np.integer) or not 0 <= k < self.steps:
            raise invalid("k", f"an integer in [0, {self.steps})", k)
        return self._inner.command(int(k), _state(state))


def controller(
    name: Name, scenario: Scenario, *, duration_s: float = 60.0, dt_s: float = 2.0, spatial: bool = False
) -> Pilot:
    """A controller for flights of ``duration_s`` seconds with a command every ``dt_s`` seconds.

    ``filter``: three regimes and the safety filter of paper 000, in the plane or in space (``spatial``). ``sequence``:
    model predictive control over the whole thrust sequence, in the plane; if the exact answer is GO it keeps the
    corridor at all times. Raises ``InvalidInput`` for another name or a duration out of range.
    """
    duration_s = number("duration_s", duration_s, 0.0, LONGEST, open_low=True)
    dt_s = number("dt_s", dt_s, 0.0, LONGEST, open_low=True)
    steps = steps_of(duration_s, dt_s)
    if name == "sequence":
        if spatial:
            raise invalid("spatial", "False: sequence flies in the orbit plane", spatial)
        if steps > MAX_STEPS:
            raise invalid("duration_s", f"at most {MAX_STEPS} intervals of dt_s", duration_s)
        from safestart.control.sequence_mpc import SequenceMpc

        return Pilot(name, SequenceMpc(Question(scenario, dt_s, steps)), dt_s, steps)
    if name == "filter":
        from safestart.control.forecast import flight_plan
        from safestart.control.gains import TUNED
        from safestart.control.three_regimes import ThreeRegimes

        # It looks 12 s ahead at any interval.
        nodes = max(1, math.ceil(2.0 * NODES / dt_s))
        plan = flight_plan(scenario, TUNED, dt_s, steps, nodes=nodes, planar=not spatial)
        return Pilot(name, ThreeRegimes(plan), dt_s, steps)
    raise invalid("name", "filter or sequence", name)


def _state(state: ArrayLike) -> Floats:
    try:
        found = float_array(state)
    except (TypeError, ValueError, OverflowError):
        raise invalid("state", "numbers, shape (6,): LVLH position in m and velocity in m/s", state) from None
    if found.shape != (6,):
        raise invalid("state", "shape (6,): LVLH position in m and velocity in m/s", found.shape)
    if not np.isfinite(found).all():
        raise invalid("state", "finite numbers", found.tolist())
    return found
