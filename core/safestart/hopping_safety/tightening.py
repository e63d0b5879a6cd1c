"""The least tightening of the barrier with which flown approaches show a demanded risk of an abort breach.

A level of kappa is chosen on one set of flights and confirmed on another, so that its share is not the luckiest of
several. A level is given up as soon as its breaches can no longer show the demand.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from safestart.errors import InvalidInput
from safestart.hopping_flights.fly import TIGHTENED, HoppingFlight, World, fly
from safestart.model.metrics import most_successes, wilson

Draws = Callable[[int], np.random.Generator]
"""Random numbers of run k."""
Tick = Callable[[int, str], None]


@dataclass(frozen=True, slots=True)
class Flights:
    """Approaches of one world: ``breaches`` of ``runs`` had an abort that enters the sphere; of ``lost`` runs guidance
    found no hop, and nothing is known. Fuel is the mean of those flown, m/s (NaN without one)."""

    runs: int
    breaches: int
    lost: int
    fuel_1norm: float
    fuel_2norm: float
    hold: float

    @property
    def shown(self) -> float:
        """The upper end of the Wilson interval of 95 %, with all lost runs as breaches."""
        interval = wilson(self.breaches + self.lost, self.runs)
        return 1.0 if interval is None else interval[1]


def flown(
    world: World, draws: Draws, runs: int, *, most: int | None = None, tick: Tick | None = None
) -> Flights | None:
    """Fly ``runs`` approaches; None as soon as there are more than ``most`` breaches, lost runs among them."""
    steer = world.controller()
    breaches, lost = 0, 0
    kept: list[HoppingFlight] = []
    for k in range(runs):
        if tick is not None:
            tick(k, f"approach {k + 1} of {runs}")
        try:
            kept.append(fly(world, draws(k), steer))
        except InvalidInput:
            # Past the fold of what is left: it is known of the estimate only while it flies.
            lost += 1
        else:
            breaches += bool((kept[-1].closest[:-1] < world.keep_out).any())
        if most is not None and breaches + lost > most:
            return None
    fuel = np.array([(one.fuel_1norm, one.fuel_2norm, one.hold) for one in kept]).reshape(-1, 3)
    means = fuel.mean(axis=0).tolist() if kept else [float("nan")] * 3
    return Flights(runs, breaches, lost, *means)


def least_tightening(
    world: World,
    kappas: Sequence[float],
    draws: Draws,
    fresh: Draws,
    runs: int,
    demand: float,
    tick: Tick | None = None,
) -> tuple[float, Flights] | None:
    """The first of ``kappas``, ascending, whose flights show ``demand``, with the flights that confirm it.

    Both the runs of ``draws`` and those of ``fresh`` must show it; the flights given are those of ``fresh``.
    """
    most = most_successes(runs, demand)
    for kappa in kappas:
        tightened = replace(world, barrier=TIGHTENED, kappa=kappa)
        if flown(tightened, draws, runs, most=most, tick=tick) is None:
            continue
        confirmed = flown(tightened, fresh, runs, most=most, tick=tick)
        if confirmed is not None:
            return kappa, confirmed
    return None
