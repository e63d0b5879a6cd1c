"""The question behind every backward reachable set here: a linear system, a box to reach, boxes to stay in.

    x(k+1) = A x(k) + B u(k) + E v(k),   |u_i| <= inputs_i,   |v_i| <= 1   (robust)
    x(k+1) = A x(k) + B u(k) + G g(k),   g(k) ~ N(0, I)                    (stochastic)

x(N) must lie in the target, |x(k)_i| <= limits_i must hold at k = 0 .. N-1.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from safestart.errors import invalid
from safestart.model.scenario import Floats

_WORST_CONDITION = 1e12


@dataclass(frozen=True, slots=True)
class Question:
    """``a`` (n, n), ``b`` (n, m), ``inputs`` (m,), ``centre`` and ``half_widths`` (n,) of the target, N = ``steps``.

    ``limits`` (n,) may be inf; ``disturbance`` E (n, q); ``noise`` G (n, r). Units are those of the state.
    Raises ``InvalidInput`` for shapes that do not fit, values that are not finite, and A without a usable inverse.
    """

    a: Floats
    b: Floats
    inputs: Floats
    centre: Floats
    half_widths: Floats
    steps: int
    limits: Floats
    disturbance: Floats
    noise: Floats

    def __post_init__(self) -> None:
        n, m = len(self.a), len(self.inputs)
        for name, value, shape in (
            ("a", self.a, (n, n)),
            ("b", self.b, (n, m)),
            ("inputs", self.inputs, (m,)),
            ("centre", self.centre, (n,)),
            ("half_widths", self.half_widths, (n,)),
            ("limits", self.limits, (n,)),
            ("disturbance", self.disturbance, (n, self.disturbance.shape[-1])),
            ("noise", self.noise, (n, self.noise.shape[-1])),
        ):
            if value.shape != shape:
                raise invalid(name, f"shape {shape}", value.shape)
            if not (np.isfinite(value) | (np.isposinf(value) if name == "limits" else False)).all():
                raise invalid(name, "finite values", value.tolist())
        for name, value in (
            ("inputs", self.inputs),
            ("half_widths", self.half_widths),
            ("limits", self.limits),
        ):
            if (value < 0.0).any():
                raise invalid(name, "values of at least 0", value.tolist())
        if self.steps < 1:
            raise invalid("steps", "at least 1", self.steps)
        if not float(np.linalg.cond(self.a)) < _WORST_CONDITION:
            raise invalid(
                "a", f"a matrix with a condition number below {_WORST_CONDITION:g}", self.a.tolist()
            )

    def powers(self) -> Floats:
        """A^0 .. A^N, (N + 1, n, n)."""
        out = [np.eye(len(self.a))]
        for _ in range(self.steps):
            out.append(self.a @ out[-1])
        return np.stack(out)

    def boxes(self) -> tuple[Floats, Floats]:
        """Centres and half-widths (N + 1, n) of the boxes that x(0) .. x(N) must lie in."""
        n = len(self.a)
        centres, halves = np.zeros((self.steps + 1, n)), np.tile(self.limits, (self.steps + 1, 1))
        centres[-1], halves[-1] = self.centre, self.half_widths
        return centres, halves

    def disturbed(self) -> Floats:
        """Half-width of what v adds to each component of x(0) .. x(N) when nothing answers it, (N + 1, n)."""
        return _summed(np.abs(self.powers()[:-1] @ self.disturbance).sum(axis=2))

    def deviations(self) -> Floats:
        """Standard deviation of each component of x(0) .. x(N) when nothing answers the noise, (N + 1, n)."""
        return np.sqrt(_summed(((self.powers()[:-1] @ self.noise) ** 2).sum(axis=2)))


def _summed(steps: Floats) -> Floats:
    """Sums over the first k of N entries, k = 0 .. N."""
    return np.concatenate([np.zeros((1, steps.shape[1])), np.cumsum(steps, axis=0)])
