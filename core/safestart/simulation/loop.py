"""The loop: fly any controller in any plant under any constraints, one control interval after another."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from safestart.constraints.constraint import Constraint
from safestart.control.controller import Command, Controller
from safestart.errors import invalid
from safestart.model.scenario import Floats
from safestart.simulation.noise import EXACT, Errors
from safestart.simulation.planar import watched_flight
from safestart.simulation.plant import Plant
from safestart.simulation.record import Path, Record
from safestart.simulation.watch import Watched


def fly(
    plant: Plant,
    constraints: Sequence[Constraint],
    controller: Controller,
    start: Floats,
    steps: int,
    dt: float,
    errors: Errors = EXACT,
) -> Record:
    """Fly one start, an LVLH state (6,), for ``steps`` intervals of ``dt`` seconds or to its first violation.

    The record has one flight and its path at the control nodes. Raises ``InvalidInput`` for another shape of start.
    """
    if np.shape(start) != (6,):
        raise invalid("start", "an LVLH state of shape (6,)", np.shape(start))
    return fly_watched(watched_flight(plant, constraints, start, dt), controller, steps, dt, errors)


def fly_watched(flight: Watched, controller: Controller, steps: int, dt: float, errors: Errors) -> Record:
    """The loop over a prepared flight."""
    times, states = [flight.time], [flight.state.copy()]
    commands: list[Command] = []
    held: list[Floats] = []
    kicks = np.zeros((steps, 3))
    delta_v = peak = 0.0
    controller.begin(states[0])
    for k in range(steps):
        # This form of the test also ends the flight at a NaN.
        if not flight.margin >= 0.0:
            break
        # A copy: a flight may change its state in place, and a controller may keep the array.
        command = controller.command(k, errors.seen(k, states[-1]))
        thrust = errors.delivered(k, command.thrust, dt)
        size = math.sqrt(float(thrust @ thrust))
        delta_v += size * dt
        peak = max(peak, size)
        impulse = command.impulse
        if impulse is not None:
            impulse = errors.delivered(k, impulse, 1.0)
            delta_v += math.sqrt(float(impulse @ impulse))
            kicks[k] = impulse
        push = errors.push(k, states[-1], thrust)
        flight.fly(thrust if push is None else thrust + push, impulse)
        commands.append(command)
        held.append(thrust)
        times.append(flight.time)
        states.append(flight.state.copy())
    thrusts = np.array(held).reshape(-1, 3)
    impulses = kicks[: len(commands) if kicks.any() else 0]
    path = Path(np.array(times), np.array(states), thrusts, tuple(commands), impulses)
    fallbacks = sum(not command.feasible for command in commands)
    return Record(
        np.array([flight.margin]),
        np.array([flight.violated_at]),
        np.array([delta_v]),
        np.array([peak]),
        np.array([len(commands)]),
        np.array([fallbacks]),
        (path,),
    )
