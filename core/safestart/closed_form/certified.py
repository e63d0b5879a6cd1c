"""`certified`: the sound closed-form certificate of starts at rest (docs/theory/certified.md). NumPy only.

A start is certified when a manoeuvre of a fixed family keeps it in the corridor for ever within its thrust: it brakes
in the body frame, or turns in towards the target, then stands in the body frame. The whole path lies in the hull of a
few control points, so its distance to each face is known without simulation. An uncertified start is undecided, not
refused: another thrust history may keep it in the corridor.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from safestart.closed_form.blocks import row_blocks
from safestart.closed_form.members import BRAKE, Faces, Ints, Offer, offers
from safestart.closed_form.rates import Rates, rates_of
from safestart.errors import invalid
from safestart.model.scenario import Bools, CorridorShape, Floats, Grid, Rest, Scenario

ROUNDING = 1e-6
"""Metres subtracted from every clearance, which floats give to better than 1e-8 m within :data:`FARTHEST`."""

FARTHEST = 1e6
"""Largest coordinate in metres."""

OUT_OF_REACH = "range"
"""The binding constraint's name for a start for which no manoeuvre has the thrust."""


@dataclass(frozen=True, slots=True)
class Certified:
    """The certificate of an array of starts (...).

    ``margin`` (...) in metres: where ``go``, the manoeuvre's distance to every face is at least this at all times;
    elsewhere it is <= 0: the room or range that the start (outside the corridor) or the nearest manoeuvre lacks.
    ``binding`` (...) is the index in ``names`` of the face that is nearest, or of :data:`OUT_OF_REACH`, the last.
    ``member`` and ``drop`` (...) name the manoeuvre, :func:`safestart.closed_form.manoeuvre.manoeuvre_of`.
    """

    names: tuple[str, ...]
    go: Bools
    margin: Floats
    binding: Ints
    member: Ints
    drop: Floats


@dataclass(frozen=True, slots=True)
class CertifiedMap:
    """The certificate of a grid: ``margin``, ``mask`` (GO), ``inside`` (the corridor to :data:`ROUNDING`), (ny, nx)."""

    margin: Floats
    mask: Bools
    inside: Bools
    safe_fraction: float


def certify(scenario: Scenario, points: Floats, rest: Rest = Rest.LVLH) -> Certified:
    """Certify starts at rest, body-frame positions ``points`` (..., 2) or (..., 3) in metres.

    The body frame coincides with LVLH at the start. Raises ``InvalidInput`` when a coordinate is not finite or beyond
    :data:`FARTHEST`, or the last axis is another.
    """
    points = np.asarray(points, dtype=np.float64)
    if points.ndim == 0 or points.shape[-1] not in (2, 3):
        raise invalid("points", "last axis of length 2 or 3 (metres)", points.shape)
    if not (np.abs(points) <= FARTHEST).all():
        raise invalid("points", f"finite coordinates within {FARTHEST:g} m", "NaN or more")
    return certify_by(rates_of(scenario, rest), scenario.corridor, points)


def certify_by(rates: Rates, corridor: CorridorShape, points: Floats) -> Certified:
    """:func:`certify` for given rates; ``points`` as there, checked."""
    shape, dimensions = points.shape[:-1], points.shape[-1]
    faces = Faces.of(corridor, dimensions)
    margin, binding, member, drop = _arrays(
        rates, faces, np.ascontiguousarray(points.reshape(-1, dimensions).T)
    )
    return Certified(
        (*faces.names, OUT_OF_REACH),
        (margin > 0.0).reshape(shape),
        margin.reshape(shape),
        binding.reshape(shape),
        member.reshape(shape),
        drop.reshape(shape),
    )


def _arrays(rates: Rates, faces: Faces, place: Floats) -> tuple[Floats, Ints, Ints, Floats]:
    """Margin, binding, member and drop of the starts ``place`` (2 or 3, n), a block at a time."""
    parts = row_blocks(max(place.shape[1], 1), 1)
    margin, binding, member, drop = zip(
        *(_block(rates, faces, place[:, part]) for part in parts), strict=True
    )
    return np.concatenate(margin), np.concatenate(binding), np.concatenate(member), np.concatenate(drop)


def _block(rates: Rates, faces: Faces, place: Floats) -> tuple[Floats, Ints, Ints, Floats]:
    start = faces.room(place)
    # Outside the corridor no manoeuvre helps, so the margin is the start's own.
    margin, binding = start.min(axis=0), start.argmin(axis=0)
    member, drop = np.full(len(margin), BRAKE), np.zeros(len(margin))
    inside = np.flatnonzero(margin > ROUNDING)
    place, start = place[:, inside], start[:, inside]
    found = _Best.of(offers(rates, faces, place, start))
    lost = found.binding < 0
    margin[inside] = np.where(lost, _shortfall(rates, place), found.margin)
    binding[inside] = np.where(lost, len(faces.names), found.binding)
    member[inside], drop[inside] = found.member, found.drop
    return margin - ROUNDING, binding, member, drop


def certify_grid(scenario: Scenario, grid: Grid, rest: Rest = Rest.LVLH) -> CertifiedMap:
    """Certify every point of a grid: arrays (ny, nx), row-major ``[iy][ix]``. The arithmetic is :func:`certify`'s."""
    x, y = grid.axes(scenario.corridor)
    rates, faces = rates_of(scenario, rest), Faces.of(scenario.corridor, 2)
    size = (len(y), len(x))
    margin, inside = np.empty(size), np.empty(size, bool)
    for rows in row_blocks(*size):
        cells = np.empty((2, *margin[rows].shape))
        cells[0], cells[1] = x, y[rows, None]
        found, within = _margins(rates, faces, cells.reshape(2, -1))
        margin[rows], inside[rows] = found.reshape(cells.shape[1:]), within.reshape(cells.shape[1:])
    mask = margin > 0.0
    count = int(np.count_nonzero(inside))
    fraction = float(np.count_nonzero(mask)) / count if count else 0.0
    return CertifiedMap(margin, mask, inside, fraction)


def _margins(rates: Rates, faces: Faces, place: Floats) -> tuple[Floats, Bools]:
    """Margin and whether it lies in the corridor, for starts ``place`` (2, n) of a map."""
    start = faces.room(place)
    margin = start.min(axis=0)
    inside = margin >= -ROUNDING  # the grid's corners lie on faces
    within = np.flatnonzero(margin > ROUNDING)
    place, start = place.take(within, axis=1), start.take(within, axis=1)
    brake, turn_in = offers(rates, faces, place, start)
    best = np.maximum(brake.worst, turn_in.worst)
    lost = best == -np.inf
    if lost.any():
        best[lost] = _shortfall(rates, place[:, lost])
    margin[within] = best
    margin -= ROUNDING
    return margin, inside


@dataclass(frozen=True, slots=True)
class _Best:
    """The best manoeuvre for each start; ``binding`` is -1 when there is none."""

    margin: Floats
    binding: Ints
    member: Ints
    drop: Floats

    @classmethod
    def of(cls, given: list[Offer]) -> _Best:
        count = len(given[0].flyable)
        margin, binding = np.full(count, -np.inf), np.full(count, -1)
        member, drop = np.full(count, BRAKE), np.zeros(count)
        for offer in given:
            worst = offer.worst
            better = worst > margin
            margin = np.where(better, worst, margin)
            binding = np.where(better, offer.clearance.argmin(axis=0), binding)
            member, drop = np.where(better, offer.member, member), np.where(better, offer.drop, drop)
        return cls(margin, binding, member, drop)


def longest_range(rates: Rates) -> float:
    """The farthest range in metres from which any manoeuvre can be flown; inf when no manoeuvre needs thrust."""
    limit = max(rates.brake_limit, float(rates.family.reach[-1]))
    return limit / rates.scale if rates.scale > 0.0 else math.inf


def _shortfall(rates: Rates, place: Floats) -> Floats:
    """Metres, at most 0, by which the start is farther away than :func:`longest_range`."""
    square = place[0] * place[0] + place[1] * place[1]
    if len(place) == 3:
        square += place[2] * place[2]
    return np.asarray(np.minimum(longest_range(rates) - np.sqrt(square), 0.0))
