"""The kernel's arguments for one lattice and motion, and one stage of a step on one or several threads."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from numpy.typing import NDArray

from safestart.errors import invalid
from safestart.levelset import numbers
from safestart.levelset.dynamics import Ball, Box, Motion, Rates
from safestart.levelset.kernels.rate import fastest
from safestart.levelset.kernels.sweep import sweep
from safestart.levelset.lattice import Boundary, Lattice
from safestart.levelset.layout import Array, Layout
from safestart.levelset.scheme import FACTS, FLUX_NUMBER, KIND_NUMBER, Flux, Kind, Scheme
from safestart.levelset.tables import Tables
from safestart.model.scenario import Floats

_BOUNDARY_NUMBER = {
    Boundary.EDGE: numbers.EDGE,
    Boundary.PERIODIC: numbers.PERIODIC,
    Boundary.EXTRAPOLATE: numbers.EXTRAPOLATE,
    Boundary.AWAY_FROM_ZERO: numbers.AWAY,
}


class Stage:
    """One stage, out <- a first + b (v + dt H(v)), in the memory of :class:`~safestart.levelset.layout.Layout`."""

    def __init__(
        self,
        lattice: Lattice,
        motion: Motion,
        scheme: Scheme,
        flux: Flux,
        kind: Kind,
        dtype: Any,
        threads: int,
    ) -> None:
        facts = FACTS[scheme]
        self.layout = layout = Layout.of(lattice, facts.width)
        self._motion, self._dtype, self._flux = motion, dtype, flux
        self._lattice, self._time = lattice, np.nan
        self._pool = ThreadPoolExecutor(threads) if threads > 1 else None
        self._ranges = np.linspace(0, layout.blocks, threads + 1).astype(int)
        numbers = [layout.outer, layout.block, layout.pitch, layout.width, facts.number]
        self._plan = np.array([*numbers, FLUX_NUMBER[flux], KIND_NUMBER[kind], 0], dtype=np.int64)
        self._shape = np.array(layout.shape, dtype=np.int64)
        self._strides = layout.strides
        self._boundary = np.array([_BOUNDARY_NUMBER[b] for b in layout.boundary], dtype=np.int64)
        self._scale = (1.0 / lattice.spacing)[list(layout.order)].astype(dtype)
        self._clamps = Tables.of(layout, [[], []], dtype)
        self._tables: Tables
        self._groups: NDArray[np.int64]

    def at(self, time: float) -> None:
        """Evaluate the motion's rates at a time (s)."""
        if not np.isnan(self._time) and not self._motion.varies:
            return
        self._time = time
        self._load(self._motion.rates(self._lattice, time))

    def _load(self, rates: Rates) -> None:
        """Tables of drift, spread and kink by axis, then of the gains, and the owners of the gains.

        ``spread`` is the inputs' part of the largest |dH/dp_i|, ``kink`` their factor of |p_i| in H.
        """
        n, order = self._lattice.ndim, self.layout.order
        drift = [list(terms) for terms in rates.drift]
        spread: list[list[Floats]] = [[] for _ in range(n)]
        kink: list[list[Floats]] = [[] for _ in range(n)]
        groups: list[list[int]] = []
        channels: list[tuple[int, int, float]] = []
        entries: list[int] = []
        gains: list[list[Floats]] = []
        reach: list[list[float]] = []
        for (bound, aim, price), columns in zip(self._motion.bounds, rates.gains, strict=True):
            ball, sign, first = isinstance(bound, Ball), (1 if aim == "max" else -1), len(channels)
            sizes = bound.half if isinstance(bound, Box) else np.full(len(columns), bound.radius)
            shares: list[list[Floats]] = [[] for _ in range(n)]
            for column, size, middle in zip(columns, sizes, bound.middle, strict=True):
                start = len(entries)
                for i, gain in enumerate(column):
                    if gain is None:
                        continue
                    entries.append(order.index(i))
                    gains.append([gain])
                    shares[i].append(np.abs(gain) * size)
                    if middle != 0.0:
                        drift[i].append(gain * middle)
                if len(entries) > start:
                    channels.append((start, len(entries), float(size)))
            if len(channels) == first:
                continue
            groups.append([int(ball), sign, first, len(channels)])
            reach.append([bound.radius if isinstance(bound, Ball) else 0.0, price])
            if self._flux is Flux.GODUNOV:
                _check_separable(channels[first:], ball, price)
            for i, terms in enumerate(shares):
                if terms:
                    total = np.sqrt(sum(np.square(t) for t in terms)) if ball else sum(terms[1:], terms[0])
                    spread[i].append(total)
                    kink[i].append(sign * total)
        rows = [*(drift[i] for i in order), *(spread[i] for i in order), *(kink[i] for i in order), *gains]
        tables = Tables.of(self.layout, rows, self._dtype)
        # The channels' half widths follow the tables, one each.
        halves = np.array([half for _, _, half in channels], dtype=self._dtype)
        behind = len(tables.data)
        self._tables = Tables(tables.where, np.concatenate([tables.data, halves]))
        self._groups = np.array(groups, dtype=np.int64).reshape(-1, 4)
        rows_of = [[begin, end, behind + c] for c, (begin, end, _) in enumerate(channels)]
        self._channels = np.array(rows_of, dtype=np.int64).reshape(-1, 3)
        self._entries = np.array(entries, dtype=np.int64)
        self._reach = np.array(reach, dtype=self._dtype).reshape(-1, 2)

    def clamp(self, cap: Floats | None, floor: Floats | None) -> None:
        """Cut values off at ``cap`` above and ``floor`` below (arrays that broadcast against the lattice)."""
        self._plan[7] = (cap is not None) + 2 * (floor is not None)
        rows = [[] if cap is None else [cap], [] if floor is None else [floor]]
        self._clamps = Tables.of(self.layout, rows, self._dtype)

    def fastest(self) -> float:
        """Largest sum of |dH/dp_i| / spacing over the nodes, 1/s."""
        tables = self._tables
        return float(fastest(self._shape, self._plan, self._scale, tables.where, tables.data))

    def run(self, v: Array, first: Array, out: Array, a: float, b: float, dt: float, *, clamp: bool) -> None:
        """One stage; ``out`` may be ``first`` but not ``v``."""
        tables, clamps = self._tables, self._clamps
        plan = self._plan.copy()
        plan[7] *= clamp
        weights = np.array([a, b, dt], dtype=self._dtype)

        def part(begin: int, end: int) -> None:
            sweep(
                v, first, out, weights, self._shape, self._strides, plan, self._boundary, self._scale,
                tables.where, tables.data, self._groups, self._channels, self._entries, self._reach,
                clamps.where, clamps.data, begin, end,
            )  # fmt: skip

        if self._pool is None:
            part(0, self.layout.blocks)
        else:
            list(self._pool.map(part, self._ranges[:-1], self._ranges[1:]))

    def close(self) -> None:
        """End the threads."""
        if self._pool is not None:
            self._pool.shutdown()


def _check_separable(channels: list[tuple[int, int, float]], ball: bool, price: float) -> None:
    if price > 0.0 or (ball and len(channels) > 1) or any(end - begin > 1 for begin, end, _ in channels):
        raise invalid(
            "flux",
            "lax_friedrichs, or inputs of which every channel moves one axis, in a box, without a price",
            Flux.GODUNOV.value,
        )
