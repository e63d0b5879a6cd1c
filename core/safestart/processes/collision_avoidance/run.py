"""Run collision-avoidance: the tube, the capture set, the escapes, the encounters, the verdicts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from safestart.collision_avoidance.encounters.escape import MODES
from safestart.collision_avoidance.encounters.escape import fly as escape
from safestart.collision_avoidance.encounters.observation import Observer
from safestart.collision_avoidance.encounters.slot import Slot
from safestart.collision_avoidance.game import Game, Players
from safestart.collision_avoidance.tube import Tube, solve_tube
from safestart.collision_avoidance.tube_settings import TubeSettings
from safestart.constraints.thrust import InputSet
from safestart.model.metrics import wilson
from safestart.processes.base import ProcessOutput
from safestart.processes.collision_avoidance.captured import Captured, captured
from safestart.processes.collision_avoidance.conjunction import asked
from safestart.processes.collision_avoidance.encounter_plots import flights_picture, matrix_picture
from safestart.processes.collision_avoidance.flown import Encounters, encounters
from safestart.processes.collision_avoidance.judged import judge
from safestart.processes.collision_avoidance.plots import (
    capture_picture,
    capture_space_picture,
    escape_picture,
    slices,
    unsafe_picture,
)
from safestart.processes.collision_avoidance.spec import CollisionAvoidanceInputs
from safestart.processes.plotting import npz
from safestart.processes.wire import finite
from safestart.runtime.progress import Context

ORBIT_WITHOUT_ROTATION_S = 5400.0

NOTES = [
    "Paper 001 prints inf over u, sup over d in eq. (12), which is Player 1 seeking the collision; here it evades.",
    "certified flies the best constant sum u + d that is proved to keep the distance, and the level set's gradient "
    "where none is; hj flies the gradient alone, which on a grid mistakes left for right near a head-on course.",
    "mirror answers u with -k u and so holds the sum u + d to the set that proves starts lost; it has to read u.",
    "Escape mode 3: braking lowers the orbit: the chaser falls behind for a fifth of an orbit, then drifts ahead; "
    "modes 1 and 2 leave no drift and are back at their start after one orbit.",
    "The model is linear and planar; what is proved is proved for it.",
]


def game_of(inputs: CollisionAvoidanceInputs, *, in_space: bool = False) -> Game:
    """The game in SI units; the planar disk is the section of a cylinder in space, so that z stays decoupled."""
    shape = {"box": "box", "disk": "cylinder" if in_space else "disk"}[inputs.shape]
    numbers = {"box": 3 if in_space else 2, "disk": 1, "cylinder": 2}[shape]

    def bound(size: float) -> InputSet:
        return InputSet(shape, (size,) * numbers)

    return Game(
        inputs.mean_motion_rad_s, bound(inputs.thrust_m_s2), bound(inputs.disturbance_m_s2), inputs.keep_out_m
    )


def slot_of(inputs: CollisionAvoidanceInputs) -> Slot:
    """The recovery box."""
    slot = inputs.slot
    speed = slot.half_speed_m_s
    return Slot((slot.x_m, slot.y_m, 0.0, 0.0), (slot.half_x_m, slot.half_y_m, speed, speed))


def tube_of(inputs: CollisionAvoidanceInputs, game: Game, context: Context) -> Tube:
    """Solve the game."""
    grid = inputs.grid
    settings = TubeSettings(
        grid.accuracy,
        (grid.nodes_position, grid.nodes_speed),
        None if grid.box is None else (grid.box.position_m, grid.box.speed_m_s),
        kept=grid.kept,
        players=Players(inputs.players),
        fuel_price=inputs.fuel_price_s,
    )
    return solve_tube(game, inputs.horizon_s, settings, context)


def run(inputs: CollisionAvoidanceInputs, context: Context) -> ProcessOutput:
    """Verdicts and tables, five or six pictures, the values as arrays."""
    inputs, conjunction = asked(inputs)
    game, slot = game_of(inputs), slot_of(inputs)
    tube = tube_of(inputs, game, context.part(0.0, 0.4, 1.0, "value"))
    taken = captured(inputs, game, slot, context.part(0.4, 0.1, 1.0, "capture set"))
    orbit = 2.0 * math.pi / game.mean_motion if game.mean_motion > 0.0 else ORBIT_WITHOUT_ROTATION_S
    escapes = [escape(game, mode, np.zeros(6), inputs.burn_s, orbit) for mode in MODES]
    flown = Encounters()
    if not tube.failure and inputs.players == "avoid":
        flown = encounters(inputs, Observer(game, tube), slot, context.part(0.5, 0.4, 1.0, "encounters"))
    judged = judge(inputs, tube, game_of(inputs, in_space=True), context.part(0.9, 0.05, 1.0, "states"))
    context.step(0.95, 1.0, "pictures")
    drawn = slices(inputs, tube)
    artifacts = [unsafe_picture(inputs, drawn, tube)] if drawn else []
    missing = len(inputs.slices_m_s) - len(drawn)
    if missing:
        flown.notes.append(f"{missing} of the slices: faster than the grid's box, not drawn.")
    if flown.rows:
        artifacts += [matrix_picture(flown.rows), flights_picture(inputs, flown)]
    artifacts += [
        capture_picture(inputs, taken),
        capture_space_picture(inputs, game, slot),
        escape_picture(escapes, inputs.burn_s, orbit),
        npz("sets.npz", {**_arrays(tube), **taken.arrays()}),
    ]
    check = tube.check
    document = {
        "failure": tube.failure,
        "requirements": _requirements(inputs, flown),
        "states": judged,
        **({} if conjunction is None else {"conjunction": conjunction}),
        "encounters": flown.rows,
        "grid_error_m": finite(tube.grid_error_m),
        "nodes": {} if check is None else {k: v for k, v in check.document().items() if isinstance(v, int)},
        "unsafe_percent": None if tube.failure else float(100.0 * (tube.values[-1] <= 0.0).mean()),
        "supervisor": flown.supervisor,
        "escape": [
            {
                "mode": one.mode.title,
                "paper_says": one.mode.claim,
                "drift_m_s": one.drift_m_s,
                "altitude_m": one.altitude_m,
                "overtakes_s": finite(one.overtakes_s),
            }
            for one in escapes
        ],
        "capture": taken.rows(inputs.capture_radial_m_s),
        "capture_level_set": taken.agreement,
        "notes": [*tube.warnings, *flown.notes, *_said(taken), *NOTES],
    }
    return ProcessOutput(document, tuple(artifacts))


def _said(taken: Captured) -> list[str]:
    return [taken.note] if taken.note else []


def _arrays(tube: Tube) -> dict[str, Any]:
    names = ("x_m", "y_m", "vx_m_s", "vy_m_s")
    axes = dict(zip(names, tube.lattice.axes, strict=True))
    return {**axes, "value_m": tube.values[-1], "level_set_value_m": tube.raw[-1]}


def _requirements(inputs: CollisionAvoidanceInputs, flown: Encounters) -> list[dict[str, Any]]:
    def rows(starts: str, pilot: str | None = None, other: str | None = None) -> list[dict[str, Any]]:
        return [
            row
            for row in flown.rows
            if row["starts"] == starts and pilot in (None, row["pilot"]) and other in (None, row["adversary"])
        ]

    evading = rows("outside", "certified")
    found = [
        _requirement("certified evasion keeps the separation", evading, "lost"),
        _requirement("certified evasion keeps it up to the grid error", evading, "lost_beyond_error"),
        _requirement("a start proved unsafe is lost to the mirror", rows("inside", None, "mirror"), "kept"),
    ]
    if inputs.supervised:
        supervised = rows("approaching")
        found.append(_requirement("supervised flights keep the separation", supervised, "lost"))
        count, back = (
            sum(r["encounters"] for r in supervised),
            flown.supervisor.get("in_slot_at_the_end", 0),
        )
        found.append(_verdict("supervised flights are back in the slot at the end", count, count - back))
    return found


def _requirement(text: str, rows: Sequence[dict[str, Any]], broken: str) -> dict[str, Any]:
    count = sum(row["encounters"] for row in rows)
    lost = sum(row["lost"] for row in rows)
    return _verdict(text, count, count - lost if broken == "kept" else sum(row[broken] for row in rows))


def _verdict(text: str, count: int, broken: int) -> dict[str, Any]:
    interval = wilson(broken, count)
    verdict = "UNDECIDED" if interval is None else "BROKEN" if broken else "HELD"
    low, high = interval or (None, None)
    probability = broken / count if count else None
    return {
        "requirement": text, "verdict": verdict, "encounters": count, "broken": broken,
        "probability": probability, "low": low, "high": high,
    }  # fmt: skip
