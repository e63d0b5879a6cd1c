"""The cases of a campaign and the parameters of each: every combination, drawn, or the same question repeated."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from safestart.campaign.case import generator

Parameters = dict[str, float]


class Design(Protocol):
    """Numbered cases."""

    def __len__(self) -> int:
        """How many."""
        ...

    def parameters(self, first: int, count: int) -> list[Parameters]:
        """Parameters of ``count`` cases from ``first`` on; those of a case do not depend on the run asked for."""
        ...


@dataclass(frozen=True, slots=True)
class Repeated:
    """``count`` cases that differ only in what they draw themselves."""

    count: int

    def __len__(self) -> int:
        """How many."""
        return self.count

    def parameters(self, first: int, count: int) -> list[Parameters]:
        """None."""
        return [{} for _ in range(first, first + count)]


@dataclass(frozen=True, slots=True)
class Factorial:
    """Every combination of the values of ``axes``; the first axis varies slowest."""

    axes: Mapping[str, Sequence[float]]

    def __len__(self) -> int:
        """Product of the lengths."""
        return math.prod(len(values) for values in self.axes.values())

    def at(self, number: int) -> Parameters:
        """The combination of case ``number``."""
        found = {}
        for name, values in reversed(list(self.axes.items())):
            number, place = divmod(number, len(values))
            found[name] = values[place]
        return {name: found[name] for name in self.axes}

    def parameters(self, first: int, count: int) -> list[Parameters]:
        """In order."""
        return [self.at(number) for number in range(first, first + count)]


@dataclass(frozen=True, slots=True)
class Drawn:
    """``count`` cases drawn evenly from ``ranges`` (least and greatest), in blocks of ``block`` cases.

    A ``stratified`` block is a Latin hypercube of its own (McKay, Beckman and Conover 1979).
    """

    ranges: Mapping[str, tuple[float, float]]
    count: int
    seed: int
    stratified: bool = False
    block: int = 100

    def __len__(self) -> int:
        """How many."""
        return self.count

    def parameters(self, first: int, count: int) -> list[Parameters]:
        """Blocks are drawn whole."""
        begin = first // self.block
        rows = [
            row for number in range(begin, -(-(first + count) // self.block)) for row in self._block(number)
        ]
        start = first - begin * self.block
        return [dict(zip(self.ranges, row, strict=True)) for row in rows[start : start + count]]

    def _block(self, number: int) -> list[list[float]]:
        first = number * self.block
        size = (min(self.block, self.count - first), len(self.ranges))
        rng = generator(self.seed, number, first)
        if self.stratified:
            from scipy.stats.qmc import LatinHypercube

            unit: Any = LatinHypercube(size[1], rng=rng).random(size[0])
        else:
            unit = rng.uniform(size=size)
        low, high = np.array(list(self.ranges.values()), dtype=np.float64).T
        values: list[list[float]] = (low + (high - low) * unit).tolist()
        return values
