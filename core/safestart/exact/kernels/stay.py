"""`stay` for one start by the compiled cutting planes."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

from safestart.exact.answer import GUARD, Answer, concluded, face_multipliers
from safestart.exact.kernels.narrow import Tables, narrow
from safestart.exact.search import first_rows, rounding_of
from safestart.exact.watch import Ints, Watch
from safestart.model.scenario import Floats
from safestart.optim.largest_margin import SOLVED_BY


def stay(watch: Watch, state: Floats, tolerance: float, *, verdict_only: bool) -> Answer | None:
    """The answer, from the same rounds as a :class:`~safestart.exact.search.Search`.

    None where the start is outside, and where a program or the verdict stays open or the bracket wide.
    """
    known, question = _known(watch), watch.question
    settled, lower, upper, rounds, thrust, times, faces, weights = narrow(
        state,
        known.tables,
        known.times,
        known.faces,
        known.offset + known.start @ state,
        known.rows,
        known.reach,
        question.thrust_scale,
        rounding_of(watch, state),
        tolerance,
        verdict_only,
    )
    if not settled or (lower <= GUARD and upper >= -GUARD):
        return None
    if upper - lower > tolerance and not verdict_only:
        return None
    SOLVED_BY["compiled"] += rounds
    proof = () if lower > GUARD else tuple(face_multipliers(times, faces, weights, watch.names))
    return concluded((lower, upper), thrust, proof, rounds, "")


class _Known(NamedTuple):
    """Tables and first rows of a watch, ``rows`` at full thrust, m; ``reach`` (J,) is how far thrust can move a row."""

    tables: Tables
    times: Floats
    faces: Ints
    offset: Floats
    start: Floats
    rows: Floats
    reach: Floats


@lru_cache(maxsize=64)
def _known(watch: Watch) -> _Known:
    first, reach = first_rows(watch)
    table = watch.prediction
    tables = Tables(
        table.free,
        watch.pushed,
        table.along,
        table.held,
        watch.cosine,
        watch.sine,
        watch.begins,
        watch.normals,
        watch.offsets,
        watch.phase,
        watch.rate,
        watch.mean_motion,
        watch.question.dt,
        watch.step,
    )
    rows = watch.question.thrust_scale * first.thrust
    return _Known(tables, first.times, first.faces, first.offset, first.start, rows, reach)
