"""The rows of the competition: name -> abort window in minutes (None: no failure)."""

from __future__ import annotations

CASES: dict[str, tuple[float, float] | None] = {
    "SRNA01": None,
    "SRA01": (120.0, 120.0),
    "SRA02": (120.0, 125.0),
    "SRA03": (120.0, 145.0),
    "SRA04": (240.0, 240.0),
    "SRA05": (235.0, 240.0),
    "SRA06": (230.0, 240.0),
    "SRA07": (50.0, 150.0),
    "SRA08": (0.0, 240.0),
    "SRU01": (260.0, 260.0),
    "SRU02": (0.0, 260.0),
}

HALF_WIDTHS = (0.1, 0.2)
"""Half-widths of the target's box in use, m: paper 003 and one tool 0.1, three others 0.2."""

HORIZON = 300.0
"""Horizon of every row, min."""
