"""How long one hop takes: the root of the hop-time equation on the branch of short hops, for many pairs at once.

On the branch the root is the first one; between 90 deg and the fold it is the only one below the fold's phase. Sampled
signs bracket it, Newton's method within the bracket finds it to rounding.
"""

from __future__ import annotations

import math

import numpy as np

from safestart.errors import InvalidInput, invalid
from safestart.hopping.fold import fold_of
from safestart.hopping.hop_equation import residual, weights
from safestart.model.scenario import Floats

LEAST_RHO, GREATEST_RHO = 0.0, 1.0 - 1e-6

PHASES = math.tau * 0.9 * np.linspace(0.0, 1.0, 33)[1:] ** 1.4
NEAR = 140.0
"""Beyond this angle, deg, folds are looked at: the least one is at 145.64."""
_BLOCK = 4096
_STEPS = 50


def hop_phases(angle_deg: Floats, rho: Floats) -> Floats:
    """Phase phi = n t (K,), rad, of each hop; NaN beyond the fold.

    ``angle_deg`` (K,), from the V-bar towards the target's nadir, any number of degrees: the equation repeats after
    180. ``rho`` (K,), the share of the distance that is left. Raises ``InvalidInput`` for shares outside
    [0, 1 - 1e-6] and angles that are not finite.
    """
    turned, left = checked(angle_deg, rho)
    phases = np.empty(left.shape)
    for begin in range(0, len(left), _BLOCK):
        block = slice(begin, begin + _BLOCK)
        phases[block] = _phases(turned[block], left[block])
    return phases


def checked(angle_deg: Floats, rho: Floats) -> tuple[Floats, Floats]:
    """Angles (K,) in [0, 180) deg and shares (K,); raises ``InvalidInput`` as :func:`hop_phases`."""
    angle = np.asarray(angle_deg, dtype=np.float64)
    left = np.asarray(rho, dtype=np.float64)
    if not np.isfinite(angle).all():
        raise invalid("angle_deg", "finite degrees", float(angle[~np.isfinite(angle)][0]))
    fits = (left >= LEAST_RHO) & (left <= GREATEST_RHO)
    if not fits.all():
        raise invalid("rho", f"a share in [{LEAST_RHO:g}, 1 - 1e-6] of the distance", float(left[~fits][0]))
    return np.mod(angle, 180.0), left


def fold_deg(rho: float) -> float | None:
    """Angle up to which a hop that leaves ``rho`` exists, deg; None where every angle has one."""
    angle = float(fold_of(np.array([rho]))[1][0])
    return math.degrees(angle) if angle < math.pi else None


def hop_time(angle_deg: float, rho: float) -> tuple[float, float | None]:
    """Orbits that one hop takes, and the fold of its share, deg (None: none).

    Raises ``InvalidInput`` beyond the fold, with the reason.
    """
    phase = float(hop_phases(np.array([angle_deg]), np.array([rho]))[0])
    fold = fold_deg(rho)
    if math.isnan(phase):
        raise past_the_fold(angle_deg, rho)
    return phase / math.tau, fold


def past_the_fold(angle_deg: float, rho: float) -> InvalidInput:
    """The error for a hop that does not exist, with the reason."""
    return invalid(
        "angle_deg",
        f"an angle (modulo 180) up to {fold_deg(rho):.2f} deg for a hop that leaves {rho:.4g} of the distance: there "
        "the short hop meets a longer one, and beyond it neither exists",
        angle_deg,
    )


def _phases(turned: Floats, rho: Floats) -> Floats:
    """Phases of angles in [0, 180) deg."""
    theta = np.radians(turned)
    phases = np.full(rho.shape, np.nan)
    far = turned <= NEAR
    phases[far] = _first_root(theta[far], rho[far], None)
    if not far.all():
        near = np.flatnonzero(~far)
        top, end = fold_of(rho[near])
        branch = theta[near] <= end
        at = near[branch]
        phases[at] = _first_root(theta[at], rho[at], top[branch])
    phases[turned == 0.0] = math.pi
    return phases


def _sampled() -> Floats:
    """g at ``PHASES`` as it is linear in (1, S, rho, rho S, rho sin 2 theta), (5, L)."""

    def value(square: float, double: float, rho: float) -> Floats:
        secular = np.array(3.0 * square)
        terms = secular, (1.0 + secular) * (1.0 - rho), np.array(3.0 * rho * double), np.array(rho)
        sampled: Floats = residual(PHASES, terms)[0]
        return sampled

    plain = value(0.0, 0.0, 0.0)
    by_square, by_rho = value(1.0, 0.0, 0.0) - plain, value(0.0, 0.0, 1.0) - plain
    both = value(1.0, 0.0, 1.0) - plain - by_square - by_rho
    return np.array([plain, by_square, by_rho, both, value(0.0, 1.0, 1.0) - plain - by_rho])


SAMPLED = _sampled()
"""g at ``PHASES`` as it is linear in (1, S, rho, rho S, rho sin 2 theta), (5, L)."""


def _first_root(theta: Floats, rho: Floats, top: Floats | None) -> Floats:
    """First positive root of g (up to ``top``, if given): Newton's method from a chord, then a check."""
    terms = weights(theta, rho)
    square = terms[0] / 3.0
    features = np.empty((len(rho), 5))
    features[:, 0], features[:, 1], features[:, 2] = 1.0, square, rho
    features[:, 3], features[:, 4] = rho * square, terms[2] / 3.0
    values: Floats = features @ SAMPLED
    passed = values >= 0.0
    if top is not None:
        passed |= top[:, None] <= PHASES
    k = np.argmax(passed, axis=1)
    rows, before = np.arange(len(k)), np.maximum(k - 1, 0)
    below, above = values[rows, before], values[rows, k]
    low, high = np.where(k > 0, PHASES[before], 0.0), PHASES[k]
    with np.errstate(divide="ignore", invalid="ignore"):
        chord = low - below * (high - low) / (above - below)
        small = np.sqrt((1.0 - rho) / (1.5 * square))
    phi: Floats = np.where(k > 0, chord, np.minimum(small, 0.5 * high))
    if top is not None:
        high = np.minimum(high, top)
    step = phi
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for _ in range(4):
            value, slope = residual(phi, terms)
            step = value / slope
            phi = phi - step
    settled = (phi >= low) & (phi <= high) & (np.abs(step) < 1e-8 * phi)
    if not settled.all():
        left = ~settled
        phi[left] = _bracketed(
            low[left], high[left], (terms[0][left], terms[1][left], terms[2][left], rho[left])
        )
    return phi


def _bracketed(low: Floats, high: Floats, terms: tuple[Floats, Floats, Floats, Floats]) -> Floats:
    """Newton's method; a step that would leave the bracket halves it."""
    phi = 0.5 * (low + high)
    for _ in range(_STEPS):
        value, slope = residual(phi, terms)
        low, high = np.where(value < 0.0, phi, low), np.where(value < 0.0, high, phi)
        with np.errstate(divide="ignore", invalid="ignore"):
            trial = phi - value / slope
        moved = np.where((trial >= low) & (trial <= high), trial, 0.5 * (low + high))
        # Near a fold g is flat, and its rounding ends the search.
        settled = (np.abs(moved - phi) <= 1e-14 * phi) | (np.abs(value) <= 2e-16 * phi)
        phi = moved
        if settled.all():
            break
    return phi
