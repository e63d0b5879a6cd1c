"""Norm limits as rows over start and thrust, the blocks of :mod:`safestart.optim.largest_margin`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from safestart.exact.limits import AT_END, Limit, limit_at
from safestart.exact.question import Question
from safestart.model.scenario import Floats
from safestart.optim.prediction import Prediction

if TYPE_CHECKING:
    from safestart.exact.cut_source import Watched


@dataclass(frozen=True, slots=True)
class Blocks:
    """Rows (limit, M x(t) - centre) of B limits at times (B,): offset + start . x0 + thrust . u, in metres.

    ``offset`` (B, d + 1), ``start`` (B, d + 1, 2 d), ``thrust`` (B, d + 1, N d).
    """

    times: Floats
    names: tuple[str, ...]
    offset: Floats
    start: Floats
    thrust: Floats

    def and_more(self, other: Blocks) -> Blocks:
        """Append the rows of ``other``, which are of the same question."""
        return Blocks(
            np.concatenate([self.times, other.times]),
            self.names + other.names,
            np.concatenate([self.offset, other.offset]),
            np.concatenate([self.start, other.start]),
            np.concatenate([self.thrust, other.thrust]),
        )


def blocks(question: Question, prediction: Prediction, names: Sequence[str], times: Floats) -> Blocks:
    """The limits ``names`` (B) at ``times`` (B,) in [0, T] seconds; ``prediction`` is the question's."""
    limits = [limit_at(question, name, time) for name, time in zip(names, times.tolist(), strict=True)]
    return stacked(limits, prediction, names, times)


def stacked(limits: Sequence[Limit], prediction: Prediction, names: Sequence[str], times: Floats) -> Blocks:
    """The rows of ``limits`` (B), called ``names``, at ``times`` (B,) in seconds."""
    d, count = prediction.dimensions, prediction.steps
    offset = np.zeros((len(times), d + 1))
    start, thrust = np.zeros((len(times), d + 1, 2 * d)), np.zeros((len(times), d + 1, count * d))
    for b, (limit, time) in enumerate(zip(limits, times.tolist(), strict=True)):
        offset[b] = limit.limit, *-limit.centre
        start[b, 1:], thrust[b, 1:] = prediction.state_rows(time, limit.matrix)
    return Blocks(times, tuple(names), offset, start, thrust)


def end_blocks(watch: Watched) -> tuple[Floats, Floats, Floats]:
    """The limits at the end for every T = k dt, k = 0 .. N, stacked: offset (N+1, 2 d+2), and so start and thrust."""
    count = watch.question.steps + 1
    made = watch.blocks(AT_END * count, np.repeat(watch.question.dt * np.arange(count), len(AT_END)))
    return (
        made.offset.reshape(count, -1),
        made.start.reshape(count, -1, made.start.shape[-1]),
        made.thrust.reshape(count, -1, made.thrust.shape[-1]),
    )
