"""Run the tests that reach a mutant, each mutant in a process forked after the tests were collected.

Whatever the collecting process has imported stays as it was: it runs no test, so no cache holds an answer of the
unchanged code.
"""

from __future__ import annotations

import builtins
import contextlib
import importlib
import inspect
import json
import os
import random
import select
import signal
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import FunctionType
from typing import Any

import pytest

from tests.mutation.mutants import Mutant, mutants, probed

ROOT = Path(__file__).resolve().parents[2]
Tests = list[tuple[int, float]]
"""Places of tests among those collected, with the seconds that each takes."""
Owners = dict[str, dict[str, FunctionType]]
"""Functions by their path within a module, by module."""
MOST_TEST_S = 15.0
"""Tests of a mutant, quickest first, until they have taken this long without a failure."""


@dataclass
class Counted:
    """What became of the mutants; ``unreached`` lists those in functions that no test calls."""

    made: int = 0
    run: int = 0
    killed: int = 0
    late: int = 0
    survived: list[str] = field(default_factory=list)
    unreached: list[str] = field(default_factory=list)


class Mutating:
    """A pytest plugin: runs mutants in place of the tests."""

    def __init__(self, modules: Sequence[str], only: str, seconds: float, seed: int) -> None:
        self._modules, self._only = modules, only
        self._seconds, self._seed = seconds, seed
        self.counted = Counted()

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        """All of it; the seconds count from the moment when it is known which tests call which function."""
        owners = {name: _functions_of(name) for name in self._modules}
        reached = self._reached(session, owners)
        todo = list(self._mutants(owners))
        self.counted.made = len(todo)
        random.Random(self._seed).shuffle(todo)
        end = time.monotonic() + self._seconds
        for mutant, function in todo:
            if time.monotonic() > end:
                break
            self._run(session, mutant, function, reached.get(mutant.key, []))
        return True

    def _run(self, session: pytest.Session, mutant: Mutant, function: FunctionType, tests: Tests) -> None:
        found = self.counted
        found.run += 1
        if not tests:
            found.unreached.append(str(mutant))
            return
        limit = 3.0 * sum(one for _, one in tests) + 20.0
        said = _forked(lambda: _killed(session, mutant, function, tests), limit)
        if said == "survived":
            found.survived.append(str(mutant))
            print(f"survived: {mutant}", flush=True)
        else:
            found.killed += 1
            found.late += said is None

    def _mutants(self, owners: Owners) -> Iterator[tuple[Mutant, FunctionType]]:
        for name, functions in owners.items():
            path = Path(sys.modules[name].__file__ or "")
            for mutant in mutants(path, str(path.relative_to(ROOT))):
                function = functions.get(mutant.name)
                if self._only in str(mutant) and function is not None and not function.__closure__:
                    yield mutant, function

    def _reached(self, session: pytest.Session, owners: Owners) -> dict[str, Tests]:
        """By function: tests that call it with the seconds that each takes, quickest first."""
        said = _forked(lambda: _map(session, owners), 3600.0)
        if said is None:
            raise RuntimeError("the tests did not end")
        out: dict[str, Tests] = {}
        for index, (seconds, passed, calls) in enumerate(json.loads(said)):
            for key in calls if passed else []:
                out.setdefault(key, []).append((index, seconds))
        return {key: _quickest(tests) for key, tests in out.items()}


def _quickest(tests: Tests) -> Tests:
    out, total = [], 0.0
    for index, seconds in sorted(tests, key=lambda one: one[1]):
        total += seconds
        if out and total > MOST_TEST_S:
            break
        out.append((index, seconds))
    return out


def _functions_of(name: str) -> dict[str, FunctionType]:
    """Functions written in the module, its methods and properties, by their path within it."""
    module, found = importlib.import_module(name), {}

    def look(owner: Any) -> None:
        for value in list(vars(owner).values()):
            if inspect.isclass(value) and value.__module__ == name and value is not owner:
                look(value)
            for one in (value, *(getattr(value, part, None) for part in ("fget", "__func__", "__wrapped__"))):
                one = inspect.unwrap(one) if callable(one) and not inspect.isclass(one) else one
                if isinstance(one, FunctionType) and one.__module__ == name:
                    found[one.__qualname__] = one

    look(module)
    return found


def _map(session: pytest.Session, owners: Owners) -> str:
    """Seconds, success and called functions of every test, as JSON; runs in a process of its own."""
    calls: set[str] = set()
    builtins.reached = lambda file, name: calls.add(f"{file} {name}")  # type: ignore[attr-defined]
    for name, functions in owners.items():
        for one, code in probed(Path(sys.modules[name].__file__ or "")):
            if one in functions and not functions[one].__closure__:
                functions[one].__code__ = code
    failures, out = _failures(session), []
    for number, item in enumerate(session.items):
        calls.clear()
        failures.clear()
        began = time.perf_counter()
        _run(session, item, session.items[number + 1 : number + 2])
        out.append((time.perf_counter() - began, not failures, sorted(calls)))
    return json.dumps(out)


def _killed(session: pytest.Session, mutant: Mutant, function: FunctionType, tests: Tests) -> str:
    code = mutant.code()
    assert code is not None
    function.__code__ = code
    failures = _failures(session)
    items = [session.items[index] for index, _ in tests]
    for number, item in enumerate(items):
        _run(session, item, items[number + 1 : number + 2])
        if failures:
            return f"killed by {item.nodeid}"
    return "survived"


def _run(session: pytest.Session, item: pytest.Item, following: list[pytest.Item]) -> None:
    item.ihook.pytest_runtest_protocol(item=item, nextitem=following[0] if following else None)


def _failures(session: pytest.Session) -> list[str]:
    found: list[str] = []

    class Listening:
        def pytest_runtest_logreport(self, report: Any) -> None:
            if report.failed:
                found.append(report.nodeid)

    session.config.pluginmanager.register(Listening())
    return found


def _forked(work: Callable[[], str], limit: float) -> str | None:
    """What ``work`` returns in a forked process; None after ``limit`` seconds or without an answer."""
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        os.setsid()
        quiet = os.open(os.devnull, os.O_WRONLY)
        os.dup2(quiet, 1)
        os.dup2(quiet, 2)
        try:
            with os.fdopen(write, "w") as out:
                out.write(work())
        except BaseException:
            os._exit(1)
        os._exit(0)
    os.close(write)
    said, end = b"", time.monotonic() + limit
    while (left := end - time.monotonic()) > 0 and select.select([read], [], [], left)[0]:
        part = os.read(read, 65536)
        if not part:
            break
        said += part
    os.close(read)
    with contextlib.suppress(ProcessLookupError):
        os.killpg(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return said.decode() or None
