"""The interface that a search uses to watch flights, for one question (``watch.py``) or a family of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol, Self

from safestart.exact.norm_rows import Blocks
from safestart.exact.watch import Cuts, Ints, Minima
from safestart.model.scenario import Floats


class Watched(Protocol):
    """Faces (``normals`` (F, d) at t = 0, ``offsets`` (F,), ``names``) of a question, rows, and the minima of a flight.

    ``rounding`` is what floats may lose of a distance, relative to the length that a flight can cover.
    """

    @property
    def question(self) -> Any:
        """A :class:`~safestart.exact.question.Question`, or one of its kin: what a search reads of it is the same."""

    rounding: float
    normals: Floats
    offsets: Floats
    names: tuple[str, ...]

    def cuts(self, times: Floats, faces: Ints) -> Cuts:
        """Rows at pairs of time (J,) and face (J,)."""

    def blocks(self, names: Sequence[str], times: Floats) -> Blocks:
        """Rows of the norm limits ``names`` (B) at ``times`` (B,)."""

    def minima(self, state: Floats, thrust: Floats) -> Minima:
        """Local minima and the all-times bound of a flight."""

    def __hash__(self) -> int:
        """By identity: caches hold entries per watch."""


class Ending(Watched, Protocol):
    """A watch whose question may end earlier."""

    def until(self, steps: int) -> Self:
        """The watch of the same question with T at ``steps`` intervals, at most its own."""
