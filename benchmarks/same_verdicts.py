"""Random questions answered by the compiled solver and by Clarabel: the same verdicts, brackets that meet, proofs.

``python -m benchmarks.same_verdicts FILE [--cases N] [--seconds S] [--seed K] [--by-faces] [--proofs-every P]``
answers the cases of seed K from where FILE (JSON lines, one a block) ends, until N are done or S seconds are over.
Checking a proof takes six times as long as both answers, so P above 1 checks those of every P-th case. Progress goes
to stderr after every 20 blocks; at the end one JSON document sums up all blocks of the file. Questions are `stay` in
the plane and in space: thrust 1 mm/s^2 to 1 m/s^2, no tumble to 5 deg/s, with and without mean motion, 20 to 300 s,
corridors of slope 0.3 to 3, starts at rest in either frame or moving; with --by-faces every start is within a tenth
to a billionth of its distance from a face, where verdicts are close calls and Clarabel's path, which looks less
closely, leaves more open.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from safestart.exact import search
from safestart.exact.answer import GUARD, Answer, Verdict
from safestart.exact.decide import answer_of, decide, outside
from safestart.exact.prove import proof_of
from safestart.exact.question import Question
from safestart.exact.watch import watch_of
from safestart.model.scenario import Chaser, CorridorShape, Floats, Scenario, Target
from safestart.optim.largest_margin import SOLVED_BY, solve_by_cones
from safestart.proofs.single import check

BLOCK = 50
PROGRESS_BLOCKS = 20
SEED = 18
_ROUNDING_M = 1e-9


def drawn(number: int, seed: int = SEED, *, by_faces: bool = False) -> tuple[Question, Floats]:
    """Question and start ``number`` of ``seed``, anywhere or ``by_faces``; the same on every machine."""
    rng = np.random.default_rng([seed, number])
    d = 2 if rng.random() < 0.7 else 3
    rate = float(rng.choice([0.0, rng.uniform(0.01, 5.0)], p=[0.1, 0.9]))
    motion = float(rng.choice([0.0, rng.uniform(2e-4, 1.2e-3)], p=[0.1, 0.9]))
    shape = CorridorShape(c_x=float(rng.uniform(0.3, 3.0)), c_z=float(rng.uniform(0.3, 3.0)))
    thrust = 10.0 ** float(rng.uniform(-3.0, 0.0))
    scenario = Scenario(Target(math.radians(rate), motion), Chaser(thrust), shape)
    question = Question(scenario, float(rng.choice([1.0, 2.0, 4.0])), int(rng.choice([20, 30, 60, 75])), d)
    far = 10.0 ** float(rng.uniform(0.3, 2.5))
    state = np.zeros(2 * d)
    state[0], state[1] = far * shape.c_x * rng.uniform(-1.0, 1.0), far
    if d == 3:
        state[2] = far * shape.c_z * rng.uniform(-1.0, 1.0)
    kind = rng.integers(0, 3)
    if by_faces:
        side, wide = rng.choice([-1.0, 1.0]), shape.x0 + shape.c_x * (far - shape.hold_radius)
        state[0] = side * wide * (1.0 - 10.0 ** rng.uniform(-9.0, -1.0))
    if kind == 1:
        turn = scenario.target.tumble_rate
        state[d], state[d + 1] = -turn * state[1], turn * state[0]
    elif kind == 2:
        state[d:] = rng.normal(size=d) * 0.3
    return question, state


def by_clarabel(question: Question, state: Floats) -> Answer:
    """The same search with every program solved by Clarabel."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(search, "solve", solve_by_cones)
        found = search.Search(watch_of(question), state)
        if found.distance_now < -GUARD:
            return outside(found)
        return answer_of(found, found.narrow(1e-4))


def block(first: int, seed: int = SEED, proofs_every: int = 1, *, by_faces: bool = False) -> dict[str, Any]:
    """Cases ``first`` to ``first`` + ``BLOCK`` - 1: verdicts, what differs, proofs, times."""
    verdicts, before = Counter[str](), SOLVED_BY.copy()
    other: list[Any] = []
    rejected: list[Any] = []
    ours_s = cones_s = widest = 0.0
    checked = 0
    for number in range(first, first + BLOCK):
        question, state = drawn(number, seed, by_faces=by_faces)
        watch_of(question)
        begun = time.process_time()
        answer = decide(question, state)
        ours_s += time.process_time() - begun
        begun = time.process_time()
        theirs = by_clarabel(question, state)
        cones_s += time.process_time() - begun
        verdicts[f"{answer.verdict.value}/{theirs.verdict.value}"] += 1
        apart = max(answer.lower - theirs.upper, theirs.lower - answer.upper)
        if answer.verdict is not theirs.verdict or apart > _ROUNDING_M:
            other.append(
                [number, answer.verdict.value, answer.lower, answer.upper, theirs.lower, theirs.upper]
            )
        if answer.iterations:
            widest = max(widest, answer.gap)
        if answer.verdict is not Verdict.UNDECIDED and number % proofs_every == 0:
            checked += 1
            try:
                check(json.loads(json.dumps(proof_of(question, state, answer))))
            except Exception as error:  # a study lists what fails and goes on
                rejected.append([number, repr(error)])
    programs = dict(SOLVED_BY - before)
    return {
        "seed": seed,
        "first": first,
        "verdicts": verdicts,
        "other": other,
        "proofs_checked": checked,
        "proofs_rejected": rejected,
        "programs": programs,
        "widest_m": widest,
        "compiled_s": ours_s,
        "clarabel_s": cones_s,
    }


def study(
    file: Path, cases: int, seconds: float, seed: int = SEED, proofs_every: int = 1, *, by_faces: bool = False
) -> dict[str, Any]:
    """Go on with the file, then sum it up; ValueError where the file has blocks of another seed."""
    begun = time.monotonic()
    done = [json.loads(line) for line in file.read_text().splitlines()] if file.exists() else []
    if others := {one["seed"] for one in done} - {seed}:
        raise ValueError(f"{file} must hold blocks of seed {seed} only, but has some of {sorted(others)}")
    while len(done) * BLOCK < cases and time.monotonic() - begun < seconds:
        done.append(block(len(done) * BLOCK, seed, proofs_every, by_faces=by_faces))
        with file.open("a") as out:
            out.write(json.dumps(done[-1]) + "\n")
        if len(done) % PROGRESS_BLOCKS == 0:
            print(_progress(done, cases, time.monotonic() - begun), file=sys.stderr, flush=True)
    return summed(done)


def _progress(done: list[dict[str, Any]], cases: int, spent: float) -> str:
    other = sum(len(one["other"]) for one in done)
    rejected = sum(len(one["proofs_rejected"]) for one in done)
    return (
        f"{len(done) * BLOCK} of {cases} cases, {other} differ, {rejected} proofs rejected, "
        f"{spent:.0f} s in this run"
    )


def summed(done: list[dict[str, Any]]) -> dict[str, Any]:
    """One document over blocks: verdicts, the cases that differ, rejected proofs, who solved the programs, times."""
    verdicts, programs = Counter[str](), Counter[str]()
    for one in done:
        verdicts.update(one["verdicts"])
        programs.update(one["programs"])
    return {
        "cases": len(done) * BLOCK,
        "verdicts_compiled_and_clarabel": dict(verdicts),
        "other": [case for one in done for case in one["other"]],
        "proofs_checked": sum(one["proofs_checked"] for one in done),
        "proofs_rejected": [case for one in done for case in one["proofs_rejected"]],
        "programs": dict(programs),
        "widest_bracket_m": max((one["widest_m"] for one in done), default=None),
        "cpu_s": {
            "compiled": sum(one["compiled_s"] for one in done),
            "clarabel": sum(one["clarabel_s"] for one in done),
        },
    }


def main() -> None:
    """Answer what is still to be answered, and print the sum."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("file", type=Path)
    parser.add_argument("--cases", type=int, default=100_000)
    parser.add_argument("--seconds", type=float, default=math.inf)
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--by-faces", action="store_true")
    parser.add_argument("--proofs-every", type=int, default=1)
    chosen = parser.parse_args()
    done = study(
        chosen.file, chosen.cases, chosen.seconds, chosen.seed, chosen.proofs_every, by_faces=chosen.by_faces
    )
    print(json.dumps(done, indent=1))


if __name__ == "__main__":
    main()
