"""One approach flown by the hopping controller about the true Earth, with an abort after every impulse."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from safestart.control.hopping import Hopping
from safestart.dynamics.burn_kernel import scattered
from safestart.dynamics.two_body_kernel import STAGES, WEIGHTS, drifted, placed, pushed, seen, target_at
from safestart.hopping.approach import distances, line, mean_motion_of
from safestart.hopping.barrier import Barrier, Noise
from safestart.hopping.hop_program import Weights
from safestart.model.scenario import Floats

OFF, NOMINAL, TIGHTENED = "off", "nominal", "tightened"
DISPERSION = 0.1
"""Starts are off by up to 10 % of each coordinate (paper 004, section 5), at least by these:"""
LEAST_POSITION, LEAST_VELOCITY = 1.0, 0.1


@dataclass(frozen=True, slots=True)
class World:
    """The approach, its orbit, its errors and its barrier; SI, angles in rad but for the line's, deg. ``drag``: the
    chaser's deceleration by drag less the target's, which neither guidance nor barrier knows."""

    semi_major_axis: float = 8.1e6
    eccentricity: float = 0.0
    inclination: float = 0.0
    angle_deg: float = 0.0
    start: float = 2000.0
    hold: float = 100.0
    hops: int = 5
    gamma: float | None = None
    keep_out: float = 50.0
    barrier: str = OFF
    kappa: float = 3.0
    noise: Noise = field(default_factory=Noise)
    bias: float = 0.0
    minimum_impulse: float = 0.0
    abort_orbits: float = 2.0
    dispersed: bool = True
    weights: Weights = field(default_factory=Weights)
    phase: float | None = None
    drag: float = 0.0

    @property
    def mean_motion(self) -> float:
        """rad/s."""
        return mean_motion_of(self.semi_major_axis)

    def controller(self) -> Hopping:
        """The controller of this approach."""
        n = self.mean_motion
        barrier = None
        if self.barrier != OFF:
            kappa = self.kappa if self.barrier == TIGHTENED else 0.0
            barrier = Barrier(n, self.keep_out, kappa, self.noise, self.abort_orbits)
        d = distances(self.start, self.hold, self.hops, self.gamma)
        return Hopping(
            n, self.angle_deg, d, weights=self.weights, barrier=barrier,
            minimum_impulse=self.minimum_impulse, phase=self.phase,
        )  # fmt: skip


@dataclass(frozen=True, slots=True)
class HoppingFlight:
    """One approach: ``impulses`` (hops + 1, 3) as given, m/s, ``times`` (hops + 1,), s; ``closest`` (hops + 1,), m: the
    least distance when the thrusters die right after each; ``states`` (hops + 1, 6) LVLH after each impulse; ``hold``:
    distance at the end, m; ``feasible``: whether every true row of the barrier held."""

    impulses: Floats
    closest: Floats
    states: Floats
    times: Floats
    hold: float
    feasible: bool

    @property
    def fuel_1norm(self) -> float:
        """m/s."""
        return float(np.abs(self.impulses).sum())

    @property
    def fuel_2norm(self) -> float:
        """m/s."""
        return float(np.linalg.norm(self.impulses, axis=1).sum())


def fly(
    world: World, rng: np.random.Generator, controller: Hopping | None = None, *, aborts: bool = True
) -> HoppingFlight:
    """Fly one approach; every number drawn comes from ``rng``."""
    steer = controller or world.controller()
    count, noise = world.hops + 1, world.noise
    draws = rng.standard_normal((count, 9))
    target = target_at(world.semi_major_axis, world.eccentricity, world.inclination)
    flight = placed(target, _start(world, rng))
    bias = world.bias * noise.position * rng.standard_normal(3)
    horizon = world.abort_orbits * math.tau / world.mean_motion
    impulses, closest, states = np.empty((count, 3)), np.full(count, np.nan), np.empty((count, 6))
    times, now, feasible = np.empty(count), 0.0, True
    for k in range(count):
        believed = seen(flight)
        believed[:3] += noise.position * draws[k, :3] + bias
        believed[3:] += noise.velocity * draws[k, 3:6]
        command = steer.command(k, believed)
        feasible = feasible and command.feasible
        given = np.zeros(3) if command.impulse is None else command.impulse
        impulses[k], times[k] = given, now
        pushed(flight, scattered(given, noise.share, noise.angle, draws[k, 6:]))
        states[k] = seen(flight)
        if aborts:
            _, closest[k] = drifted(flight, horizon, STAGES, WEIGHTS, world.drag)
        if k + 1 < count:
            flight, _ = drifted(flight, steer.wait(), STAGES, WEIGHTS, world.drag)
            now += steer.wait()
    return HoppingFlight(impulses, closest, states, times, float(np.linalg.norm(seen(flight)[:3])), feasible)


def _start(world: World, rng: np.random.Generator) -> Floats:
    """At rest on the line, dispersed evenly."""
    state = np.concatenate([world.start * line(world.angle_deg), np.zeros(3)])
    if not world.dispersed:
        return state
    least = np.repeat([LEAST_POSITION, LEAST_VELOCITY], 3)
    off: Floats = state + np.maximum(DISPERSION * np.abs(state), least) * rng.uniform(-1.0, 1.0, 6)
    return off
