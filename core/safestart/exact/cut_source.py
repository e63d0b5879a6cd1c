"""The interface that a search uses to watch flights, for one question (``watch.py``) or a family of them."""

from __future__ import annotations

from typing import Protocol

from safestart.exact.question import Question
from safestart.exact.watch import Cuts, Ints, Minima
from safestart.model.scenario import Floats
from safestart.optim.prediction import Prediction


class Watched(Protocol):
    """Faces (``normals`` (F, d), ``offsets`` (F,), ``names``) of one question, its rows, and the minima of a flight."""

    question: Question
    prediction: Prediction
    normals: Floats
    offsets: Floats
    names: tuple[str, ...]

    def cuts(self, times: Floats, faces: Ints) -> Cuts:
        """Rows at pairs of time (J,) and face (J,)."""

    def minima(self, state: Floats, thrust: Floats) -> Minima:
        """Local minima and the all-times bound of a flight."""

    def __hash__(self) -> int:
        """By identity: caches hold entries per watch."""
