"""What the flown world does beyond the plan: where the corridor is checked, navigation noise, thruster errors."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from safestart.model.scenario import Floats, number

AT_NODES, AT_SUBSTEPS, CONTINUOUS = 0, 1, 2
CHECKS = {"nodes": AT_NODES, "substeps": AT_SUBSTEPS, "continuous": CONTINUOUS}
"""Where a violation is looked for: at control nodes, at the sub-steps of paper 000, or at all times."""

DRAWS = 6
"""Standard normals per control step: navigation x, y, vx, vy, thrust magnitude, thrust direction."""


class Truth(NamedTuple):
    """Settings of the flown world, as the compiled kernels take them.

    ``position_sigma`` (m) and ``velocity_sigma`` (m/s): white navigation noise per axis and control step;
    ``magnitude_sigma`` (relative) and ``direction_sigma`` (rad): error of each held thrust; ``minimum_impulse`` (m/s):
    a thrust whose impulse over the interval is smaller is not delivered.
    """

    check: int = AT_SUBSTEPS
    position_sigma: float = 0.0
    velocity_sigma: float = 0.0
    magnitude_sigma: float = 0.0
    direction_sigma: float = 0.0
    minimum_impulse: float = 0.0

    @property
    def noisy(self) -> bool:
        """Whether anything is drawn."""
        return any(self[1:5])

    @property
    def exact(self) -> bool:
        """Whether thrust is delivered and the state known as the controller thinks."""
        return not any(self[1:])


def truth_of(check: str = "continuous", **values: float) -> Truth:
    """Checked settings; raises ``InvalidInput`` for a value that is negative or not finite."""
    return Truth(CHECKS[check], **{name: number(name, value, 0.0, 1e3) for name, value in values.items()})


NO_DRAWS = np.empty((0, 0, DRAWS))


def draws(truth: Truth, seed: int, cases: np.ndarray[tuple[int], np.dtype[np.int64]], steps: int) -> Floats:
    """Standard normals (M, K, ``DRAWS``) of the numbered cases; empty when nothing is drawn.

    Each case has a counter-based generator of its own, so what it meets depends on seed and number alone.
    """
    if not truth.noisy:
        return NO_DRAWS
    out = np.empty((len(cases), steps, DRAWS))
    for row, case in enumerate(cases.tolist()):
        bits = np.random.Philox(key=seed, counter=[0, 0, case, 0])
        out[row] = np.random.Generator(bits).standard_normal((steps, DRAWS))
    return out
