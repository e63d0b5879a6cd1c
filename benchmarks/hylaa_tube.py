"""Our tubes beside those of another tool: ``uv run --with hylaa==2.0.2 --with swiglpk==5.0.8 python -m
benchmarks.hylaa_tube``. About a minute; hylaa is no dependency, it is installed for this run only.

hylaa moves sets by linear programs from step to step: no enclosure between steps, and exact at them. Compared is
mode 1, up to the guard. It switches at the ends of steps only, which leaves nothing exact to compare with behind it.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from benchmarks.asked import parser
from safestart.model.scenario import Floats
from safestart.passive_safety.model import Mode, Motion, matrix
from safestart.passive_safety.question import Question
from safestart.passive_safety.reach.reach_set import reach
from safestart.passive_safety.reach.tube import Tube
from safestart.passive_safety.switching_guard import GAP_GUARD

if TYPE_CHECKING:
    from hylaa.stateset import StateSet

ROWS = np.vstack([np.eye(4), -np.eye(4)])
STEP, PERIOD = 1.0 / 80.0, 0.2
"""Steps of hylaa, and the periods that are compared, min."""


def explore(centre: Floats, gens: Floats, end: float) -> Iterator[Floats]:
    """Supports (8,) of :data:`ROWS` at hylaa's steps of mode 1, until ``end`` (min)."""
    # Imported here: the help is there without hylaa, too.
    from hylaa import lputil
    from hylaa.core import Core
    from hylaa.hybrid_automaton import HybridAutomaton
    from hylaa.settings import HylaaSettings
    from hylaa.stateset import StateSet

    automaton = HybridAutomaton()
    far = automaton.new_mode(Mode.FAR.value)
    far.set_dynamics(matrix(Motion(Mode.FAR)))
    # Every start of the question crosses the face x = -100, and no other.
    far.set_invariant([[1.0, 0.0, 0.0, 0.0]], [-GAP_GUARD])
    settings = HylaaSettings(STEP, end)
    settings.stdout = HylaaSettings.STDOUT_NONE
    core = Core(automaton, settings)
    core.setup([StateSet(lputil.from_zonotope(centre, gens.tolist(), far), far)])
    while not core.is_finished():
        state = core.aggdag.get_cur_state()
        if state is not None:
            yield supports(state)
        core.do_step()


def supports(state: StateSet) -> Floats:
    """Greatest values (8,) of :data:`ROWS` over one of hylaa's sets."""
    place = state.lpi.cur_vars_offset
    return np.array([row @ state.lpi.minimize(-row)[place : place + 4] for row in ROWS])


def widest(sets: Floats, each: int) -> Floats:
    """Greatest supports (n, 8) over periods of ``each`` steps, of ``sets`` (n each + 1, 8) at the steps."""
    return np.array([sets[k : k + each + 1].max(axis=0) for k in range(0, len(sets) - 1, each)])


def ours(tubes: tuple[Tube, ...], first: float, last: float, length: float) -> Floats:
    """Bounds (n, 8) of our tubes over periods of ``length`` between ``first`` and ``last`` (min)."""
    upper = np.concatenate([tube.upper(ROWS) for tube in tubes])
    starts = np.concatenate([tube.start + tube.step * np.arange(tube.steps) for tube in tubes])
    begins = first + length * np.arange(round((last - first) / length))
    inside = [(starts > begin - 1e-9) & (starts < begin + length - 1e-9) for begin in begins]
    return np.array([upper[mask].max(axis=0) for mask in inside])


def compare(mine: Floats, theirs: Floats) -> bool:
    """Print how far their sets leave ours, and how much wider ours are; whether it is more than it may be."""
    outside = (theirs - mine).max(axis=0).reshape(2, 4).max(axis=0)
    ratio = (mine[:, :4] + mine[:, 4:]) / (theirs[:, :4] + theirs[:, 4:]) - 1.0
    print(f"mode 1, {len(mine)} periods; x, y, vx, vy in m, m/min")
    print("  theirs outside ours ", *(f"{value:9.2g}" for value in outside))
    print("  ours wider, largest ", *(f"{value:9.3%}" for value in ratio.max(axis=0)))
    print("  ours wider, median  ", *(f"{value:9.3%}" for value in np.median(ratio, axis=0)))
    return bool(ratio.max() > 0.05 or outside.max() > 1e-9)


def main() -> int:
    """Compare the tubes of the flight without failure; 1 if a set of theirs leaves ours or ours are 5 percent wider."""
    question = Question()
    tubes = reach(question)
    centre, gens = question.set()
    last = PERIOD * int(tubes.entry.first / PERIOD)
    theirs = np.array(list(explore(centre, gens, last)))
    return int(compare(ours((tubes.far,), 0.0, last, PERIOD), widest(theirs, round(PERIOD / STEP))))


if __name__ == "__main__":
    parser(__doc__).parse_args()
    sys.exit(main())
