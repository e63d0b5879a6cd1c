"""Check an atlas from elsewhere against its own evidence: fly its flights and compute its bounds again."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np

from safestart.atlas.atlas import Atlas
from safestart.atlas.extent import Witness
from safestart.errors import invalid
from safestart.exact.watch import Watch, watch_of
from safestart.model.scenario import Floats
from safestart.optim.thrust_ball import bound

_ROUNDING_M = 1e-10
"""Rounding difference (m) allowed for another processor: a tenth of a verdict's distance from 0."""
_AREA = 1e-6
_LARGEST = 1e6


def require_borne_out(atlas: Atlas) -> None:
    """Raise ``InvalidInput`` if the atlas claims more than its thrusts and multipliers prove, or is inconsistent."""
    question = atlas.question
    _require(
        "question",
        question.plain and question.dimensions == 2,
        "stay in the plane without a speed limit",
        question.kind,
    )
    watch = watch_of(question)
    _require("names", atlas.names == watch.names, f"{watch.names}", atlas.names)
    for k, witness in enumerate((atlas.deepest, atlas.centre, *atlas.rim)):
        _require_witness(watch, witness, k)
    _require_ceilings(atlas, watch)
    ahead = np.array([w.start - atlas.centre.start for w in atlas.rim]).reshape(-1, 2)
    _require("corners", np.array_equal(ahead, atlas.corners), "the rim as seen from the centre", "others")
    turn = [math.atan2(y, x) for x, y in ahead.tolist()]
    close = np.allclose(turn, atlas.angles, rtol=0.0, atol=1e-12) and bool(
        (np.diff(atlas.angles) >= 0.0).all()
    )
    _require("angles", close, "the rim's directions in order", "others")
    number = (
        isinstance(atlas.y_max, float) and question.scenario.corridor.hold_radius < atlas.y_max <= _LARGEST
    )
    _require("y_max", number, "metres above the hold plane", atlas.y_max)
    _require("message", isinstance(atlas.message, str), "text", atlas.message)
    _require_areas(atlas)


def _require_witness(watch: Watch, witness: Witness, k: int) -> None:
    most = Fraction(watch.question.scenario.chaser.max_acceleration) ** 2
    # No tolerance: the chaser cannot exceed its thrust, however little.
    fits = all(Fraction(x) ** 2 + Fraction(y) ** 2 <= most for x, y in witness.thrust.tolist())
    _require(f"thrust[{k}]", fits, "thrusts within a_max", "more")
    _require(
        f"start[{k}]", float(np.abs(witness.start).max()) <= _LARGEST, f"within {_LARGEST:g} m", witness.start
    )
    flown = watch.minima(np.concatenate([witness.start, [0.0, 0.0]]), witness.thrust).lowest
    _require(
        f"margin[{k}]",
        witness.margin <= flown + _ROUNDING_M,
        f"at most what its flight keeps, {flown!r} m",
        witness.margin,
    )


def _require_ceilings(atlas: Atlas, watch: Watch) -> None:
    question = watch.question
    for k, ceiling in enumerate(atlas.ceilings):
        times, faces, weights = ceiling.times, ceiling.faces, ceiling.weights
        within = bool((times >= 0.0).all() and (times <= question.horizon).all())
        _require(f"times[{k}]", within, f"times in [0, {question.horizon:g}] s", times)
        known = bool((faces >= 0).all() and (faces < len(watch.names)).all())
        _require(f"faces[{k}]", known, f"faces 0 to {len(watch.names) - 1}", faces)
        whole = bool((weights >= 0.0).all()) and abs(float(weights.sum()) - 1.0) <= 1e-12
        _require(f"weights[{k}]", whole, "weights >= 0 of sum 1", weights)
        cuts = watch.cuts(times, faces)
        level = bound(cuts.offset, cuts.thrust, weights, question.scenario.chaser.max_acceleration, 2)
        _require(f"level[{k}]", ceiling.level >= level - _ROUNDING_M, f"at least {level!r} m", ceiling.level)
        slope: Floats = weights @ cuts.start[:, :2]
        same = np.allclose(ceiling.slope, slope, rtol=0.0, atol=1e-14)
        _require(f"slope[{k}]", same, f"{slope.tolist()}", ceiling.slope)


def _require_areas(atlas: Atlas) -> None:
    """The inner area must be that of the rim, the outer area no smaller than the one that the ceilings leave."""
    inner, outer = atlas.inner_area, atlas.outer_area
    numbers = isinstance(inner, float) and isinstance(outer, float) and 0.0 <= inner <= outer <= _LARGEST**2
    _require("inner_area, outer_area", numbers, "square metres, the outer no smaller", (inner, outer))
    if outer == 0.0 and (not atlas.rim or atlas.message):
        return
    from scipy.spatial import ConvexHull, HalfspaceIntersection, QhullError

    sides = np.column_stack([-atlas.slopes, -atlas.levels])
    cut = np.array([[0.0, 1.0, -atlas.y_max]])
    try:
        rim = ConvexHull(np.array([w.start for w in atlas.rim])).volume
        left = ConvexHull(
            HalfspaceIntersection(np.vstack([sides, cut]), atlas.centre.start).intersections
        ).volume
    except QhullError:
        raise invalid("atlas", "a rim and ceilings that enclose an area", "others") from None
    _require("inner_area", inner <= rim + _AREA * (1.0 + outer), f"at most {rim:.9g} m^2", inner)
    _require("outer_area", outer >= left - _AREA * (1.0 + left), f"at least {left:.9g} m^2", outer)


def _require(field: str, holds: bool, required: str, received: object) -> None:
    if not holds:
        raise invalid(f"atlas.{field}", required, received)
