"""The exact engine's margin at points that no grid holds: the reference of the other engines' tests."""

from __future__ import annotations

import numpy as np

from safestart.engines.exact import reach_of
from safestart.model.scenario import Floats, Rest, Scenario, SetKind


def reach_margin(
    scenario: Scenario,
    points: Floats,
    horizon: float,
    rest: Rest = Rest.LVLH,
    kind: SetKind = SetKind.TUBE,
) -> Floats:
    """Margin (...) in metres of body-frame starts (..., 2), not restricted to the corridor; positive: reaches it."""
    reach, flat = reach_of(scenario, horizon, rest), np.asarray(points, dtype=np.float64).reshape(-1, 2)
    margin = reach.within(flat)[0] if kind is SetKind.TUBE else reach.at(flat, horizon)
    return margin.reshape(np.shape(points)[:-1])
