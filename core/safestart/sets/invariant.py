"""Outer approximation of a minimal robust positively invariant set, by its support function.

e+ = F e + w with w in a symmetric convex W has the minimal invariant set Z = W + F W + F^2 W + ... (Rakovic et al.
2005). Here F contracts the norm |x|_P = sqrt(x' P x) by a factor r < 1, and every w in W has |w|_P <= c. Then

    S = W + F W + ... + F^(s-1) W + E,   E = {x : |x|_P <= c r^s / (1 - r)}

holds Z, and is invariant itself: F S + W = (W + ... + F^(s-1) W) + F^s W + F E, and what is left is in E because
c r^s + r c r^s / (1 - r) = c r^s / (1 - r). It exceeds Z by at most E, which shrinks as r^s.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from safestart.model.scenario import Floats

# Allowed size of E, as a part of the largest step |w|_P.
_TAIL = 1e-6
_MOST_TERMS = 4000
# Bound on rounding in some thousand additions of positive terms.
_ROUNDING = 1e-10


@dataclass(frozen=True, slots=True)
class Push:
    """W = {integral over [0, h] of G(s) w(s) ds : |w(s)| <= 1, w measurable}, G(s) of shape (n, m).

    ``columns`` (q + 1, n, m) samples G at equal steps. The support function is the integral of |G(s)' d|; the trapezoid
    rule bounds it from above, because linear interpolation bounds the norm and ``excess`` (n,) bounds the interpolation
    error per component of d.
    """

    columns: Floats
    step: float
    excess: Floats

    def support(self, directions: Floats) -> Floats:
        """Upper bound of max d . x over W, (k,), for directions (k, n)."""
        count, size, inputs = self.columns.shape
        flat = self.columns.transpose(1, 0, 2).reshape(size, count * inputs)
        seen = (directions @ flat).reshape(-1, count, inputs)
        norms = np.sqrt((seen * seen).sum(axis=-1))
        total = self.step * (norms.sum(axis=-1) - 0.5 * (norms[:, 0] + norms[:, -1]))
        out: Floats = total + np.abs(directions) @ self.excess
        return out


@dataclass(frozen=True, slots=True)
class Invariant:
    """S for unit disturbance: ``closed_loop`` F (n, n), ``contraction`` r, ``terms`` s, ``tail`` = c r^s / (1 - r).

    ``weight`` (n, n) is P and ``inverse`` its inverse.
    """

    closed_loop: Floats
    push: Push
    terms: int
    contraction: float
    tail: float
    weight: Floats
    inverse: Floats

    @classmethod
    def of(cls, closed_loop: Floats, push: Push) -> Invariant | None:
        """Build S; None when the closed loop does not contract in the norm that its Lyapunov equation gives."""
        from scipy.linalg import solve_discrete_lyapunov

        spectral = float(np.abs(np.linalg.eigvals(closed_loop)).max())
        if not spectral < 1.0 - 1e-6:
            return None
        # F'PF = r^2 (P - I) for any r between the spectral radius and 1; the factor is computed, not assumed.
        rate = spectral + 0.25 * (1.0 - spectral)
        found = solve_discrete_lyapunov((closed_loop / rate).T, np.eye(len(closed_loop)))
        weight: Floats = np.asarray(0.5 * (found + found.T), dtype=np.float64)
        try:
            root = np.linalg.cholesky(weight).T
        except np.linalg.LinAlgError:
            return None
        lost = _ROUNDING + 1e-15 * float(np.linalg.cond(root))
        contraction = float(np.linalg.norm(root @ closed_loop @ np.linalg.inv(root), 2)) * (1.0 + lost)
        if not contraction < 1.0:
            return None
        ratio = math.log(_TAIL * (1.0 - contraction)) / math.log(contraction)
        terms = min(max(1, math.ceil(ratio)), _MOST_TERMS)
        norms = np.linalg.norm(root @ push.columns, 2, axis=(1, 2))
        largest = push.step * float(norms.sum() - 0.5 * (norms[0] + norms[-1]))
        largest += float(np.linalg.norm(root, 2) * np.linalg.norm(push.excess))
        tail = largest * contraction**terms / (1.0 - contraction)
        return cls(closed_loop, push, terms, contraction, tail, weight, np.asarray(np.linalg.inv(weight)))

    @property
    def epsilon(self) -> float:
        """Largest Euclidean length in E, in the state's mixed units: S exceeds the minimal set by no more."""
        return self.tail / math.sqrt(float(np.linalg.eigvalsh(self.weight)[0]))

    def support(self, directions: Floats) -> Floats:
        """Upper bound of max d . e over S, (k,), for directions (k, n) and |w| <= 1."""
        total = self.tail * self._dual(directions)
        moved = directions
        for _ in range(self.terms):
            total = total + self.push.support(moved)
            moved = moved @ self.closed_loop
        return np.asarray(total * (1.0 + _ROUNDING))

    def transient(self, directions: Floats, part: slice) -> Floats:
        """Upper bound over k >= 0 of max d . F^k e0 over unit vectors e0 in the coordinates ``part``, (k,)."""
        best = np.zeros(len(directions))
        moved = directions
        for _ in range(self.terms):
            best = np.maximum(best, np.linalg.norm(moved[:, part], axis=1))
            moved = moved @ self.closed_loop
        longest = math.sqrt(float(np.linalg.eigvalsh(self.weight)[-1]))
        late = self.contraction**self.terms * longest * self._dual(directions)
        return np.asarray(np.maximum(best, late) * (1.0 + _ROUNDING))

    def _dual(self, directions: Floats) -> Floats:
        """|d| in the norm dual to |.|_P, (k,)."""
        out: Floats = np.sqrt(np.einsum("ki,ij,kj->k", directions, self.inverse, directions))
        return out
