"""The abort time of a state of a tube, as an affine function of the symbols of its start."""

from __future__ import annotations

from dataclasses import dataclass

from safestart.model.scenario import Floats


@dataclass(frozen=True, slots=True)
class Clock:
    """Abort time of a node of a tube: its own time plus ``offset`` + ``gens`` (g,) . xi +- ``radius`` (min).

    The xi are the first symbols of the tube; the later ones are remainders.
    """

    offset: float
    gens: Floats
    radius: float
