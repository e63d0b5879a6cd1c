"""Settings of the Hamilton-Jacobi engine, derived from its options and a problem."""

from __future__ import annotations

from dataclasses import dataclass

from safestart.engines.base import Problem
from safestart.engines.hj.frame import Frame
from safestart.engines.hj.options import Accuracy, HamiltonJacobiInput
from safestart.model.scenario import Rest, SetKind

Shape = tuple[int, int, int, int]

BOUNDARY = "edge"
"""The grid's padding: repeat the last value, so that nothing flows in from outside."""
PRECISION = "float32"
"""Type of the values on the grid in both solvers."""


@dataclass(frozen=True, slots=True)
class Settings:
    """``solver`` is ours (``fused``, :mod:`safestart.levelset`) or ``hj_reachability``; both run the same schemes.

    ``accuracy`` names the scheme as hj-reachability does: low (first order, Euler), medium (ENO2, RK2), high (WENO3,
    RK3), very_high (WENO5, RK3). ``shape`` counts the nodes of (x, y, vx, vy), the state in ``frame``. ``match`` makes
    the target velocity-aware: the corridor counts only where the velocity differs from co-rotation by at most that
    many m/s (None: any velocity).
    """

    accuracy: Accuracy
    shape: Shape
    frame: Frame
    solver: str
    match: float | None = None

    @classmethod
    def of(cls, problem: Problem, options: HamiltonJacobiInput, match: float | None = None) -> Settings:
        """The options, with ``auto`` replaced by this problem's frame."""
        nodes = (options.nodes_xy, options.nodes_xy, options.nodes_v, options.nodes_v)
        frame = _best_frame(problem) if options.frame == "auto" else Frame(options.frame)
        return cls(options.accuracy, nodes, frame, options.solver, match)


def _best_frame(problem: Problem) -> Frame:
    # Measurements show that the body frame is closer to the exact set only there (docs/theory/hamilton-jacobi.md).
    corotating_tube = problem.rest is Rest.BODY and problem.kind is SetKind.TUBE
    return Frame.BODY if corotating_tube else Frame.LVLH
