"""The level set's own error, measured: exact inner and outer sets by support functions, counted against its cells.

The motion is linear and the input a disk, so that membership of a start needs no grid (:mod:`safestart.engines.exact`).
Its margin is known to ``TOLERANCE`` where it decides: a start with more is in the set, a start with less than
minus that is not. The exact set takes the motion as it is; the body frame's level set drops a term, and what that costs
is counted with the grid's error.
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
    """The exact set of the same problem, computed in silence; it still stops when the job is dismissed."""
    return Exact().solve(problem, Context(cancelled=context.cancelled))


def count_errors(problem: Problem, settings: Settings, field: Floats, exact: EngineResult) -> dict[str, Any]:
    """What of ``field`` (ny, nx; a start is called safe where it is >= 0) the exact sets refute, JSON-able.

    ``false_safe`` counts starts called safe that are outside the outer set, ``false_unsafe`` starts of the inner
    set that are not called safe; once ``in_corridor``, once over the whole ``grid``. Of a velocity-aware target the
    position-only set is an outer bound only: ``inner`` and ``false_unsafe`` are None. All is None where the exact
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
