"""Settings of an avoid tube, and its box of states."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from safestart.collision_avoidance.game import Game, Players
from safestart.errors import invalid
from safestart.levelset import Boundary, Lattice, Scheme
from safestart.model.scenario import number

SCHEMES = {
    "low": Scheme.FIRST,
    "medium": Scheme.ENO2,
    "high": Scheme.WENO3,
    "very_high": Scheme.WENO5,
}
MAX_BYTES = 2_000_000_000
MAX_KEPT, MAX_FUEL_PRICE = 61, 1e4


@dataclass(frozen=True, slots=True)
class TubeSettings:
    """Settings, checked; raises ``InvalidInput``.

    ``accuracy`` names the scheme as hj-reachability does. ``shape`` counts the nodes of positions and of velocities.
    ``half`` are explicit half widths (position m, velocity m/s), None to size the box by :func:`make_lattice`;
    ``speed_m_s`` is then the largest speed per axis (None: chosen). Values at ``kept`` times to go, 0 and the horizon
    among them, are kept. :meth:`~safestart.collision_avoidance.game.Game.motion` explains ``together`` and
    ``fuel_price``; ``join`` cuts the values off at the certified bounds (avoid game only; a fuel price
    leaves the upper one).
    """

    accuracy: str = "very_high"
    shape: tuple[int, int] = (41, 15)
    half: tuple[float, float] | None = None
    speed_m_s: float | None = None
    kept: int = 7
    players: Players = Players.AVOID
    fuel_price: float = 0.0
    together: bool = True
    join: bool = True
    precision: str = "float32"
    threads: int = 1
    boundary: str = Boundary.EDGE

    def __post_init__(self) -> None:
        if self.accuracy not in SCHEMES:
            raise invalid("accuracy", "one of " + ", ".join(SCHEMES), self.accuracy)
        object.__setattr__(self, "players", Players(self.players))
        if not 2 <= self.kept <= MAX_KEPT:
            raise invalid("kept", f"2 to {MAX_KEPT} times", self.kept)
        number("fuel_price", self.fuel_price, 0.0, MAX_FUEL_PRICE)
        if self.half is not None:
            for value in self.half:
                number("half", value, 0.0, 1e6, open_low=True)
        if self.speed_m_s is not None:
            number("speed_m_s", self.speed_m_s, 0.0, 1e4, open_low=True)


def make_lattice(game: Game, horizon: float, settings: TubeSettings) -> tuple[Lattice, list[str]]:
    """The lattice, axes as in the game's state, and warnings if it is too small or too coarse to be meaningful.

    Without explicit half widths it holds, per axis, every position from which the disk is reached within the horizon at
    the largest speed under both players' thrust. The default speed crosses the keep-out distance in the horizon, plus
    the effect of both thrusts.
    """
    m = game.channels
    thrust = game.control.radius + game.disturbance.radius
    speed = settings.speed_m_s or game.keep_out_m / horizon + thrust * horizon
    if settings.half is not None:
        speed = settings.half[1]
    # Coriolis and gravity: 2 w v and 3 w^2 p, over the horizon.
    bend = game.mean_motion * horizon
    need = game.keep_out_m + speed * horizon * (1.0 + bend) + 0.5 * thrust * horizon**2 * (1.0 + bend)
    half = settings.half or (need, speed)
    nodes = [settings.shape[0]] * m + [settings.shape[1]] * m
    if math.prod(nodes) * settings.kept * 8 > MAX_BYTES:
        raise invalid("shape", f"nodes times kept values within {MAX_BYTES:.0e} bytes", settings.shape)
    ends = np.array([half[0]] * m + [half[1]] * m)
    lattice = Lattice.of(-ends, ends, nodes, settings.boundary)
    warnings = []
    spacing = lattice.spacing
    if half[0] < 0.95 * need:
        warnings.append(
            f"the box cuts the motion off at {half[0]:.4g} m: the disk is reached from {need:.4g} m at {speed:.4g} m/s"
        )
    if game.keep_out_m < 3.0 * spacing[0]:
        warnings.append(
            f"position spacing {spacing[0]:.4g} m: the keep-out distance is {game.keep_out_m / spacing[0]:.2g} "
            "cells (want at least 3)"
        )
    authority = game.control.radius * horizon / spacing[m]
    if authority < 2.0:
        warnings.append(
            f"velocity spacing {spacing[m]:.4g} m/s: the chaser's thrust changes its speed by {authority:.2g} cells "
            "over the horizon (want at least 2)"
        )
    return lattice, warnings
