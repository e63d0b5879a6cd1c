"""Cut a grid's value off at the certified bounds, and measure its error against them."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from safestart.collision_avoidance.bounds.certified import lower, upper
from safestart.collision_avoidance.game import Game
from safestart.levelset import Lattice
from safestart.model.scenario import Floats
from safestart.runtime.progress import Context

BAND = 0.2
"""Share of the keep-out distance; closer to the boundary than this the lower bound is computed in full."""
PROVED_M = 1e-6


@dataclass(slots=True)
class Check:
    """Numbers of proved nodes, and how many of them the grid alone, or after joining, judges differently.

    ``too_high_m`` and ``too_low_m`` are the largest distances of the grid's own values above the upper and below the
    lower bound, among nodes near the boundary (``BAND``) and those on its wrong side; ``read_high_m`` and
    ``read_low_m`` are the same for the joined values at the middles of cells, farthest from any node.
    """

    nodes: int = 0
    proved_unsafe: int = 0
    proved_safe: int = 0
    undecided: int = 0
    unsafe_called_safe: int = 0
    safe_called_unsafe: int = 0
    unsafe_called_safe_joined: int = 0
    safe_called_unsafe_joined: int = 0
    too_high_m: float = 0.0
    too_low_m: float = 0.0
    read_high_m: float = 0.0
    read_low_m: float = 0.0

    def document(self) -> dict[str, Any]:
        """JSON-able."""
        return asdict(self)


def join(
    game: Game, lattice: Lattice, values: Floats, times: Floats, context: Context, *, only_upper: bool = False
) -> tuple[Floats, Check]:
    """Compare ``values`` (kept, nodes...) at ``times`` to go with the bounds on every node, and cut them off there.

    Returns the new values and the check. ``only_upper`` skips the lower cut, for values that are below V on purpose (a
    price of fuel).
    """
    horizon, band = float(times[-1]), BAND * game.keep_out_m
    check, joined = Check(), np.array(values)
    axes = lattice.axes
    for row, first in enumerate(axes[0]):
        context.step(row, len(axes[0]), "certified bounds")
        mesh = np.meshgrid([first], *axes[1:], indexing="ij")
        states = np.stack(mesh, axis=-1)[0]
        above = upper(game, states, times)
        found = values[-1, row]
        # First the signs, by constant inputs; the search only for undecided nodes.
        below = lower(game, states, horizon, goal_m=PROVED_M, effort=0)
        safe, unsafe = below > 0.0, above[-1] <= 0.0
        near = np.minimum(np.abs(found), np.abs(above[-1])) < band
        wrong = (safe & (found <= 0.0)) | (unsafe & (found > 0.0))
        open_ = ~safe & ~unsafe
        for where, effort in ((near | wrong, 0), (open_, 40)):
            if where.any():
                below[where] = np.maximum(below[where], lower(game, states[where], horizon, effort=effort))
        safe = below > 0.0
        looked = near | wrong
        if looked.any():
            check.too_high_m = max(check.too_high_m, float((found - above[-1])[looked].max()))
            check.too_low_m = max(check.too_low_m, float((below - found)[looked].max()))
        new = np.minimum(values[:, row], above)
        if not only_upper:
            # A longer horizon never raises the value, so its lower bound holds for all shorter ones.
            new = np.maximum(new, below)
        joined[:, row] = new
        check.nodes += found.size
        check.proved_unsafe += int(unsafe.sum())
        check.proved_safe += int(safe.sum())
        check.undecided += int((~safe & ~unsafe).sum())
        check.unsafe_called_safe += int((unsafe & (found > 0.0)).sum())
        check.safe_called_unsafe += int((safe & (found <= 0.0)).sum())
        check.unsafe_called_safe_joined += int((unsafe & (new[-1] > 0.0)).sum())
        check.safe_called_unsafe_joined += int((safe & (new[-1] <= 0.0)).sum())
    return joined, check


def reading_errors(
    game: Game, lattice: Lattice, values: Floats, horizon: float, context: Context
) -> tuple[float, float]:
    """How far ``values`` (nodes...) read at the middles of cells lie above the upper and below the lower bound (m).

    Checks cells with a value near the boundary (``BAND``) or a refuted sign.
    """
    middles = values
    for axis in range(lattice.ndim):
        middles = 0.5 * (
            middles.take(range(1, middles.shape[axis]), axis)
            + middles.take(range(middles.shape[axis] - 1), axis)
        )
    axes = [0.5 * (axis[1:] + axis[:-1]) for axis in lattice.axes]
    too_high = too_low = 0.0
    for row, first in enumerate(axes[0]):
        context.step(row, len(axes[0]), "between nodes")
        states = np.stack(np.meshgrid([first], *axes[1:], indexing="ij"), axis=-1)[0]
        found = middles[row]
        above = upper(game, states, horizon)
        looked = (np.minimum(np.abs(found), np.abs(above)) < BAND * game.keep_out_m) | (
            (found > 0.0) & (above <= 0.0)
        )
        if looked.any():
            below = lower(game, states[looked], horizon, effort=0)
            too_high = max(too_high, float((found - above)[looked].max()))
            too_low = max(too_low, float((below - found[looked]).max()))
    return too_high, too_low
