"""What a user writes: mypy --strict reads it with the packages as they are installed."""

from __future__ import annotations

from typing import assert_type

import numpy as np
from numpy.typing import NDArray

import safestart as ss

scenario = ss.Scenario(ss.Target(0.05, 1.1e-3), ss.Chaser(0.1), ss.Corridor(c_x=1.2))
found = ss.certify(scenario, [[5.0, 40.0], [0.0, 90.0]], rest="lvlh")
assert_type(found.go, NDArray[np.bool_])
assert_type(found.margin_m, NDArray[np.float64])
answer = ss.decide(scenario, (5.0, 40.0), question="synchronize")
assert_type(answer.verdict, str)
assert_type(answer.go, bool)
if answer.proof is not None:
    assert_type(ss.verify(answer.proof).margin_m, float)
assert_type(ss.region(scenario).inner_area_m2, float)


class Mine:
    """A controller of the user's own."""

    def command(self, k: int, state: NDArray[np.float64]) -> list[float]:
        """Nothing."""
        return [0.0, 0.0, 0.0]


assert_type(ss.fly(scenario, (5.0, 40.0), Mine()).safe, bool)
pilot = ss.controller("sequence", scenario)
pilot.begin(np.zeros(6))
assert_type(pilot.command(0, np.zeros(6)).thrust, NDArray[np.float64])
with ss.Client("http://127.0.0.1:8000", key="k") as client:
    assert_type(client.run("benchmark", {"omega_t_deg_s": 3}, limit_s=60.0).pictures, dict[str, bytes])
    assert_type(client.decide(scenario, np.array([5.0, 40.0])).margin_m, float)
