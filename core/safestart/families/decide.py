"""Go or no-go for all members of a family: proved for every parameter of the intervals and every start of the box.

The middle member sets the direction of the search. If it is GO, the search looks for one history that stays for every
member; if it is NO_GO, for multipliers that refute every member, on pieces of the rates' interval. Otherwise the answer
is UNDECIDED, with two members that differ or with the obstacle.
"""

from __future__ import annotations

import math

import numpy as np

from safestart.errors import invalid
from safestart.exact.answer import Verdict
from safestart.exact.decide import decide
from safestart.families.answer import TOLERANCE, ForAll, Witness
from safestart.families.best_member import no_history
from safestart.families.common import one_history
from safestart.families.members import Family
from safestart.model.scenario import Floats, number


def decide_for_all(
    family: Family, state: Floats, *, witness: Witness = "common", tolerance: float = TOLERANCE
) -> ForAll:
    """Answer `stay` for every member of ``family``; ``state`` (2 d,) is the middle of the start box, LVLH.

    ``witness`` sets the evidence for a GO: ``common``, one history for all, or ``per_corner``, one for each corner of
    the start box (all parameters). The margin is narrowed to ``tolerance`` m if the nodes allow it. Raises
    ``InvalidInput`` as :func:`~safestart.exact.decide.decide` does.
    """
    if witness not in ("common", "per_corner"):
        raise invalid("witness", "common or per_corner", witness)
    number("tolerance", tolerance, 1e-6, 1e3)
    state = np.asarray(state, dtype=np.float64)
    middle = decide(family.question, state, verdict_only=True)
    if middle.verdict is Verdict.GO:
        return one_history(family, state, middle, witness, tolerance)
    if middle.verdict is Verdict.NO_GO:
        return no_history(family, state, middle, witness)
    reason = f"the middle of the sets is undecided: {middle.reason}"
    return ForAll(Verdict.UNDECIDED, math.nan, math.inf, witness, reason=reason)
