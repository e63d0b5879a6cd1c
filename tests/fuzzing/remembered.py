"""Checkers that remember: a mutant differs from others in one place, so that most of it was checked before.

Kept is what a checker finds of a part of a document that depends on nothing else: a case of a missed-burn proof under
one statement, a tube, an attitude's course, what an interval does. :mod:`tests.fuzzing.test_documents` compares with
checks from nothing. Only the long run uses this.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import pytest

from safestart.proofs import disturbed
from safestart.proofs.abort import check as abort
from safestart.proofs.abort.complete import Complete
from safestart.proofs.abort.statement import Asked
from safestart.proofs.disturbed_statement import StatedDisturbed
from safestart.proofs.space import check as space
from safestart.proofs.space import refute
from safestart.proofs.space.motion import Motion
from safestart.proofs.space.orbit import Orbit
from safestart.proofs.space.statement import SpaceStated
from safestart.proofs.strict import ProofRejected

_MOST = 5_000


@contextmanager
def remembered() -> Iterator[None]:
    """Within this the checkers look up what they have seen."""
    with pytest.MonkeyPatch.context() as patch:
        for kind in (abort.Checker, abort.EarthChecker):
            patch.setattr(abort, kind.__name__, _checkers(kind))
        patch.setattr(disturbed, "_require_tube", _kept(disturbed._require_tube, _of_tube))
        orbits: dict[int, str] = {}

        def orbit(*numbers: Any) -> Orbit:
            made: Orbit = once(*numbers)
            orbits[id(made)] = repr(numbers)
            return made

        def of_course(stated: SpaceStated, around: Orbit) -> str:
            return repr((stated.dt, stated.steps, stated.attitude, orbits[id(around)]))

        def of_interval(motion: Motion, k: int) -> str:
            return repr((motion.dt, k, orbits[id(motion.orbit)]))

        # Every orbit is kept: its number is its name.
        once = _kept(space.Orbit, lambda *numbers: repr(numbers), most=None)
        patch.setattr(space, "Orbit", orbit)
        patch.setattr(space, "Course", _kept(space.Course, of_course))
        patch.setattr(refute, "Held", _kept(refute.Held, of_interval))
        yield


def _kept(made: Callable[..., Any], name: Callable[..., str], most: int | None = _MOST) -> Any:
    """``made`` as a function that looks its value, or its refusal, up by the name of its arguments."""
    ends: OrderedDict[str, Any] = OrderedDict()

    def look(*given: Any) -> Any:
        called = name(*given)
        if called not in ends:
            if most is not None and len(ends) >= most:
                ends.popitem(last=False)
            try:
                ends[called] = made(*given)
            except ProofRejected as error:
                ends[called] = error
        ends.move_to_end(called)
        end = ends[called]
        if isinstance(end, ProofRejected):
            raise ProofRejected(str(end))
        return end

    return look


def _of_tube(stated: StatedDisturbed) -> str:
    plan = stated.plan
    return repr((plan.d, plan.n, plan.w, plan.dt, plan.steps, replace(stated, plan=None)))  # type: ignore[arg-type]


def _checkers(kind: type[Complete]) -> Any:
    """Checkers of one kind, one for each statement; their cases are looked up by all that they say."""

    def begun(asked: Asked) -> Complete:
        checker = kind(asked)
        checker.held = _kept(checker.held, repr)  # type: ignore[method-assign]
        return checker

    once = _kept(begun, lambda asked: repr(replace(asked, events=[])), most=16)

    def of(asked: Asked) -> Complete:
        checker: Complete = once(asked)
        checker.asked = asked
        return checker

    return of
