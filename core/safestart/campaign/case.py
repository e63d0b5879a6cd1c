"""One case of a campaign, and random numbers per case or block of cases, never per worker."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from safestart.model.scenario import Floats


@dataclass(frozen=True, slots=True)
class Case:
    """Case ``index`` of a campaign (0 for the first), with its parameters from the design."""

    index: int
    seed: int = 0
    parameters: Mapping[str, float] = field(default_factory=dict)

    def generator(self, stream: int = 0) -> np.random.Generator:
        """Random numbers of this case alone; each ``stream`` gives independent numbers.

        Philox is counter-based: key ``seed``, counter (0, 0, index, 1 + stream). Counters that end with 0 belong to
        the noise of the flights of :mod:`safestart.simulation`: a study may use both with one seed.
        """
        return np.random.Generator(np.random.Philox(key=self.seed, counter=[0, 0, self.index, 1 + stream]))


def generator(seed: int, *key: int) -> np.random.Generator:
    """Random numbers of the block of cases that ``key`` names."""
    return np.random.default_rng([seed, *key])


def uniform_run(seed: int, key: tuple[int, ...], first: int, count: int, block: int) -> Floats:
    """Numbers in [-1, 1) of ``count`` cases from ``first`` on, (count,): each block of cases is drawn whole.

    The number of a case depends only on seed, key and the case, not on the run of cases asked for.
    """
    begin = first // block
    blocks = range(begin, -(-(first + count) // block))
    drawn = [generator(seed, *key, number).uniform(-1.0, 1.0, block) for number in blocks]
    return np.concatenate(drawn)[first - begin * block :][:count] if drawn else np.empty(0)
