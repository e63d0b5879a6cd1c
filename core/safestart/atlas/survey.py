"""Build an atlas: the deepest start, then farthest starts in the directions that close the gap best."""

from __future__ import annotations

import math

import numpy as np

from safestart.atlas.atlas import Atlas
from safestart.atlas.extent import Ceiling, Extent, NotSolved, Witness
from safestart.atlas.sandwich import Sandwich, Support, refine
from safestart.errors import invalid
from safestart.exact.answer import GUARD
from safestart.exact.question import Question
from safestart.exact.watch import watch_of
from safestart.model.scenario import MAX_RANGE, Floats, number
from safestart.runtime.progress import Context

TOLERANCE = 0.005
MOST_DIRECTIONS = 200

_ALONE = Context()

Evidence = tuple[Witness, Ceiling | None]


def build(
    question: Question, y_max: float = 150.0, tolerance: float = TOLERANCE, context: Context = _ALONE
) -> Atlas:
    """Build the atlas: directions are asked until the relative area gap is at most ``tolerance``.

    Raises ``InvalidInput`` for a question in 3-D or other than plain `stay`, for a tolerance outside (1e-4, 1] and a
    cut below the hold plane, and ``Cancelled`` where ``context`` says so between two directions.
    """
    if question.dimensions != 2:
        raise invalid("dimensions", "2: an atlas is planar", question.dimensions)
    if not question.plain:
        raise invalid("question", "stay without a speed limit: an atlas answers no other", question.kind)
    number("tolerance", tolerance, 1e-4, 1.0)
    y_max = number("y_max", y_max, question.scenario.corridor.hold_radius, MAX_RANGE, open_low=True)
    watch = watch_of(question)
    extent = Extent(watch, y_max)
    deepest, ceiling = extent.deepest()
    found: list[Support[Evidence]] = []
    message, sandwich = "", None

    def oracle(direction: Floats) -> Support[Evidence]:
        context.step(len(found), MOST_DIRECTIONS, "directions")
        witness, above, reach = extent.farthest(direction)
        bound = max(reach, float(direction @ witness.start))
        support = Support(direction, witness.start, bound, (witness, above))
        found.append(support)
        return support

    if deepest.margin > 2.0 * GUARD:
        try:
            sandwich = refine(oracle, tolerance, MOST_DIRECTIONS)
        except NotSolved as error:
            message = str(error)
    return _assemble(question, y_max, deepest, ceiling, found, sandwich, watch.names, message)


def _assemble(
    question: Question,
    y_max: float,
    deepest: Witness,
    ceiling: Ceiling | None,
    found: list[Support[Evidence]],
    sandwich: Sandwich[Evidence] | None,
    names: tuple[str, ...],
    message: str,
) -> Atlas:
    # Several directions find the same corner, up to rounding; keep one witness of it.
    rim = {tuple(np.round(s.point, 4)): s.evidence[0] for s in found if s.evidence[0].margin > GUARD}
    centre = _mean(deepest, tuple(rim.values()))
    ahead = [(math.atan2(*(w.start - centre.start)[::-1]), w) for w in rim.values()]
    ordered = sorted(ahead, key=lambda pair: pair[0])
    ceilings = tuple(c for c in (ceiling, *(s.evidence[1] for s in found)) if c is not None)
    return Atlas(
        question,
        y_max,
        deepest,
        centre,
        tuple(witness for _, witness in ordered),
        np.array([witness.start - centre.start for _, witness in ordered]).reshape(-1, 2),
        np.array([witness.margin for _, witness in ordered]),
        np.array([angle for angle, _ in ordered]),
        ceilings,
        np.array([c.slope for c in ceilings]).reshape(-1, 2),
        np.array([c.level for c in ceilings]),
        sandwich.inner_area if sandwich else 0.0,
        sandwich.outer_area if sandwich else 0.0,
        names,
        message,
    )


def _mean(deepest: Witness, rim: tuple[Witness, ...]) -> Witness:
    """Half the deepest start, half the mean of the rim: inside the polygon, and by convexity a witness itself.

    The deepest start alone may lie on the polygon's edge (on the cut), where a fan of triangles degenerates.
    """
    if not rim:
        return deepest
    share = 0.5 / len(rim)
    start = 0.5 * deepest.start + share * np.sum([w.start for w in rim], axis=0)
    thrust = 0.5 * deepest.thrust + share * np.sum([w.thrust for w in rim], axis=0)
    return Witness(start, thrust, 0.5 * deepest.margin + share * sum(w.margin for w in rim))
