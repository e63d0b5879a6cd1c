"""How uncertain the chaser's state is at an instant: boxes of starts from the covariances in the files.

The errors of chaser and target are taken as independent and normal. The LVLH that a box is in is that of the target's
nominal state: an error of the target turns it by its share of the orbit's radius, which moves a chaser 100 m away by a
hundred-thousandth of that error.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from safestart.errors import invalid
from safestart.interchange.covariance import Covariance, box_at
from safestart.interchange.ephemeris import Ephemeris
from safestart.interchange.epochs import SECOND, Nanoseconds
from safestart.interchange.relative import covariance_in_lvlh
from safestart.interchange.sampling import LONGEST_STEP_S, states_at
from safestart.model.scenario import Floats, number


@dataclass(frozen=True)
class Spread:
    """Variances (K, 6), m^2 and m^2/s^2, in LVLH as it turns, at rising TAI ``epochs`` (K,) of one file."""

    epochs: Nanoseconds
    variances: Floats

    def at(self, epochs: Nanoseconds) -> Floats:
        """Variances (M, 6) at instants: of an entry there, else of both neighbours the greater in each component.

        NaN before the first entry, after the last, and between two that are further apart than a gap of states.
        """
        out = np.full((len(epochs), 6), np.nan)
        after = np.searchsorted(self.epochs, epochs)
        last = len(self.epochs) - 1
        there = self.epochs[np.minimum(after, last)] == epochs
        out[there] = self.variances[after[there]]
        between = ~there & (after > 0) & (after <= last)
        right = after[between]
        near = (self.epochs[right] - self.epochs[right - 1]) <= round(LONGEST_STEP_S * SECOND)
        larger = np.maximum(self.variances[right], self.variances[right - 1])
        out[between] = np.where(near[:, None], larger, np.nan)
        return out


@dataclass(frozen=True)
class StartBoxes:
    """Boxes that hold the chaser's relative state with at least the probability ``confidence``."""

    confidence: float
    spreads: tuple[Spread, ...]

    def half_widths(self, epochs: Nanoseconds) -> Floats:
        """(M, 6), m and m/s, LVLH, at TAI ``epochs`` (M,); NaN where a file has no covariance near."""
        total = np.sum([spread.at(epochs) for spread in self.spreads], axis=0)
        unit = box_at(np.eye(6), self.confidence)
        out: Floats = np.sqrt(total) * unit
        return out


def start_boxes(
    chaser: Ephemeris,
    target: Ephemeris,
    covariances: tuple[Sequence[Covariance], Sequence[Covariance]],
    confidence: float,
) -> StartBoxes:
    """The boxes of two courses in GCRF with the covariances of each; one of them may have none.

    Raises ``InvalidInput`` for a confidence outside [0.5, 1 - 1e-9], and where no file holds a covariance.
    """
    number("confidence", confidence, 0.5, 1.0 - 1e-9)
    spreads = [
        _spread(own, target, given) for own, given in zip((chaser, target), covariances, strict=True) if given
    ]
    if not spreads:
        raise invalid("confidence", "a file with covariances where a confidence is given", "none in either")
    return StartBoxes(confidence, tuple(spreads))


def _spread(own: Ephemeris, target: Ephemeris, covariances: Sequence[Covariance]) -> Spread:
    epochs = np.array([one.epoch for one in covariances])
    order = np.argsort(epochs, kind="stable")
    epochs = epochs[order]
    if (np.diff(epochs) == 0).any():
        raise invalid("covariance", "one covariance at each epoch", "two at one")
    from_own, _ = states_at(own, epochs)
    from_target, _ = states_at(target, epochs)
    variances = np.full((len(epochs), 6), np.nan)
    for k, index in enumerate(order.tolist()):
        if np.isfinite(from_own[k]).all() and np.isfinite(from_target[k]).all():
            matrix = covariance_in_lvlh(covariances[index], from_own[k], from_target[k], "rotating")
            variances[k] = np.diagonal(matrix)
    return Spread(epochs, variances)
