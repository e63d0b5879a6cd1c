"""Measure the level set's error: compare its cells with exact inner and outer sets by support functions.

The motion is linear and the input a disk, so membership of a start needs no grid (:mod:`safestart.engines.exact`). Its
margin is known to ``TOLERANCE`` near zero: a start above it is in the set, a start below its negative is not. The exact
set uses the full motion; the body frame's level set drops a term, and that error counts with the grid's.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from safestart.engines.base import EngineResult, Problem, ResultCode
from safestart.engines.exact import Exact
from safestart.engines.hj.settings import Settings
from safestart.model.scenario import Bools, Floats
from safestart.runtime.progress import Context

TOLERANCE = 1e-6
"""Metres; margins near zero are good to 1e-7."""


def exact_answer(problem: Problem, context: Context) -> EngineResult:
    """The exact set of the same problem, without progress reports; it still stops when the job is dismissed."""
    return Exact().solve(problem, Context(cancelled=context.cancelled))


def count_errors(problem: Problem, settings: Settings, field: Floats, exact: EngineResult) -> dict[str, Any]:
    """Errors of ``field`` (ny, nx; a start is called safe where it is >= 0) that the exact sets prove, JSON-able.

    ``false_safe`` counts starts called safe that are outside the outer set, ``false_unsafe`` starts of the inner
    set that are not called safe; once ``in_corridor``, once over the whole ``grid``. For a velocity-aware target the
    position-only set is only an outer bound: ``inner`` and ``false_unsafe`` are None. All values are None if the exact
    computation failed.
    """
    if exact.code is not ResultCode.OK:
        return {"method": "support functions", "in_corridor": None, "grid": None, "message": exact.message}
    margin = exact.arrays["margin_unrestricted"]
    inner, outer = margin > TOLERANCE, margin >= -TOLERANCE
    everywhere = np.ones_like(outer)
    position_only = settings.match is None

    def counts(where: Bools) -> dict[str, int | None]:
        safe = field >= 0.0
        return {
            "inner": int((inner & where).sum()) if position_only else None,
            "outer": int((outer & where).sum()),
            "false_safe": int((safe & ~outer & where).sum()),
            "false_unsafe": int((inner & ~safe & where).sum()) if position_only else None,
        }

    return {
        "method": "support functions",
        "tolerance_m": TOLERANCE,
        "in_corridor": counts(problem.inside()),
        "grid": counts(everywhere),
    }
