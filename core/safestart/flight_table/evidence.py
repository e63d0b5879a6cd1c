"""The proofs behind an atlas in a table, each checked before a byte is written."""

from __future__ import annotations

from typing import Any

import numpy as np

from safestart.exact.answer import GUARD, Answer, Multiplier, Verdict
from safestart.exact.prove import proof_of
from safestart.flight_table.numbers import Point
from safestart.proofs.checker import check

_BEYOND_M = 0.5
"""How far beyond a ceiling's zero the start lies whose NO_GO is proved by its multipliers."""


def proofs_of(point: Point) -> list[dict[str, Any]]:
    """A GO for the centre and every corner of the rim, a NO_GO for every ceiling; raises ``ProofRejected``.

    Convex combinations of the first give every GO of the table (docs/theory/atlas.md). The multipliers of the second
    do not depend on the start: each bounds every start's margin by the ceiling that the table holds.
    """
    atlas = point.atlas
    documents = []
    for witness in (atlas.centre, *atlas.rim):
        if witness.margin > GUARD:
            answer = Answer(Verdict.GO, witness.margin, witness.margin, np.inf, witness.thrust, (), 0)
            documents.append(proof_of(atlas.question, _at_rest(witness.start), answer))
    for ceiling in point.ceilings:
        size = float(ceiling.slope @ ceiling.slope)
        # The point of the ceiling's zero line that is nearest to the centre, and a little beyond.
        above = float(ceiling.slope @ atlas.centre.start) + ceiling.level
        start = atlas.centre.start - ceiling.slope * ((above + _BEYOND_M) / size)
        high = float(ceiling.slope @ start) + ceiling.level
        rows = zip(ceiling.times.tolist(), ceiling.faces.tolist(), ceiling.weights.tolist(), strict=True)
        multipliers = tuple(Multiplier(time, atlas.names[face], value) for time, face, value in rows)
        answer = Answer(Verdict.NO_GO, high, -np.inf, high, None, multipliers, 0)
        documents.append(proof_of(atlas.question, _at_rest(start), answer))
    for document in documents:
        check(document)
    return documents


def _at_rest(start: Any) -> Any:
    return np.concatenate([start, np.zeros(2)])
