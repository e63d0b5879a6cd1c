"""Counter-examples: the closest drift that a seeded search finds, and the extremes of simulated powered flights.

The search flies the linear motion and proves nothing; a counter-example counts only after
:func:`safestart.passive_safety.flights.independent_flight.replay`.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from safestart.model.scenario import Floats
from safestart.passive_safety.flights.simulate import active, crossing_times, drifted
from safestart.passive_safety.model import Mode, System, gain
from safestart.passive_safety.question import Question

_SAMPLES, _ZOOMS, _SHRINK, _BEST = 150, 6, 0.4, 3
_AFTER_STEP = 1.0
_TURNS = 3


@dataclass(frozen=True, slots=True)
class Drifting:
    """A start (x, y, vx, vy), its abort time, the time of closest approach (min since start) and distances (m)."""

    start: tuple[float, ...]
    abort: float
    time: float
    max_norm: float
    euclidean: float


def approaches(
    system: System, starts: Floats, aborts: Floats, horizon: float, crossings: Floats
) -> tuple[Floats, Floats]:
    """Least max-norm distance (N,) of each drift from the target, m, and the time after the abort (N,), min."""
    passive = active(system, starts, crossings, aborts)
    left = horizon - aborts
    grid = np.arange(0.0, float(left.max()) + _AFTER_STEP, _AFTER_STEP)
    after = np.minimum(grid, left[:, None])
    width = _AFTER_STEP
    for turn in range(_TURNS + 1):
        distance = np.abs(drifted(system.dynamics, passive[:, None, :], after)).max(axis=-1)
        best = distance.argmin(axis=1)[:, None]
        at = np.take_along_axis(after, best, axis=1)
        if turn < _TURNS:
            after = np.clip(at + width * np.linspace(-1.0, 1.0, 17), 0.0, left[:, None])
            width /= 8.0
    return np.take_along_axis(distance, best, axis=1)[:, 0], at[:, 0]


def closest(
    question: Question,
    window: tuple[float, float],
    seed: int = 0,
    bracket: tuple[float, float] | None = None,
    enough: float = 0.0,
) -> Drifting:
    """Closest drift found over the initial set and the abort ``window`` (min); tries all corners.

    ``bracket``: see :func:`crossing_times`. The search ends early below ``enough`` metres.
    """
    centre, gens = question.set()
    system = question.system
    random = np.random.default_rng(seed)
    free = len(gens) + 1
    low_time, high_time = window

    def record(points: Floats) -> list[tuple[float, Floats, Drifting]]:
        starts = centre + points[:, :-1] @ gens
        aborts = low_time + 0.5 * (points[:, -1] + 1.0) * (high_time - low_time)
        crossings = crossing_times(system, starts, float(aborts.max()) + 1.0, bracket)
        distance, after = approaches(system, starts, aborts, question.horizon, crossings)
        euclidean = np.hypot(*drifted(system.dynamics, active(system, starts, crossings, aborts), after).T)
        out = []
        for k in np.argsort(distance)[:_BEST]:
            flown = Drifting(
                tuple(float(v) for v in starts[k]),
                float(aborts[k]),
                float(aborts[k] + after[k]),
                float(distance[k]),
                float(euclidean[k]),
            )
            out.append((float(distance[k]), points[k], flown))
        return out

    corners = np.stack(np.meshgrid(*[[-1.0, 1.0]] * free, indexing="ij"), axis=-1).reshape(-1, free)
    found = record(np.concatenate([corners, random.uniform(-1.0, 1.0, (_SAMPLES * 2, free))]))
    size = 1.0
    for _ in range(_ZOOMS):
        if found[0][0] < enough:
            break
        size *= _SHRINK
        share = _SAMPLES // len(found)
        around = [point + size * random.uniform(-1.0, 1.0, (share, free)) for _, point, _ in found]
        found = sorted(found + record(np.clip(np.concatenate(around), -1.0, 1.0)), key=lambda f: f[0])[:_BEST]
    return found[0][2]


@dataclass(frozen=True, slots=True)
class Powered:
    """Extremes of the simulated powered flights: value, start and time per requirement."""

    value: float
    start: tuple[float, ...]
    time: float


def powered_extremes(
    question: Question, bracket: tuple[float, float] | None = None, side: int = 3, step: float = 0.5
) -> dict[str, Powered]:
    """Simulated maxima over a grid of starts: ``thrust``, ``speed`` (disc), ``speed_octagon``, ``los`` (excess, m).

    ``side`` starts per free component; times every ``step`` minutes and 60 in the first minute of mode 2.
    """
    centre, gens = question.set()
    end = question.horizon if question.window is None else question.window[1]
    axes = [np.linspace(-1.0, 1.0, side)] * len(gens)
    points = np.array(list(product(*axes))).reshape(side ** len(gens), len(gens))
    starts = centre + points @ gens
    system = question.system
    crossings = crossing_times(system, starts, end, bracket)
    finite = np.where(np.isfinite(crossings), crossings, end)
    steady = np.broadcast_to(
        np.arange(0.0, end + step, step), (len(starts), int(np.ceil((end + step) / step)))
    )
    times = np.minimum(np.concatenate([steady, finite[:, None] + np.linspace(1e-9, 1.0, 60)], axis=1), end)
    states = active(system, starts[:, None, :], crossings[:, None], times)
    near = times > crossings[:, None]
    force = np.where(
        near, *(np.abs(states @ gain(system.motion(m)).T).max(axis=-1) for m in (Mode.NEAR, Mode.FAR))
    )
    vx, vy = states[..., 2], states[..., 3]
    octagon = np.maximum(np.maximum(abs(vx), abs(vy)), np.maximum(abs(vx + vy), abs(vx - vy)) / np.sqrt(2.0))
    sight = np.maximum(np.abs(states[..., 1]) + np.tan(np.pi / 6.0) * states[..., 0], -100.0 - states[..., 0])
    values = {
        "thrust": force,
        "speed": np.where(near, np.hypot(vx, vy), 0.0),
        "speed_octagon": np.where(near, octagon, 0.0),
        "los": np.where(near, sight, -np.inf),
    }
    out = {}
    for name, value in values.items():
        i, k = np.unravel_index(int(value.argmax()), value.shape)
        out[name] = Powered(float(value[i, k]), tuple(float(v) for v in starts[i]), float(times[i, k]))
    return out
