"""Figures printed in paper 000 (arXiv 2607.02128v1), shown beside ours."""

from __future__ import annotations

from typing import TypedDict

TABLE1_THRUST_M_S2 = (0.20, 0.10, 0.05, 0.01)
"""Columns of Table 1: a_max in m/s^2."""

TABLE1_SAFE_PERCENT = {
    1.0: (84.3, 76.9, 68.7, 8.2),
    2.0: (68.7, 47.6, 12.7, 0.5),
    3.0: (39.7, 10.0, 2.6, 0.1),
    4.0: (12.7, 3.2, 0.9, 0.0),
    5.0: (5.3, 1.4, 0.4, 0.0),
}
"""Table 1: tumble rate in deg/s -> safe percentage of the corridor per thrust level."""


class Table2Row(TypedDict):
    """One row of Table 2."""

    iou_vs_hj: float
    area_ratio: float
    run_s: float


def _row(iou: float, area: float, seconds: float) -> Table2Row:
    return {"iou_vs_hj": iou, "area_ratio": area, "run_s": seconds}


TABLE2_THRUST_M_S2 = 0.10
"""a_max of every operating point of Table 2."""

TABLE2: dict[float, dict[str, Table2Row]] = {
    1.0: {
        "analytical": _row(0.375, 0.508, 0.01),
        "backward": _row(0.762, 1.313, 1.57),
        "forward": _row(0.831, 1.065, 65.99),
        "hamilton_jacobi": _row(1.0, 1.0, 2.40),
        "monte_carlo": _row(0.372, 0.518, 751.69),
    },
    3.0: {
        "analytical": _row(0.073, 0.073, 0.01),
        "backward": _row(0.762, 1.312, 1.82),
        "forward": _row(0.811, 1.080, 66.12),
        "hamilton_jacobi": _row(1.0, 1.0, 2.37),
        "monte_carlo": _row(0.045, 0.049, 849.10),
    },
    5.0: {
        "analytical": _row(0.008, 0.008, 0.01),
        "backward": _row(0.749, 1.335, 1.61),
        "forward": _row(0.809, 1.115, 65.90),
        "hamilton_jacobi": _row(1.0, 1.0, 2.30),
        "monte_carlo": _row(0.004, 0.004, 629.38),
    },
}
"""Table 2: tumble rate in deg/s -> engine -> published row (a_max 0.10 m/s^2)."""

TABLE3_RANGES_M = (30.0, 50.0, 100.0, 150.0)
"""Columns of Table 3: r0 in metres."""

TABLE3: dict[float, dict[float, tuple[tuple[int, int], ...]]] = {
    0.02: {
        1.0: ((7, 7), (8, 8), (5, 6), (0, 8)),
        2.0: ((7, 3), (0, 0), (0, 0), (0, 0)),
        3.0: ((0, 0), (0, 0), (0, 0), (0, 0)),
        4.0: ((0, 0), (0, 0), (0, 0), (0, 0)),
        5.0: ((0, 0), (0, 0), (0, 0), (0, 0)),
    },
    0.05: {
        1.0: ((9, 9), (9, 9), (7, 7), (7, 8)),
        2.0: ((6, 6), (6, 5), (0, 0), (0, 0)),
        3.0: ((5, 1), (0, 0), (0, 0), (0, 0)),
        4.0: ((0, 0), (0, 0), (0, 0), (0, 0)),
        5.0: ((0, 0), (0, 0), (0, 0), (0, 0)),
    },
    0.10: {
        1.0: ((9, 9), (9, 5), (5, 4), (9, 9)),
        2.0: ((9, 9), (6, 8), (5, 4), (4, 1)),
        3.0: ((6, 6), (7, 2), (0, 0), (0, 0)),
        4.0: ((7, 0), (0, 0), (0, 0), (0, 0)),
    },
}
"""Table 3: a_max (m/s^2) -> tumble rate (deg/s) -> (certified, feasible) of nine starts per range."""

TABLE3_CONFUSION = {
    "tp": 122,
    "fp": 30,
    "fn": 12,
    "tn": 336,
    "precision": 0.80,
    "recall": 0.91,
    "accuracy": 0.92,
    "f1": 0.85,
    "mcc": 0.80,
}
"""Certified against feasible, over 500 starts, as printed."""
