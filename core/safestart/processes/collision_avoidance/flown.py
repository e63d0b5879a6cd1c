"""The encounters of a job: every pilot against every adversary, and the supervised flights."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from safestart.collision_avoidance.encounters.adversary import adversary, until
from safestart.collision_avoidance.encounters.clock import Clock
from safestart.collision_avoidance.encounters.encounter import fly, lost
from safestart.collision_avoidance.encounters.observation import Observer
from safestart.collision_avoidance.encounters.pilots import pilot
from safestart.collision_avoidance.encounters.slot import Slot
from safestart.collision_avoidance.encounters.starts import approaching, certified_unsafe, near_boundary
from safestart.collision_avoidance.encounters.supervisor import Guards, Mode, Supervisor
from safestart.collision_avoidance.game import Game
from safestart.control.controller import Controller
from safestart.errors import InvalidInput
from safestart.model.metrics import wilson
from safestart.model.scenario import Floats
from safestart.processes.collision_avoidance.spec import CollisionAvoidanceInputs
from safestart.runtime.progress import Context
from safestart.simulation.record import Path, Record

CLEARANCE = 0.1
"""An evasion ends at the grid error plus this share of the keep-out distance."""
SHOWN = 12
"""Number of flights with paths kept for the pictures."""
RANDOM_HOLD_S = 10.0


@dataclass
class Encounters:
    """Rows for the wire, paths (K, n, 4) for the pictures by name, and what the supervisor did."""

    rows: list[dict[str, Any]] = field(default_factory=list)
    paths: dict[str, Floats] = field(default_factory=dict)
    supervisor: dict[str, int] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    def drawn(self, draw: Callable[[], Floats]) -> Floats | None:
        """Starts, or None with a note when the problem has too few."""
        try:
            return draw()
        except InvalidInput as error:
            if error.field != "encounters":
                raise
            self.notes.append(error.detail)
            return None

    def add(self, starts: str, pilot: str, opponent: str, flights: Record, observer: Observer) -> None:
        """Count one batch."""
        keep_out, error = observer.game.keep_out_m, observer.tube.grid_error_m
        breached, count = int(lost(flights, keep_out).sum()), len(flights)
        low, high = wilson(breached, count) or (0.0, 1.0)
        self.rows.append(
            {
                "starts": starts,
                "pilot": pilot,
                "adversary": opponent,
                "encounters": count,
                "lost": breached,
                "lost_beyond_error": int(lost(flights, keep_out - error).sum()),
                "breach_probability": breached / count,
                "breach_low": low,
                "breach_high": high,
                "least_separation_m": float(flights.margin.min()),
                "mean_delta_v_m_s": float(flights.delta_v.mean()),
            }
        )


def encounters(
    inputs: CollisionAvoidanceInputs, observer: Observer, slot: Slot, context: Context
) -> Encounters:
    """Fly all encounters of the inputs."""
    flown = Encounters()
    quiet = Context(cancelled=context.cancelled)
    game, count, seed = observer.game, inputs.encounters, inputs.seed
    guards = Guards(observer.tube.grid_error_m, CLEARANCE * game.keep_out_m)
    hold = max(1, round(RANDOM_HOLD_S / inputs.period_s))
    clock = Clock(inputs.period_s, inputs.horizon_s)
    sets: dict[str, tuple[Floats | None, Sequence[str]]] = {
        "outside": (
            flown.drawn(lambda: near_boundary(observer, count, inputs.band_m, seed, quiet)),
            inputs.adversaries,
        ),
        # Only these two adversaries force the loss from a start that is proved lost.
        "inside": (
            flown.drawn(lambda: certified_unsafe(observer, count, seed + 1, quiet)),
            [name for name in inputs.adversaries if name in ("worst", "mirror")],
        ),
    }  # fmt: skip

    def flier(name: str, when: Clock) -> Controller:
        if name == "supervisor":
            return Supervisor(observer, slot, guards, when)
        return pilot(name, observer, when, slot, inputs.fuel_price_s)

    batches = [
        (kind, starts, name, other)
        for kind, (starts, others) in sets.items()
        if starts is not None
        for name in inputs.pilots
        for other in others
    ]
    total = len(batches) + (len(batches) / 4.0 if inputs.supervised else 0.0)
    for index, (kind, starts, name, other) in enumerate(batches):
        context.step(index, total, f"{name} against {other}, {kind}")
        opponent = adversary(other, game, inputs.horizon_s, len(starts), seed + 2, hold)
        when = Clock(clock.period_s, clock.duration_s, receding=name == "supervisor")
        shown = kind == "outside" and other == inputs.adversaries[0] and name in ("certified", "hj", "pd")
        flights = fly(observer, starts, flier(name, when), opponent, when, quiet, keep_paths=shown)
        flown.add(kind, name, other, flights, observer)
        if shown:
            worst = np.argsort(flights.margin)[:SHOWN]
            flown.paths[name] = _in_game(game, [flights.paths[n] for n in worst])
    if inputs.supervised:
        context.step(len(batches), total, "supervised flights")
        _supervised(inputs, observer, slot, guards, hold, flown, quiet)
    return flown


def _supervised(
    inputs: CollisionAvoidanceInputs,
    observer: Observer,
    slot: Slot,
    guards: Guards,
    hold: int,
    flown: Encounters,
    quiet: Context,
) -> None:
    """Flights towards a close pass: first Player 2 acts, then the chaser must return to its slot."""
    game, count = observer.game, inputs.supervised
    radius = 1.5 * max(float(np.hypot(*slot.centre[:2])), 3.0 * game.keep_out_m)
    speed = float(observer.tube.lattice.high[-1])
    starts = flown.drawn(
        lambda: approaching(observer, radius, speed, count, guards.level_m, inputs.seed + 3, quiet)
    )
    if starts is None:
        return
    name = inputs.adversaries[0]
    opponent = adversary(name, game, inputs.horizon_s, count, inputs.seed + 4, hold)
    quiet_from = round(inputs.threat_s / inputs.period_s)
    clock = Clock(inputs.period_s, inputs.supervised_s, receding=True)
    supervisor = Supervisor(observer, slot, guards, clock)
    flights = fly(observer, starts, supervisor, until(opponent, quiet_from), clock, quiet, keep_paths=True)
    flown.add("approaching", "supervisor", name, flights, observer)
    paths = _in_game(game, flights.paths)
    flown.paths["supervisor"] = paths
    flown.supervisor = {
        "nominal_to_evasive": int(supervisor.switches[Mode.NOMINAL, Mode.EVASIVE]),
        "evasive_to_recovery": int(supervisor.switches[Mode.EVASIVE, Mode.RECOVERY]),
        "recovery_to_evasive": int(supervisor.switches[Mode.RECOVERY, Mode.EVASIVE]),
        "recovery_to_nominal": int(supervisor.switches[Mode.RECOVERY, Mode.NOMINAL]),
        "in_slot_at_the_end": int(slot.holds(paths[-1]).sum()),
    }


def _in_game(game: Game, paths: Sequence[Path]) -> Floats:
    """States (K + 1, N, 2 m) of N paths in the game's axes, for the pictures."""
    return game.from_lvlh(np.stack([path.states for path in paths], axis=1))
