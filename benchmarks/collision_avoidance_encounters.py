"""Encounters of the avoid game by the thousand: ``python -m benchmarks.collision_avoidance_encounters [COUNT]``.

Starts near the boundary of the unsafe set, outside it, and starts proved unsafe, by every pilot against every
adversary. Exit status 1 if the certified evasion loses one from outside by more than the grid error, or a start
proved unsafe is not lost to the mirror.
"""

from __future__ import annotations

import sys
import time

import numpy as np

from benchmarks.asked import parser
from safestart.collision_avoidance.encounters.adversary import ADVERSARIES, adversary
from safestart.collision_avoidance.encounters.clock import Clock
from safestart.collision_avoidance.encounters.encounter import fly
from safestart.collision_avoidance.encounters.encounter import lost as breached
from safestart.collision_avoidance.encounters.observation import Observer
from safestart.collision_avoidance.encounters.pilots import PILOTS, pilot
from safestart.collision_avoidance.encounters.slot import Slot
from safestart.collision_avoidance.encounters.starts import certified_unsafe, near_boundary
from safestart.collision_avoidance.encounters.supervisor import Guards, Supervisor
from safestart.collision_avoidance.game import Game
from safestart.collision_avoidance.tube import solve_tube
from safestart.collision_avoidance.tube_settings import TubeSettings
from safestart.constraints.thrust import InputSet
from safestart.model.metrics import wilson
from safestart.runtime.progress import Context

HORIZON_S, BAND_M, SEED = 60.0, 20.0, 0
GAME = Game(0.0011, InputSet("box", (0.1, 0.1)), InputSet("box", (0.05, 0.05)), 100.0)
SETTINGS = TubeSettings("very_high", (31, 15), (450.0, 6.0), kept=7)


def study(count: int) -> int:
    """Print one line per pilot, adversary and set of starts."""
    tube = solve_tube(GAME, HORIZON_S, SETTINGS)
    observer, slot, error = Observer(GAME, tube), Slot(), tube.grid_error_m
    print(f"grid error {error:.2f} m, keep-out {GAME.keep_out_m:g} m, {count} starts each", flush=True)
    outside = near_boundary(observer, count, BAND_M, SEED, Context())
    inside = certified_unsafe(observer, count, SEED + 1, Context())
    failed = 0
    for kind, starts, others in (("outside", outside, ADVERSARIES), ("inside", inside, ("worst", "mirror"))):
        for name in (*PILOTS, "supervisor"):
            for other in others:
                begin = time.process_time()
                opponent = adversary(other, GAME, HORIZON_S, count, SEED + 2, 10)
                supervised = name == "supervisor"
                clock = Clock(1.0, HORIZON_S, supervised)
                flier = (
                    Supervisor(observer, slot, Guards(error, 10.0), clock)
                    if supervised
                    else pilot(name, observer, clock, slot)
                )
                flights = fly(observer, starts, flier, opponent, clock)
                lost = int(breached(flights, GAME.keep_out_m).sum())
                beyond = int(breached(flights, GAME.keep_out_m - error).sum())
                low, high = wilson(lost, count) or (0.0, 1.0)
                print(
                    f"{kind:8} {name:10} {other:8} lost {lost:6} [{100 * low:.3f}, {100 * high:.3f}] %, "
                    f"beyond the error {beyond:6}, least {flights.margin.min():7.2f} m, "
                    f"{np.mean(flights.delta_v):5.2f} m/s, {time.process_time() - begin:.1f} s",
                    flush=True,
                )
                failed |= kind == "outside" and name == "certified" and beyond > 0
                failed |= kind == "inside" and other == "mirror" and lost < count
    return int(failed)


if __name__ == "__main__":
    asked = parser(__doc__)
    asked.add_argument("count", nargs="?", type=int, default=10_000)
    given = asked.parse_args()
    sys.exit(study(given.count))
