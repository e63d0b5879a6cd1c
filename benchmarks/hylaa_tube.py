"""Our tubes beside those of another tool: ``uv run --with hylaa==2.0.2 --with swiglpk==5.0.8 python -m
benchmarks.hylaa_tube``. About a minute; hylaa is no dependency, it is installed for this run only.

hylaa moves sets by linear programs from step to step, and lets the part of a set that is inside the guard switch at the
end of a step, each part followed by itself: no first-order crossing, no enclosure between steps. Its mode 1 is exact at
its steps. Its starts switch late by less than a step: its mode 2 may leave ours by as far as they fly meanwhile.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator

import numpy as np
from hylaa import lputil
from hylaa.aggstrat import Unaggregated
from hylaa.core import Core
from hylaa.hybrid_automaton import HybridAutomaton
from hylaa.settings import HylaaSettings
from hylaa.stateset import StateSet
from scipy.linalg import expm

from safestart.scenario import Floats
from safestart.verification.guard import GAP_GUARD
from safestart.verification.model import Mode, Motion, matrix
from safestart.verification.question import Question
from safestart.verification.reach import reach
from safestart.verification.tube import Tube

ROWS = np.vstack([np.eye(4), -np.eye(4)])
FAR_STEP, SWITCH_STEP = 1.0 / 80.0, 1.0 / 400.0
"""Steps of hylaa, min: up to the guard, and around it."""

SAMPLE = 1.0 / 20.0
"""Times since the switch at which its mode 2 is looked at, min."""

NEAR_END, PERIOD = 2.0, 0.1
"""How long mode 2 is compared, and in which periods, min: what is fast in it is over then."""


def explore(
    centre: Floats, gens: Floats, step: float, end: float, samples: Iterable[int]
) -> Iterator[tuple[str, int, Floats]]:
    """Mode, step in it, supports (8,) of :data:`ROWS`: all steps of mode 1, ``samples`` of every branch of mode 2."""
    automaton = HybridAutomaton()
    far, near = (automaton.new_mode(mode.value) for mode in (Mode.FAR, Mode.NEAR))
    far.set_dynamics(matrix(Motion(Mode.FAR)))
    near.set_dynamics(matrix(Motion(Mode.NEAR)))
    # Every start of the question crosses the face x = -100, and no other.
    far.set_invariant([[1.0, 0.0, 0.0, 0.0]], [-GAP_GUARD])
    automaton.new_transition(far, near).set_guard([[-1.0, 0.0, 0.0, 0.0]], [GAP_GUARD])
    settings = HylaaSettings(step, end)
    settings.stdout = HylaaSettings.STDOUT_NONE
    settings.aggstrat = Unaggregated()
    core = Core(automaton, settings)
    core.setup([StateSet(lputil.from_zonotope(centre, gens.tolist(), far), far)])
    while not core.is_finished():
        state = core.aggdag.get_cur_state()
        if state is not None and state.mode is near:
            for sample in samples:
                state.step(sample)
                yield near.name, sample, supports(state)
            core.aggdag.cur_state_left_invariant()
            continue
        if state is not None:
            yield far.name, state.cur_step_in_mode, supports(state)
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


def compare(what: str, mine: Floats, theirs: Floats, late: float = 0.0) -> bool:
    """Print how far their sets leave ours, and how much wider ours are; whether it is more than it may be."""
    outside = (theirs - mine).max(axis=0).reshape(2, 4).max(axis=0)
    ratio = (mine[:, :4] + mine[:, 4:]) / (theirs[:, :4] + theirs[:, 4:]) - 1.0
    print(f"{what}, {len(mine)} periods; x, y, vx, vy in m, m/min")
    print("  theirs outside ours ", *(f"{value:9.2g}" for value in outside))
    print("  ours wider, largest ", *(f"{value:9.3%}" for value in ratio.max(axis=0)))
    print("  ours wider, median  ", *(f"{value:9.3%}" for value in np.median(ratio, axis=0)), flush=True)
    return bool(ratio.max() > 0.05 or outside.max() > 1e-9 + late)


def main() -> int:
    """Compare the tubes of the flight without failure; 1 if a set of theirs leaves ours or ours are 5 percent wider."""
    question = Question()
    tubes = reach(question)
    (branch,) = tubes.branches
    centre, gens = question.set()
    last = 0.2 * int(tubes.entry.first / 0.2)
    far = np.array([values for _, _, values in explore(centre, gens, FAR_STEP, last, ())])
    failed = compare("mode 1", ours((tubes.far,), 0.0, last, 0.2), widest(far, round(0.2 / FAR_STEP)))

    motion = expm(matrix(Motion(Mode.FAR)) * last)
    each, end = round(SAMPLE / SWITCH_STEP), round(NEAR_END / SAMPLE)
    near: dict[int, Floats] = {}
    samples = [each * k for k in range(end + 1)]
    around = explore(motion @ centre, gens @ motion.T, SWITCH_STEP, tubes.entry.last - last + 0.2, samples)
    for mode, step, values in around:
        if mode == Mode.NEAR.value:
            near[step] = np.maximum(values, near.get(step, -np.inf))
    theirs = widest(np.array([near[step] for step in sorted(near)]), round(PERIOD / SAMPLE))
    # Nobody is faster than 6 m/min at the switch, and mode 2 only brakes.
    failed |= compare("mode 2", ours(branch.tubes, 0.0, NEAR_END, PERIOD), theirs, 6.0 * SWITCH_STEP)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
