"""Flights from a set's boundary, counted."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from safestart.simulation.record import Record

# Rounding of a flight: the boundary's own distance is 0.
_TOLERANCE = 1e-9


def summary(
    name: str, records: Sequence[Record], most: float, *, without_fallback: bool = False
) -> dict[str, Any]:
    """How many of them held: no face passed, no thrust over ``most`` (m/s^2), and, if asked, no fallback's command."""
    margins = [float(record.margin[0]) for record in records]
    peaks = [float(record.peak[0]) for record in records]
    held = [
        margin >= -_TOLERANCE
        and peak <= most * (1.0 + _TOLERANCE)
        and not (without_fallback and record.fallbacks[0])
        for margin, peak, record in zip(margins, peaks, records, strict=True)
    ]
    finite = bool(np.isfinite(margins).all())
    return {
        "set": name,
        "starts": len(records),
        "held": int(sum(held)),
        "least_margin_m": min(margins) if finite else None,
        "most_thrust_m_s2": max(peaks) if finite else None,
    }
