"""The generated files: types and sizes (header), numbers (source)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from safestart.closed_form.certified import ROUNDING
from safestart.closed_form.certified_point import Prepared
from safestart.closed_form.family import SPANS
from safestart.exact.answer import GUARD
from safestart.flight_table.literals import Precision
from safestart.flight_table.numbers import FARTHEST_M, Point, Sector

_MEMBERS, _INNER, _FACES, _PLANAR = len(SPANS), 5, 5, 3


def header(points: Sequence[Point], precision: Precision, digests: dict[str, str]) -> str:
    """``safestart_table.h``."""
    bounds = ",\n    ".join(f"{name} = {value}" for name, value in sizes(points).items())
    power = 1 << (_MEMBERS.bit_length() - 1)
    r = precision
    return f"""/* Written by safestart export-c; {r.name}. Do not edit: the digests would no longer be its own. */
#ifndef SAFESTART_TABLE_H
#define SAFESTART_TABLE_H

typedef {r.ctype} ss_real;
#define ss_sqrt {r.sqrt}

/* SHA-256 of safestart_table.c and of proofs.json, whose proofs the numbers rest on. */
#define SS_TABLE_SHA256 "{digests["safestart_table.c"]}"
#define SS_PROOFS_SHA256 "{digests["proofs.json"]}"

enum {{
    SS_FACES = {_FACES},
    SS_PLANAR = {_PLANAR},
    SS_MEMBERS = {_MEMBERS},
    SS_MEMBERS_POWER = {power},
    SS_INNER = {_INNER},
    {bounds}
}};

/* Half a unit in the last place; seconds between commands; metres. */
#define SS_UNIT ((ss_real){r.near(r.unit)})
#define SS_DT_S ((ss_real){r.near(points[0].atlas.question.dt)})
#define SS_ROUNDING ((ss_real){r.up(ROUNDING)})
#define SS_GUARD ((ss_real){r.up(GUARD)})
#define SS_FARTHEST ((ss_real){r.near(FARTHEST_M)})
#define SS_FAR ((ss_real){r.near(1e9)})
#define SS_FIFTH ((ss_real){r.near(0.2)})
#define SS_FOUR_FIFTHS ((ss_real){r.near(0.8)})

/* A triangle of the atlas's fan: corners as seen from the centre, 1 / (a x b), margins of a and b, least weight. */
typedef struct {{
    ss_real a[2], b[2], inverse, margin[2], least;
}} ss_sector;

typedef struct {{
    ss_real omega_rad_s, mean_motion_rad_s, a_max_m_s2;
    /* Certificate: units as in docs/theory/certified.md; face: offset, unit normal. */
    ss_real scale, sway, speed_squared, turning, across, lost, brake_limit, spread, widest;
    ss_real face[SS_FACES][4];
    ss_real reach[SS_MEMBERS], drop[SS_MEMBERS], inner[SS_MEMBERS][SS_INNER][2];
    /* Atlas: starts up to y_max; ceiling: slope, level. */
    ss_real y_max, centre[2], centre_margin, ceiling[SS_CEILINGS][3];
    ss_sector sector[SS_RIM];
    /* Check of thrust: one sample of h seconds; turn: cosine and sine at each. */
    ss_real h, growth, pull, drift[4][4], push[4][2], turn[SS_TURNS][2];
    int turns, rim, ceilings, samples;
}} ss_point;

extern const ss_point ss_points[SS_POINTS];

#endif
"""


def size(points: Sequence[Point], precision: Precision) -> int:
    """Bytes of ``ss_points``, up to the padding of its integers."""
    bounds = sizes(points)
    certificate = 3 + 9 + _FACES * 4 + _MEMBERS * (2 + 2 * _INNER)
    atlas = 4 + 3 * bounds["SS_CEILINGS"] + 8 * bounds["SS_RIM"]
    thrust = 3 + 16 + 8 + 2 * bounds["SS_TURNS"]
    real = 4 if precision.suffix else 8
    return len(points) * (real * (certificate + atlas + thrust) + 16)


def sizes(points: Sequence[Point]) -> dict[str, int]:
    """The sizes that differ from table to table: those of the largest operating point."""
    steps, samples = points[0].atlas.question.steps, max(point.watch.samples for point in points)
    return {
        "SS_POINTS": len(points),
        "SS_RIM": max((1, *(len(point.sectors) for point in points))),
        "SS_CEILINGS": max((1, *(len(point.ceilings) for point in points))),
        "SS_STEPS": steps,
        "SS_SAMPLES": samples,
        "SS_TURNS": steps * samples + 1,
    }


def source(points: Sequence[Point], precision: Precision) -> str:
    """``safestart_table.c``."""
    bodies = ",\n".join("    {" + ",\n     ".join(_members(point, precision)) + "}" for point in points)
    return (
        f"/* Written by safestart export-c; {precision.name}. */\n"
        '#include "safestart_table.h"\n\n'
        f"const ss_point ss_points[SS_POINTS] = {{\n{bodies}\n}};\n"
    )


def _members(point: Point, r: Precision) -> Iterator[str]:
    target, atlas, watch = point.scenario.target, point.atlas, point.watch
    n, h = target.mean_motion, watch.step
    yield f".omega_rad_s = {r.near(target.tumble_rate)}"
    yield f".mean_motion_rad_s = {r.near(n)}"
    yield f".a_max_m_s2 = {r.down(point.scenario.chaser.max_acceleration)}"
    yield from _certificate(point.spatial, r)
    yield f".spread = {r.up(point.spread)}"
    yield f".widest = {r.up(point.widest)}"
    yield f".y_max = {r.down(atlas.y_max)}"
    yield f".centre = {r.row(atlas.centre.start.tolist())}"
    yield f".centre_margin = {r.down(max(atlas.centre.margin, 0.0))}"
    ceilings = [r.row((*one.slope.tolist(), one.level)) for one in point.ceilings]
    yield _rows("ceiling", ceilings or [r.row((0.0,) * 3)])
    yield _rows("sector", [_sector(one, r) for one in point.sectors] or [_nothing(r)])
    drift, push = point.matrices
    yield f".h = {r.near(h)}"
    yield f".growth = {r.up(1.0 + 4.0 * n * h + 64.0 * r.unit)}"
    yield f".pull = {r.up(4.0 * n * n * h + 64.0 * r.unit * n)}"
    yield _rows("drift", [r.row(row) for row in drift.tolist()])
    yield _rows("push", [r.row(row) for row in push.tolist()])
    angle = target.tumble_rate * h * np.arange(atlas.question.steps * watch.samples + 1)
    turns = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    yield _rows("turn", [r.row(row) for row in turns.tolist()])
    yield f".turns = {int(target.tumble_rate > 0.0)}"
    yield f".rim = {len(point.sectors)}"
    yield f".ceilings = {len(point.ceilings)}"
    yield f".samples = {watch.samples}"


def _certificate(given: Prepared, r: Precision) -> Iterator[str]:
    rates = given.rates
    plain = {
        "scale": rates.scale,
        "sway": rates.sway,
        "speed_squared": rates.speed * rates.speed,
        "turning": rates.turning,
        "across": rates.across,
        "lost": rates.lost,
    }
    for name, value in plain.items():
        yield f".{name} = {r.near(value)}"
    yield f".brake_limit = {r.down(rates.brake_limit)}"
    yield _rows("face", [r.row(face[1:]) for face in given.faces])
    yield f".reach = {r.row(given.reach)}"
    yield f".drop = {r.row(given.drop)}"
    members = ["{" + ", ".join(r.row((h.real, h.imag)) for h in member) + "}" for member in given.inner]
    yield _rows("inner", members)


def _sector(one: Sector, r: Precision) -> str:
    margins = "{" + ", ".join(r.down(margin) for margin in one.margins) + "}"
    return f"{{{r.row(one.a)}, {r.row(one.b)}, {r.near(one.inverse)}, {margins}, {r.up(one.least)}}}"


def _nothing(r: Precision) -> str:
    zeros = r.row((0.0, 0.0))
    return f"{{{zeros}, {zeros}, {r.near(0.0)}, {zeros}, {r.near(1.0)}}}"


def _rows(name: str, rows: list[str]) -> str:
    return f".{name} = {{" + ",\n        ".join(rows) + "}"
