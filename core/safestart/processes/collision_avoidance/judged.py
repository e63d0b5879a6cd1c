"""Verdicts on the requested states: first the bounds, in the plane or in space, then the grid inside its box."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from safestart.collision_avoidance.bounds.certified import lower, upper
from safestart.collision_avoidance.game import Game, Players
from safestart.collision_avoidance.space import SpaceTube
from safestart.collision_avoidance.tube import Answer, Tube, solve_tube
from safestart.model.scenario import Floats
from safestart.processes.collision_avoidance.spec import CollisionAvoidanceInputs
from safestart.processes.wire import finite
from safestart.runtime.progress import Context

_FINER = 4
"""Nodes per axis of the normal motion's grid (two axes) for each node per axis of the plane's (four axes)."""


def judge(
    inputs: CollisionAvoidanceInputs, tube: Tube, in_space: Game, context: Context
) -> list[dict[str, Any]]:
    """One row per state, in their order. The bounds are those of the avoid game, whatever the players."""
    rows: list[dict[str, Any]] = [{}] * len(inputs.states)
    for length, game in ((4, tube.game), (6, in_space)):
        chosen = [k for k, state in enumerate(inputs.states) if len(state) == length]
        if not chosen:
            continue
        states = np.array([inputs.states[k] for k in chosen])
        reader = tube if length == 4 else _space(tube, in_space, context)
        least = lower(game, states, inputs.horizon_s)
        most = upper(game, states, inputs.horizon_s)
        for k, answer, low, high in zip(
            chosen, _answers(reader, states, least, most), least, most, strict=True
        ):
            rows[k] = {
                "state": inputs.states[k],
                "answer": Answer(int(answer)).name,
                "least_m": finite(low),
                "most_m": float(high),
            }
    return rows


def _space(tube: Tube, game: Game, context: Context) -> SpaceTube:
    """Needs the plane's tube; solves the small one of the normal motion."""
    nodes = (_FINER * tube.settings.shape[0], _FINER * tube.settings.shape[1])
    settings = replace(tube.settings, shape=nodes)
    return SpaceTube(game, tube, solve_tube(game.restricted(2, 3), tube.horizon_s, settings, context))


def _answers(reader: Tube | SpaceTube, states: Floats, least: Floats, most: Floats) -> Floats:
    """:class:`Answer` by the bounds, or by the grid for undecided states inside its box."""
    found = np.where(
        most <= 0.0, Answer.PROVED_UNSAFE, np.where(least > 0.0, Answer.PROVED_SAFE, Answer.UNDECIDED)
    )
    parts = (reader,) if isinstance(reader, Tube) else (reader.plane, reader.normal)
    # A failed grid, or one of other players, has no answer.
    if any(part.failure or part.settings.players is not Players.AVOID for part in parts):
        return np.asarray(found, dtype=np.int8)
    open_ = (found == Answer.UNDECIDED) & reader.covers(states)
    if open_.any():
        found[open_] = reader.answer(states[open_])
    return np.asarray(found, dtype=np.int8)
