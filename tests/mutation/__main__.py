"""Does a test fail for every small error? ``python -m tests.mutation TARGET [--only TEXT] [--seconds N] [--seed N]``.

By hand: all mutants of a target take an hour and more. With ``--seconds`` those of a random order that fit are run; the
line at the end says how many. A mutant that survives is a missing test, or changes nothing that anyone can see: then
docs/mutation.md says why.
"""

from __future__ import annotations

import argparse
import pkgutil
from importlib import import_module

import pytest

from tests.mutation.running import Mutating

TARGETS = {
    "closed-form": (("safestart.closed_form",), ("tests/unit/closed_form", "tests/reference/test_table1.py")),
    "proofs": (("safestart.proofs",), ("tests/unit/proofs", "tests/unit/missed_burn")),
    "metrics": (
        ("safestart.model.metrics", "safestart.campaign"),
        ("tests/unit/model", "tests/unit/campaign"),
    ),
    "leases": (("safestart.store.queue", "safestart.store.jobs"), ("tests/contract/store",)),
}
"""Modules or packages, and the tests that should notice."""


def modules_of(name: str) -> list[str]:
    """The module, or all modules of the package."""
    module = import_module(name)
    if not hasattr(module, "__path__"):
        return [name]
    return [one.name for one in pkgutil.walk_packages(module.__path__, f"{name}.") if not one.ispkg]


def main() -> int:
    """Exit code 0: none survived."""
    parser = argparse.ArgumentParser(prog="python -m tests.mutation", description=__doc__)
    parser.add_argument("target", choices=sorted(TARGETS))
    parser.add_argument("--only", default="", metavar="TEXT", help="mutants whose line holds this text")
    parser.add_argument("--seconds", type=float, default=float("inf"))
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    packages, tests = TARGETS[asked.target]
    modules = [name for package in packages for name in modules_of(package)]
    plugin = Mutating(modules, asked.only, asked.seconds, asked.seed)
    options = ["-q", "-s", "--no-header", "-p", "no:cacheprovider", "-p", "no:xdist", "-m", "not slow"]
    pytest.main([*options, *tests], plugins=[plugin])
    found = plugin.counted
    print(
        f"{found.run} of {found.made} mutants run: {found.killed} killed ({found.late} by time), "
        f"{len(found.survived)} survived, {len(found.unreached)} in functions that no test of the target calls"
    )
    for line in sorted(found.unreached):
        print(f"unreached: {line}")
    return 1 if found.survived or found.unreached or not found.run else 0


if __name__ == "__main__":
    raise SystemExit(main())
