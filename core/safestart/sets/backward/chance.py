"""How much Gaussian noise narrows the boxes: chance constraints by quantiles.

The noise moves each face by a scalar normal deviate. With m faces that noise moves at all and a risk e:

- Boole: each face gets e / m. All hold together with probability 1 - e at least: an inner set.
- One face alone must hold with probability 1 - e: a necessary condition, an outer set.
- For inputs that know the state: |g_i(k)| <= z holds for all r components and N steps together with probability
  (2 Phi(z) - 1)^(r N); for the z where this is 1 - e, the set that is robust against that box is an inner set.
"""

from __future__ import annotations

import numpy as np
from scipy.stats import beta, norm

from safestart.errors import invalid
from safestart.model.scenario import Floats
from safestart.sets.backward.question import Question


def _checked(risk: float) -> float:
    if not 0.0 < risk <= 0.5:
        raise invalid("risk", "a number in (0, 0.5]", risk)
    return risk


def joint(question: Question, risk: float) -> Floats:
    """What to take off each side (N + 1, n) so that all faces hold together with probability 1 - ``risk`` at least."""
    deviations = question.deviations()
    moved = int(2 * ((deviations > 0.0) & np.isfinite(question.boxes()[1])).sum())
    return deviations * float(norm.isf(_checked(risk) / max(moved, 1)))


def single(question: Question, risk: float) -> Floats:
    """What must come off each side (N + 1, n) for each face alone to hold with probability 1 - ``risk``."""
    return question.deviations() * float(norm.isf(_checked(risk)))


def confidence_box(question: Question, risk: float) -> Floats:
    """E (n, r) whose box holds the noise of all steps together with probability 1 - ``risk``."""
    draws = max(1, question.noise.shape[1] * question.steps)
    each = -np.expm1(np.log1p(-_checked(risk)) / draws)
    return question.noise * float(norm.isf(0.5 * each))


def bounds(successes: int, draws: int, confidence: float) -> tuple[float, float]:
    """Two one-sided bounds on a probability, each wrong at most 1 - ``confidence`` of the time (Clopper-Pearson)."""
    wrong = 1.0 - confidence
    low = 0.0 if successes == 0 else float(beta.ppf(wrong, successes, draws - successes + 1))
    high = 1.0 if successes == draws else float(beta.isf(wrong, successes + 1, draws - successes))
    return low, high
