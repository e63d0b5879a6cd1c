"""Relative states: two courses around the Earth to the chaser's state in the target's LVLH.

x is along r, z along r x v, y completes them (along-track): the axes that CCSDS calls RTN or RSW, of the target. They
turn at |r x v| / r^2 about z; the velocity is that against these turning axes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from safestart.interchange.covariance import Covariance, Sense, into_axes, other_sense
from safestart.interchange.ephemeris import Ephemeris
from safestart.interchange.epochs import Nanoseconds
from safestart.interchange.frames import require_comparable, rotation_to_gcrf
from safestart.interchange.sampling import states_at
from safestart.model.orbit import MU
from safestart.model.scenario import Bools, Floats


@dataclass(frozen=True)
class Relative:
    """The relative motion of two courses at TAI ``epochs`` (K,), ns.

    ``states`` (K, 6): the chaser in LVLH, m and m/s; ``axes`` (K, 3, 3): GCRF coordinates to LVLH; ``rates`` (K,) rad/s
    about z. ``known`` (K,) is False, and the rest NaN, where a file has a gap or ends. ``target`` (K, 6) is in GCRF.
    """

    epochs: Nanoseconds
    states: Floats
    axes: Floats
    rates: Floats
    target: Floats
    known: Bools

    def where(self, chosen: Bools) -> Relative:
        """Keep the epochs where ``chosen`` (K,) is True."""
        return Relative(
            self.epochs[chosen],
            self.states[chosen],
            self.axes[chosen],
            self.rates[chosen],
            self.target[chosen],
            self.known[chosen],
        )

    def mean_motions(self) -> Floats:
        """(K,) rad/s, of the target's osculating orbit."""
        r, v = np.linalg.norm(self.target[:, :3], axis=1), np.linalg.norm(self.target[:, 3:], axis=1)
        inverse = 2.0 / r - v * v / MU
        out: Floats = np.sqrt(MU * np.maximum(inverse, 0.0) ** 3)
        return out

    def eccentricities(self) -> Floats:
        """(K,), of the target's osculating orbit."""
        position, velocity = self.target[:, :3], self.target[:, 3:]
        momentum = np.cross(position, velocity)
        vector = np.cross(velocity, momentum) / MU - position / np.linalg.norm(position, axis=1)[:, None]
        out: Floats = np.linalg.norm(vector, axis=1)
        return out


def relative_states(chaser: Ephemeris, target: Ephemeris, epochs: Nanoseconds) -> Relative:
    """The chaser in the target's LVLH at TAI ``epochs`` (K,); the frames of the two files may differ.

    Raises ``InvalidInput`` as :func:`safestart.interchange.frames.require_comparable` does.
    """
    require_comparable(chaser.frame, target.frame)
    from_chaser, of_chaser = states_at(chaser, epochs)
    from_target, of_target = states_at(target, epochs)
    known = of_chaser & of_target
    axes, rates = lvlh_axes(from_target)
    return Relative(
        np.asarray(epochs), in_lvlh(from_chaser, from_target, axes, rates), axes, rates, from_target, known
    )


def lvlh_axes(target: Floats) -> tuple[Floats, Floats]:
    """Rotations (K, 3, 3), inertial to LVLH, and rates (K,), rad/s about z, of inertial states (K, 6)."""
    position, velocity = target[:, :3], target[:, 3:]
    momentum = np.cross(position, velocity)
    radius, size = np.linalg.norm(position, axis=1), np.linalg.norm(momentum, axis=1)
    x, z = position / radius[:, None], momentum / size[:, None]
    return np.stack([x, np.cross(z, x), z], axis=1), size / radius**2


def in_lvlh(chaser: Floats, target: Floats, axes: Floats, rates: Floats) -> Floats:
    """Inertial states (K, 6) of a chaser in LVLH of the target: R dr and R dv - omega x R dr."""
    position = np.einsum("kij,kj->ki", axes, chaser[:, :3] - target[:, :3])
    velocity = np.einsum("kij,kj->ki", axes, chaser[:, 3:] - target[:, 3:])
    velocity[:, 0] += rates * position[:, 1]
    velocity[:, 1] -= rates * position[:, 0]
    return np.concatenate([position, velocity], axis=1)


def to_inertial(states: Floats, target: Floats) -> Floats:
    """Inverse of :func:`in_lvlh`: inertial states (K, 6) of a chaser with LVLH ``states`` (K, 6)."""
    axes, rates = lvlh_axes(target)
    velocity = states[:, 3:].copy()
    velocity[:, 0] -= rates * states[:, 1]
    velocity[:, 1] += rates * states[:, 0]
    position = np.einsum("kji,kj->ki", axes, states[:, :3])
    out: Floats = np.concatenate([position, np.einsum("kji,kj->ki", axes, velocity)], axis=1) + target
    return out


def covariance_in_lvlh(covariance: Covariance, own: Floats, target: Floats, sense: Sense) -> Floats:
    """(6, 6): a covariance in LVLH of ``target`` (6,), inertial, in the given sense.

    One in RTN is in the axes of its own object, whose inertial state is ``own`` (6,): these are turned into the
    target's.
    """
    (axes,), (rate,) = lvlh_axes(target[None, :])
    spin = np.array([0.0, 0.0, rate])
    if not covariance.frame.startswith("RTN"):
        (turn,) = rotation_to_gcrf(covariance.frame, np.array([covariance.epoch]))
        return into_axes(covariance.matrix, axes @ turn, spin, sense)
    (own_axes,), (own_rate,) = lvlh_axes(own[None, :])
    matrix = covariance.matrix
    if covariance.frame == "RTN_ROTATING":
        matrix = other_sense(matrix, np.array([0.0, 0.0, own_rate]), "inertial")
    return into_axes(matrix, axes @ own_axes.T, spin, sense)
