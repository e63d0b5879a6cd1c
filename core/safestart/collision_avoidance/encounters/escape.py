"""The four escape modes of paper 001, section III-C: burn along one axis, then drift."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from safestart.collision_avoidance.game import Game
from safestart.model.scenario import Floats
from safestart.simulation.record import Path

# Speeds (m/s) below this are rounding: a free motion without secular drift returns to its start.
_STILL = 1e-6


class Mode(NamedTuple):
    """An escape: its burn axis (tangential, radial) and the outcome that the paper states."""

    name: str
    title: str
    direction: tuple[float, float]
    claim: str


MODES = (
    Mode("mode1", "1: radial, up", (0.0, 1.0), "higher, drifts backward"),
    Mode("mode2", "2: radial, down", (0.0, -1.0), "lower, drifts forward"),
    Mode("mode3", "3: tangential, braking", (-1.0, 0.0), "falls behind at the same altitude"),
    Mode("mode4", "4: tangential, accelerating", (1.0, 0.0), "gets ahead at the same altitude"),
)


@dataclass(frozen=True, slots=True)
class Escape:
    """Flight of one mode, and its outcome.

    Over each step the path's thrust is the mean of the delivered thrust. ``drift_m_s`` is the mean tangential speed
    after the burn, 0 if the motion repeats with every orbit; ``altitude_m`` the mean radial position; ``overtakes_s``
    the time at which it passes its start again, tangentially (inf: never).
    """

    mode: Mode
    path: Path
    drift_m_s: float
    altitude_m: float
    overtakes_s: float


def fly(
    game: Game, mode: Mode, start: Floats, burn_s: float, duration_s: float, step_s: float = 10.0
) -> Escape:
    """Burn at full thrust for ``burn_s`` seconds from ``start`` (6,), LVLH, then drift; Player 2 does nothing.

    In closed form: every state comes directly from the start, for a burn of any length. The mean drift and altitude
    follow from the state at the end of the burn: of a free motion the radial position swings about 4 y + 2 vx / w,
    and the mean tangential speed is -1.5 w times that.
    """
    begin = game.from_lvlh(start)
    push = game.control.extreme(np.array(mode.direction))
    count = max(2, round(duration_s / step_s))
    step = duration_s / count
    times: Floats = step * np.arange(count + 1, dtype=np.float64)
    states = np.empty((count + 1, 4))
    burnt = min(burn_s, duration_s)
    for k, time in enumerate(times):
        thrust, coast = min(time, burnt), max(time - burnt, 0.0)
        ended = game.transition(thrust) @ begin + game.held_input(thrust) @ push
        states[k] = game.transition(coast) @ ended
    ended = game.transition(burnt) @ begin + game.held_input(burnt) @ push
    w = game.mean_motion
    # 4 y + 2 vx / w is the guiding centre's altitude; without rotation the drift equals the speed.
    altitude = 4.0 * ended[1] + 2.0 * ended[2] / w if w > 0.0 else ended[1]
    drift = -1.5 * w * altitude if w > 0.0 else ended[2]
    drift = drift if abs(drift) > _STILL else 0.0
    share = np.clip((burnt - times[:-1]) / step, 0.0, 1.0)
    path = Path(times, game.to_lvlh(states), game.thrust_to_lvlh(share[:, None] * push))
    overtakes = _overtakes(times, states[:, 0] - begin[0])
    return Escape(mode, path, float(drift), float(altitude), overtakes)


def _overtakes(times: Floats, moved: Floats) -> float:
    """When ``moved`` (K,) comes back through zero after having left it."""
    signs = np.sign(np.where(np.abs(moved) > 1e-9, moved, 0.0))
    away = np.flatnonzero(signs)
    if len(away) == 0:
        return np.inf
    back = np.flatnonzero(signs == -signs[away[0]])
    return float(times[back[0]]) if len(back) else np.inf
