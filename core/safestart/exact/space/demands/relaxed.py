"""NO_GO for the field of view: planes that hold its cone, in place of it.

The cone is convex, so every plane against which it lies on one side may be asked in its place: what no flight keeps
then, none keeps with the cone. Where the best flight of such a question leaves the cone, planes touch it next.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from safestart.exact.answer import Answer, Multiplier, Part, Verdict
from safestart.exact.space.demands.restricted_watch import RestrictedWatch, Wall
from safestart.exact.space.demands.rules import VIEW, FieldOfView
from safestart.exact.space.watch import SpaceWatch
from safestart.model.scenario import Floats

_AROUND, _ROUNDS, _MORE = 16, 3, 8
# Longer than the name of a face may be.
_PLANE = "a plane that holds the cone of the field of view, number "
# The vector of a multiplier is no longer than its value, whatever rounding does.
_SHORTER = 1.0 - 1e-15


def refuted(
    watch: SpaceWatch,
    view: FieldOfView,
    state: Floats,
    solve: Callable[[SpaceWatch], tuple[Answer, Floats | None]],
) -> tuple[Answer | None, int]:
    """The NO_GO of a start (6,) by planes that hold the cone, or None; and the rounds of ``solve``.

    ``watch`` is that of the question without demands.
    """
    steps, rounds, towards = watch.question.steps, 0, np.empty((0, 3))
    for _ in range(_ROUNDS):
        normals, offsets = view.tangents(_AROUND, towards)
        walls = tuple(
            Wall(f"{_PLANE}{k}", view.frame, np.tile(normal, (steps, 1)), np.full(steps, offsets[k]))
            for k, normal in enumerate(normals)
        )
        found, thrust = solve(RestrictedWatch(watch, walls))
        rounds += found.iterations
        if found.verdict is Verdict.NO_GO:
            return _named(found, normals), rounds
        if thrust is None:
            break
        part = watch.until(len(thrust))
        seen = part.flown(state, thrust)[:, :3]
        if view.frame == "body":
            turn = watch.question.attitude.rotation(part.sample_times)
            seen = (turn @ seen[:, :, None])[..., 0]
        room = np.array([view.room(point) for point in seen])
        # The worst of each stretch of the flight.
        worst = [int(k[np.argmin(room[k])]) for k in np.array_split(np.arange(len(seen)), _MORE) if len(k)]
        outside = [k for k in worst if room[k] < 0.0]
        if not outside:
            break
        towards = np.concatenate([towards, seen[outside]])
    return None, rounds


def _named(found: Answer, normals: Floats) -> Answer:
    """The answer's multipliers on planes as those of the field of view, with the planes' normals."""

    def named(rows: tuple[Multiplier, ...]) -> tuple[Multiplier, ...]:
        out = []
        for row in rows:
            if row.face.startswith(_PLANE):
                normal = normals[int(row.face.removeprefix(_PLANE))]
                pull = tuple((_SHORTER * row.value * normal).tolist())
                row = Multiplier(row.time, VIEW, row.value, pull)
            out.append(row)
        return tuple(out)

    parts = tuple(Part(part.first, part.last, named(part.multipliers)) for part in found.parts)
    return replace(found, multipliers=named(found.multipliers), parts=parts)
