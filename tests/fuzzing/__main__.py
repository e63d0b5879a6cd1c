"""Mutants of every kind of document by the hundred thousand: ``python -m tests.fuzzing --number 100000``.

Ends with 1 if one was accepted whose printed statement is false.
"""

from __future__ import annotations

import argparse
import json
import sys
import time

from tests.fuzzing.documents import KINDS, run
from tests.fuzzing.files import FILES


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
            FILES[kind](asked.number, asked.seed) if kind in FILES else run(kind, asked.number, asked.seed)
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
