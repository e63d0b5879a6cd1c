"""Step a value function backwards in time: strong-stability-preserving Runge-Kutta over the compiled stages."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from safestart.errors import invalid
from safestart.levelset.dynamics import Motion
from safestart.levelset.lattice import Boundary, Lattice
from safestart.levelset.layout import Array
from safestart.levelset.levels import Level, Levels
from safestart.levelset.numbers import SLACK
from safestart.levelset.scheme import FACTS, Flux, Kind, Scheme
from safestart.levelset.stage import Stage
from safestart.model.scenario import Floats

COURANT = 0.75
_HALVINGS = 60


@dataclass(frozen=True, slots=True)
class Options:
    """Numerical options: ``stages`` 1 to 3 (None: the scheme's own), ``precision`` float32 or float64, ``threads``."""

    scheme: Scheme = Scheme.WENO5
    stages: int | None = None
    flux: Flux = Flux.LAX_FRIEDRICHS
    precision: str = "float64"
    threads: int = 1
    courant: float = COURANT

    def __post_init__(self) -> None:
        if self.stages not in (None, 1, 2, 3):
            raise invalid("stages", "1, 2 or 3", self.stages)
        if self.precision not in ("float32", "float64"):
            raise invalid("precision", "float32 or float64", self.precision)
        if not 1 <= self.threads <= 256:
            raise invalid("threads", "1 to 256", self.threads)
        if not 0.0 < self.courant <= 1.0:
            raise invalid("courant", "a number in (0, 1]", self.courant)


class March:
    """Value function on a lattice, stepped backwards from ``time`` (s).

    ``values`` (shape of the lattice) is the value at ``time``. ``cap`` keeps V <= cap (a moving target: tube towards
    it), ``floor`` V >= floor (an obstacle, or a state constraint: positive where the state is forbidden); both apply
    after every step. ``resolution`` (s) is the longest time between samples of moving levels within a step, and the
    longest step of a time-varying motion; None: levels only at the end of a step, steps as long as is stable.
    """

    def __init__(
        self,
        lattice: Lattice,
        motion: Motion,
        values: Floats,
        time: float,
        kind: Kind = Kind.TUBE,
        options: Options | None = None,
        cap: Level | None = None,
        floor: Level | None = None,
        resolution: float | None = None,
    ) -> None:
        options = options or Options()
        if np.shape(values) != lattice.shape:
            raise invalid("values", f"shape {lattice.shape}, the lattice's", np.shape(values))
        self.time, self.steps = time, 0
        self._options, self._levels, self._resolution = options, Levels(cap, floor, resolution), resolution
        dtype: Any = np.float32 if options.precision == "float32" else np.float64
        self._stage = Stage(lattice, motion, options.scheme, options.flux, kind, dtype, options.threads)
        self._stages = options.stages or FACTS[options.scheme].stages
        layout = self._stage.layout
        self._v = layout.pack(np.asarray(values), dtype)
        self._low, self._high = float(np.min(values)), float(np.max(values))
        self._spare = [layout.empty(dtype) for _ in range(1 if self._stages < 3 else 2)]
        self._stage.at(time)
        self._clamp(*self._levels.at(time))
        self._rate = self._stage.fastest()
        self._varies = motion.varies

    def _clamp(self, cap: Floats | None, floor: Floats | None) -> None:
        if cap is not None:
            self._low = min(self._low, float(np.min(cap)))
        if floor is not None:
            self._high = max(self._high, float(np.max(floor)))
        self._stage.clamp(cap, floor)

    @property
    def allowed(self) -> tuple[float, float]:
        """Range of the initial values and of the levels met: a value without running cost cannot leave it."""
        return self._low, self._high

    @property
    def rate(self) -> float:
        """Largest sum of speed / spacing on the nodes at the current time, 1/s; a step is ``courant`` / rate."""
        return self._rate

    def step(self, most: float) -> float:
        """One step back, of at most ``most`` seconds; returns its length."""
        time, stage = self.time, self._stage
        stage.at(time)
        if self._varies:
            self._rate = stage.fastest()
        dt = min(self._options.courant / self._rate, most) if self._rate > 0.0 else most
        if self._varies:
            dt = self._stable(dt)
            stage.at(time)
        v, a = self._v, self._spare[0]
        if self._levels.moving:
            self._clamp(*self._levels.over(time, time - dt))
        if self._stages == 1:
            stage.run(v, v, a, 0.0, 1.0, dt, clamp=True)
            self._v, self._spare[0] = a, v
        elif self._stages == 2:
            stage.run(v, v, a, 0.0, 1.0, dt, clamp=False)
            stage.at(time - dt)
            stage.run(a, v, v, 0.5, 0.5, dt, clamp=True)
        else:
            b = self._spare[1]
            stage.run(v, v, a, 0.0, 1.0, dt, clamp=False)
            stage.at(time - dt)
            stage.run(a, v, b, 0.75, 0.25, dt, clamp=False)
            stage.at(time - 0.5 * dt)
            stage.run(b, v, v, 1.0 / 3.0, 2.0 / 3.0, dt, clamp=True)
        self.time = time - dt
        self.steps += 1
        return dt

    def _stable(self, dt: float) -> float:
        """A step of at most ``dt`` that is stable at its beginning, middle and end, as the motion's speed may vary."""
        dt = dt if self._resolution is None else min(dt, self._resolution)
        for _ in range(_HALVINGS):
            rate = self._rate
            for share in (0.5, 1.0):
                self._stage.at(self.time - share * dt)
                rate = max(rate, self._stage.fastest())
            if rate * dt <= self._options.courant * (1.0 + 1e-12):
                break
            dt = max(self._options.courant / rate, 0.5 * dt)
        return dt

    def advance(self, span: float) -> None:
        """Step ``span`` seconds back, in steps of courant / rate and a shorter last one."""
        end, left = self.time - span, span
        while left > 0.0:
            taken = self.step(left)
            left = 0.0 if taken >= left else left - taken
        self.time = end

    def range(self) -> tuple[float, float]:
        """Least and largest value on the nodes; NaN when one is not finite."""
        # Ghosts that repeat a node do not widen the range, and reading flat memory is much faster.
        copies = self._stage.layout.boundary[-1] in (Boundary.EDGE, Boundary.PERIODIC)
        nodes = self._v[SLACK:-SLACK] if copies else self.nodes()
        low, high = float(nodes.min()), float(nodes.max())
        return (low, high) if np.isfinite(low) and np.isfinite(high) else (np.nan, np.nan)

    def nodes(self) -> Array:
        """View of the value on the nodes, shape of the lattice; the next step overwrites it."""
        return self._stage.layout.nodes(self._v)

    def result(self) -> Floats:
        """The value on the nodes as an array of its own, float64. No step follows: it frees the stages."""
        self._spare.clear()
        return np.array(self.nodes(), dtype=np.float64)

    def close(self) -> None:
        """End the threads."""
        self._stage.close()
