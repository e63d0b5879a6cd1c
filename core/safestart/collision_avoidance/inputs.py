"""Sums of both inputs that one player can enforce: differences and sums of their sets, by the radii."""

from __future__ import annotations

import math

from safestart.constraints.thrust import InputSet, Part


def meeting(part: Part, others: tuple[Part, ...]) -> list[Part]:
    """The balls that share a channel with ``part``."""
    return [other for other in others if other.begin < part.end and part.begin < other.end]


def left_over(own: InputSet, other: InputSet) -> InputSet | None:
    """Sums that the owner can realise whatever the other does: W with W + (-other) inside ``own``; None if empty.

    It is the Pontryagin difference if both have the same shape or ``own`` is a box; otherwise a subset of it.
    """
    bound = tuple(
        part.radius - math.hypot(*(met.radius for met in meeting(part, other.parts))) for part in own.parts
    )
    # Equal players leave a single point, which rounding must not turn into an empty set.
    slack = 1e-12 * max(own.radius, other.radius)
    if min(bound) < -slack:
        return None
    return own.with_bound(tuple(max(value, 0.0) for value in bound))


def held_down(own: InputSet, other: InputSet) -> InputSet:
    """Sums to which ``other`` can hold ``own`` by answering u with -k u, k the largest share by part."""
    shares = []
    for part in own.parts:
        share = 1.0
        for met in meeting(part, other.parts):
            size = math.hypot(*(mine.radius for mine in meeting(met, own.parts)))
            share = min(share, met.radius / size if size > 0.0 else 1.0)
        shares.append((1.0 - share) * part.radius)
    return own.with_bound(tuple(shares))
