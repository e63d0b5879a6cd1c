"""Vectors of the self-test: starts with safestart's verdicts, and which of them leave no doubt in any precision."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from safestart.closed_form.certified import ROUNDING
from safestart.closed_form.certified_point import Prepared, certify_point
from safestart.exact.answer import GUARD
from safestart.flight_table.literals import Precision
from safestart.flight_table.numbers import Point
from safestart.model.scenario import Floats

COUNT = 200
UNDECIDED, GO, NO_GO = 0, 1, 2
_NEAR_M = 0.05


def certified_code(given: Prepared, x: float, y: float, z: float = 0.0) -> int:
    """The verdict of method ``certified`` on one start, as the C code numbers it."""
    found = certify_point(given, x, y, z)
    if found.go:
        return GO
    least = min(offset - (a * x + b * y + c * z) for _, offset, a, b, c in given.faces)
    return NO_GO if least < 0.0 and found.margin < -2.0 * ROUNDING else UNDECIDED


def atlas_codes(point: Point, starts: Floats) -> list[int]:
    """The atlas's verdicts on starts (S, 2)."""
    lower, upper = point.atlas.bounds(starts)
    codes: list[int] = np.where(upper < -GUARD, NO_GO, np.where(lower > GUARD, GO, UNDECIDED)).tolist()
    return codes


def starts_of(point: Point, count: int, seed: int) -> Floats:
    """Starts (S, 3) in and around the corridor, on numbers that float32 holds."""
    shape, y_max = point.scenario.corridor, min(point.atlas.y_max, 150.0)
    draw = np.random.default_rng(seed).uniform(-1.0, 1.0, size=(count, 3))
    y = 0.55 * y_max * (draw[:, 1] + 0.95)
    across = 1.1 * (shape.x0 + shape.c_x * np.maximum(y, 1.0))
    starts = np.stack([draw[:, 0] * across, y, 0.5 * draw[:, 2] * across], axis=-1)
    return starts.astype(np.float32).astype(np.float64)


def header(points: Sequence[Point], r: Precision) -> str:
    """``safestart_vectors.h``."""
    rows = []
    for number, point in enumerate(points):
        starts = starts_of(point, COUNT, number)
        rows += [_row(point, number, start, r) for start in starts.tolist()]
    listed = ",\n    ".join(rows)
    return f"""/* Written by safestart export-c. */
#ifndef SAFESTART_VECTORS_H
#define SAFESTART_VECTORS_H

enum {{ SS_VECTORS = {len(rows)} }};

/* Verdicts of safestart; clear: the same five centimetres around. */
typedef struct {{
    int point;
    ss_real x, y, z;
    int certified, atlas, in_space, clear_certified, clear_atlas, clear_in_space;
}} ss_vector;

static const ss_vector ss_vectors[SS_VECTORS] = {{
    {listed}
}};

#endif
"""


def _row(point: Point, number: int, start: list[float], r: Precision) -> str:
    x, y, z = start
    near = [(dx, dy, dz) for dx in (-1, 0, 1) for dy in (-1, 0, 1) for dz in (-1, 1)]
    around = _NEAR_M * np.array(near) + start
    planar = [certified_code(point.planar, x + dx * _NEAR_M, y + dy * _NEAR_M) for dx, dy, _ in near]
    spatial = [certified_code(point.spatial, *place) for place in around.tolist()]
    atlas = atlas_codes(point, around[:, :2])
    verdicts = (
        certified_code(point.planar, x, y),
        atlas_codes(point, np.array([[x, y]]))[0],
        certified_code(point.spatial, x, y, z),
    )
    clear = [int(set(some) == {one}) for some, one in zip((planar, atlas, spatial), verdicts, strict=True)]
    numbers = ", ".join(str(one) for one in (*verdicts, *clear))
    return f"{{{number}, {r.near(x)}, {r.near(y)}, {r.near(z)}, {numbers}}}"
