"""Orbits and messages that the tests of this folder share."""

import math

import numpy as np

from safestart.interchange.attitude_course import AttitudeCourse
from safestart.interchange.covariance import Covariance
from safestart.interchange.ephemeris import Ephemeris
from safestart.interchange.epochs import SECOND, epochs_of
from safestart.model.orbit import MU

CREATED = "2026-01-01T00:00:00"
BEGIN = int(epochs_of(["2026-03-01T12:00:00"], "UTC")[0])


def kepler(
    a: float, e: float, angles: tuple[float, float, float], mean: float, times: np.ndarray
) -> np.ndarray:
    """States (K, 6) of a Kepler orbit: node, inclination, perigee, then the mean anomaly at t = 0."""
    n = math.sqrt(MU / a**3)
    anomaly = mean + n * times
    big = anomaly + e * np.sin(anomaly)
    for _ in range(60):
        big = big - (big - e * np.sin(big) - anomaly) / (1.0 - e * np.cos(big))
    b = math.sqrt(1.0 - e * e)
    r = a * (1.0 - e * np.cos(big))
    plane = np.stack([a * (np.cos(big) - e), a * b * np.sin(big), 0.0 * big], axis=1)
    speed = np.stack([-a * np.sin(big), a * b * np.cos(big), 0.0 * big], axis=1) * (n * a / r)[:, None]
    node, inclination, perigee = angles

    def rz(x: float) -> np.ndarray:
        return np.array([[math.cos(x), -math.sin(x), 0.0], [math.sin(x), math.cos(x), 0.0], [0.0, 0.0, 1.0]])

    c, s = math.cos(inclination), math.sin(inclination)
    turn = rz(node) @ np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]) @ rz(perigee)
    return np.concatenate([plane @ turn.T, speed @ turn.T], axis=1)


def course(
    *,
    frame: str = "EME2000",
    system: str = "UTC",
    count: int = 61,
    step: float = 10.0,
    mean: float = 0.3,
    covariance: str | None = "RTN_ROTATING",
    name: str = "TARGET",
) -> Ephemeris:
    """A LEO, with a covariance at its first epoch."""
    times = step * np.arange(count)
    states = kepler(7.0e6, 0.001, (0.4, 0.9, 1.3), mean, times)
    epochs = BEGIN + np.rint(times * SECOND).astype(np.int64)
    covariances = ()
    if covariance:
        root = (
            np.random.default_rng(3).normal(size=(6, 6))
            * np.array([3.0, 5.0, 2.0, 0.01, 0.02, 0.01])[:, None]
        )
        covariances = (Covariance(int(epochs[0]), covariance, root @ root.T),)
    return Ephemeris(name, "2020-001A", frame, system, epochs, states, covariances)


def turning(reference: str = "EME2000", count: int = 61, step: float = 10.0) -> AttitudeCourse:
    """A slow tumble."""
    times = step * np.arange(count)
    angle = 0.02 * times
    turns = np.stack(
        [np.cos(angle / 2), 0.6 * np.sin(angle / 2), 0.0 * angle, 0.8 * np.sin(angle / 2)], axis=1
    )
    epochs = BEGIN + np.rint(times * SECOND).astype(np.int64)
    return AttitudeCourse("TARGET", "2020-001A", reference, "SC_BODY_1", "UTC", epochs, turns)
