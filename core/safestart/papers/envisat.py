"""Envisat, the tumbling target of paper 002 and of most examples."""

from __future__ import annotations

from typing import Any

INERTIA_KG_M2 = [[17023.3, 397.1, -2171.4], [397.1, 124825.7, 344.2], [-2171.4, 344.2, 129112.2]]
"""Moments and products of inertia; the study of paper 002 uses them."""

TUMBLING: dict[str, Any] = {
    "kind": "torque_free",
    "inertia_kg_m2": [[17023, 0, 0], [0, 124826, 0], [0, 0, 129112]],
    "body_rate_deg_s": [0.3, 0.5, -2.0],
}
"""A simple case of its free tumble, as inputs in space take an attitude: its moments without its products."""
