"""Mutants of every kind of document by the hundred thousand: ``python -m tests.fuzzing --number 100000``.

Ends with 1 if one was accepted whose printed statement is false.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Iterable, Iterator
from functools import partial
from typing import Any

from tests.fuzzing.documents import KINDS, run
from tests.fuzzing.files import FILES

_EVERY_S = 30.0


def _told(kind: str, number: int, made: Iterable[Any]) -> Iterator[Any]:
    """The mutants, with a line on stderr now and then: how many there were, and how long the rest takes."""
    begun = last = time.monotonic()
    for k, mutant in enumerate(made):
        yield mutant
        now = time.monotonic()
        if now - last > _EVERY_S:
            last = now
            left = (now - begun) / (k + 1) * (number - k - 1)
            sys.stderr.write(f"{kind}: {k + 1} of {number}, {left / 60:.0f} min left\n")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    every = (*KINDS, *FILES)
    parser.add_argument("kinds", nargs="*", default=every, help=f"of {', '.join(every)}; all by default")
    parser.add_argument("--number", type=int, default=100_000, help="mutants of each kind")
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    wrong = 0
    for kind in asked.kinds:
        begun = time.monotonic()
        found = (
            FILES[kind](asked.number, asked.seed)
            if kind in FILES
            else run(
                kind, asked.number, asked.seed, remembering=True, watched=partial(_told, kind, asked.number)
            )
        )
        sys.stdout.write(f"{kind}: {asked.number} mutants in {time.monotonic() - begun:.0f} s\n")
        for outcome, count in sorted(found.outcomes.items()):
            sys.stdout.write(f"  {outcome:<40}{count:>8}\n")
        for done, mutant in [*found.false, *found.open][:20]:
            sys.stdout.write(f"  {done}: {json.dumps(mutant)[:300]}\n")
        sys.stdout.flush()
        wrong += len(found.false)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
