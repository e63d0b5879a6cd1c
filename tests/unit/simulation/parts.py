"""One small part of each kind, as somebody who extends safestart would write it; see docs/extending.md."""

from dataclasses import dataclass

import numpy as np

from safestart.attitude.attitude import Attitude
from safestart.control.controller import Command
from safestart.dynamics.motion import RelativeMotion
from safestart.model.scenario import Floats


@dataclass(frozen=True)
class DoubleIntegrator(RelativeMotion):
    """A motion: no gravity at all."""

    def transition(self, t0: float, t1: float) -> Floats:
        phi = np.eye(6)
        phi[:3, 3:] = (t1 - t0) * np.eye(3)
        return phi

    def held(self, t0: float, t1: float) -> Floats:
        tau = t1 - t0
        return np.concatenate([0.5 * tau * tau * np.eye(3), tau * np.eye(3)])


@dataclass(frozen=True)
class Nodding:
    """An attitude: the body swings about x by ``angle`` sin(``rate`` t)."""

    angle: float
    rate: float

    def rotation(self, times: Floats) -> Floats:
        swing = self.angle * np.sin(self.rate * np.asarray(times))
        out = np.zeros((*swing.shape, 3, 3))
        out[..., 0, 0] = 1.0
        out[..., 1, 1] = out[..., 2, 2] = np.cos(swing)
        out[..., 1, 2] = np.sin(swing)
        out[..., 2, 1] = -np.sin(swing)
        return out

    def angular_velocity(self, times: Floats) -> Floats:
        out = np.zeros((*np.shape(times), 3))
        out[..., 0] = self.angle * self.rate * np.cos(self.rate * np.asarray(times))
        return out

    def rate_bounds(self) -> tuple[float, float]:
        return abs(self.angle * self.rate), abs(self.angle * self.rate**2)


@dataclass(frozen=True)
class KeepOut:
    """A constraint: a ball around the target that the chaser must not enter; it looks the same from every attitude."""

    radius: float
    names: tuple[str, ...] = ("keep_out",)

    def room(self, times: Floats, states: Floats, attitude: Attitude) -> tuple[Floats, Floats]:
        distance = np.linalg.norm(states[:, :3], axis=1)
        closing = np.einsum("ti,ti->t", states[:, :3], states[:, 3:]) / distance
        return (distance - self.radius)[:, None], closing[:, None]


class Damper:
    """A controller: thrust against the velocity, as far as ``limit`` m/s^2 allows."""

    def __init__(self, limit: float) -> None:
        self.limit = limit
        self.started: list[Floats] = []

    def begin(self, state: Floats) -> None:
        self.started.append(state)

    def command(self, k: int, state: Floats) -> Command:
        wanted = -0.2 * state[3:]
        size = float(np.linalg.norm(wanted))
        return Command(
            wanted * min(1.0, self.limit / size) if size > 0.0 else wanted, size <= self.limit, "damp"
        )
