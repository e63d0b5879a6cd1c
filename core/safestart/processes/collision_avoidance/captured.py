"""Slices of the capture set by flight, and a level set of the same slices compared with flights."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from safestart.collision_avoidance.capture import arrival_times, compare, level_set
from safestart.collision_avoidance.encounters.slot import RECOVERY, Slot
from safestart.collision_avoidance.game import Game
from safestart.levelset import Lattice, Options, Scheme
from safestart.model.scenario import Floats
from safestart.processes.collision_avoidance.spec import CollisionAvoidanceInputs
from safestart.runtime.progress import Context

HALF_WIDTH_M, SPEED_M_S, POINTS = 2000.0, 8.0, 61
BEYOND = 1.3
"""Fly for this many horizons, so that the set's edge can be interpolated between points."""
# Coarse on purpose: it only shows, beside the flights, how badly a grid resolves the paper's thin box.
_SHAPE, _STATES = (21, 21, 13, 13), 4000


@dataclass(frozen=True, slots=True)
class Captured:
    """``times`` (S, POINTS, POINTS): arrival from [x, y] with only the slice's radial speed; inf: no arrival.

    Points with a time within ``horizon`` are captured; ``times`` go beyond it.
    """

    x: Floats
    y: Floats
    times: Floats
    horizon: float
    agreement: dict[str, Any]
    note: str

    def rows(self, radial: list[float]) -> list[dict[str, Any]]:
        """One row per slice."""
        found = []
        for speed, times in zip(radial, self.times, strict=True):
            arrived = times[times <= self.horizon]
            median = float(np.median(arrived)) if arrived.size else None
            share = 100.0 * arrived.size / times.size
            found.append({"radial_m_s": speed, "captured_percent": share, "median_s": median})
        return found

    def arrays(self) -> dict[str, Floats]:
        """Arrays for the NPZ."""
        return {"capture_x_m": self.x, "capture_y_m": self.y, "capture_time_s": self.times}


def captured(inputs: CollisionAvoidanceInputs, game: Game, slot: Slot, context: Context) -> Captured:
    """Fly every slice, then compare a level set with flights from some of its nodes."""
    x, y = (slot.centre[k] + np.linspace(-HALF_WIDTH_M, HALF_WIDTH_M, POINTS) for k in range(2))
    places = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
    times = []
    for index, speed in enumerate(inputs.capture_radial_m_s):
        context.step(index, len(inputs.capture_radial_m_s) + 2, "flights")
        states = np.concatenate([places, np.broadcast_to([0.0, speed], places.shape)], axis=-1)
        times.append(arrival_times(game, slot, RECOVERY, states, BEYOND * inputs.capture_horizon_s))
    ends = np.array([HALF_WIDTH_M, HALF_WIDTH_M, SPEED_M_S, SPEED_M_S])
    centre = np.array(slot.centre)
    lattice = Lattice.of(centre - ends, centre + ends, _SHAPE)
    quiet = Context(cancelled=context.cancelled)
    solution = level_set(
        game, slot, RECOVERY, lattice, inputs.capture_horizon_s, Options(Scheme.FIRST), quiet
    )
    nodes = np.stack(np.meshgrid(*lattice.axes, indexing="ij"), axis=-1).reshape(-1, 4)
    states = nodes[np.random.default_rng(inputs.seed).choice(len(nodes), _STATES, replace=False)]
    flown = arrival_times(game, slot, RECOVERY, states, inputs.capture_horizon_s)
    counts = compare(solution, flown, states)
    agreement = {"failure": solution.failure} if counts is None else asdict(counts)
    thin = min(np.array(slot.half) / lattice.spacing)
    note = (
        f"Capture: the recovery box is {thin:.2g} cells thin on the level set's grid (21 x 21 x 13 x 13), which "
        "loses it; the flights are exact."
        if thin < 0.5
        else ""
    )
    return Captured(x, y, np.array(times), inputs.capture_horizon_s, agreement, note)
