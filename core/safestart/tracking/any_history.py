"""Does any impulse history from a start keep the chaser in the turning corridor at all nodes?

Positions at nodes 0 and 1 follow from the start; those at the nodes k >= 2 are free, for u(k) = P r(k+2) + Q r(k+1) +
R r(k). So the positions in the body, p_k = C(k) r_k, are the variables, and every row touches three neighbours at most:
a banded linear program (a second-order cone program for inputs in a ball). Starts may be variables too: the set of all
starts is convex, and its extent along a line takes two programs.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from scipy.sparse import csc_matrix, hstack, kron, vstack
from scipy.sparse import eye as identity

from safestart.control.tracking_mpc.sampled import Sampled
from safestart.control.tracking_mpc.tuning import DockingCorridor
from safestart.model.scenario import Floats

FEASIBLE = 1e-7
"""A smaller violation of the corridor, m, counts as none: the solver's own tolerance."""
_FARTHEST = 1e4
"""Positions in the body are within this, m; the proof of infeasibility multiplies its residual by it."""


@dataclass(frozen=True)
class Answer:
    """``feasible``: some history keeps every row to 1e-7 m. ``violation``, m: the least possible in the corridor.

    ``proved``: the dual, in floating point with its residual included, shows that no history exists.
    ``positions`` (K + 1, 3), body, of the best history found.
    """

    feasible: bool
    violation: float
    proved: bool
    positions: Floats


class AnyHistory:
    """All histories of K inputs |u_i| <= ``u_max`` m/s (body axes; ``ball``: |u|) under ``attitudes`` (K + 1, 3, 3)."""

    def __init__(
        self, motion: Sampled, shape: DockingCorridor, u_max: float, attitudes: Floats, *, ball: bool = False
    ) -> None:
        faces = shape.faces()
        nodes, count = len(attitudes), len(attitudes) - 2
        corridor = kron(identity(nodes), csc_matrix(faces.normals))
        here, back = attitudes[:-2], attitudes.swapaxes(1, 2)
        parts = [
            _banded(here @ matrix @ back[shift : shift + count], shift, nodes)
            for shift, matrix in ((0, motion.r), (1, motion.q), (2, motion.p))
        ]
        inputs: Any = parts[0] + parts[1] + parts[2]
        room, limit = np.tile(faces.offsets, nodes), np.full(3 * count, u_max)
        self._soft = len(room)
        if ball:
            # Cones of |u| <= u_max, heads first.
            order = np.arange(4 * count).reshape(count, 4)
            spread = csc_matrix((np.ones(3 * count), (order[:, 1:].ravel(), np.arange(3 * count))))
            heads = np.zeros(4 * count)
            heads[order[:, 0]] = u_max
            matrix, self._bound = vstack([corridor, -spread @ inputs]), np.concatenate([room, heads])
            self._cones = [("rows", len(room)), ("norms", count)]
        else:
            matrix = vstack([corridor, inputs, -inputs])
            self._bound = np.concatenate([room, limit, limit])
            self._cones = [("rows", matrix.shape[0])]
        whole = csc_matrix(matrix)
        # Nodes 0 and 1 from the start.
        first = np.vstack(
            [np.hstack([attitudes[0], np.zeros((3, 3))]), attitudes[1] @ motion.a[:3]], dtype=np.float64
        )
        self._first = first
        self._given, self._free = np.asarray(whole[:, :6] @ first), whole[:, 6:]

    def answer(self, state: Floats) -> Answer:
        """The least violation over all histories from an LVLH ``state`` (6,)."""
        state = np.asarray(state, dtype=np.float64)
        column = np.zeros(len(self._bound))
        column[: self._soft] = -1.0
        bound = self._bound - self._given @ state
        solution, matrix = self._solve(column, bound, 1.0)
        found, dual = np.array(solution.x), np.array(solution.z)
        solved = str(solution.status) in ("Solved", "AlmostSolved")
        violation = float(found[-1]) if solved else float("nan")
        positions = np.concatenate([self._first @ state, found[:-1]]).reshape(-1, 3)
        feasible = solved and violation <= FEASIBLE
        return Answer(feasible, violation, not feasible and self._proves(dual, matrix, bound), positions)

    def extent(self, base: Floats, along: Floats) -> tuple[float, float] | None:
        """The interval of s for which base + s along, LVLH states (6,), is a start of a history; None: there is none.

        Each end has the solver's error, about 1e-8 of the set's size.
        """
        column, bound = self._given @ along, self._bound - self._given @ base
        ends = []
        for sign in (1.0, -1.0):
            solution, _ = self._solve(column, bound, sign)
            if str(solution.status) not in ("Solved", "AlmostSolved"):
                return None
            ends.append(float(solution.x[-1]))
        return ends[0], ends[1]

    def _solve(self, column: Floats, bound: Floats, sign: float) -> tuple[Any, Any]:
        """Minimise sign times the last variable, whose column is given."""
        import clarabel

        kinds: list[Any] = []
        for kind, size in self._cones:
            rows = kind == "rows"
            kinds += [clarabel.NonnegativeConeT(size)] if rows else [clarabel.SecondOrderConeT(4)] * size
        matrix = csc_matrix(hstack([self._free, csc_matrix(column[:, None])]))
        cost = np.zeros(matrix.shape[1])
        cost[-1] = sign
        none = csc_matrix((len(cost), len(cost)))
        return clarabel.DefaultSolver(none, cost, matrix, bound, kinds, _settings()).solve(), matrix

    def _proves(self, dual: Floats, matrix: Any, bound: Floats) -> bool:
        """Whether -y'b > |A'y| at the farthest positions, for y in the dual cone: then every history has t > 0."""
        y, rows = dual.copy(), self._cones[0][1]
        y[:rows] = np.maximum(y[:rows], 0.0)
        norms = y[rows:].reshape(-1, 4)
        norms[:, 0] = np.maximum(norms[:, 0], np.linalg.norm(norms[:, 1:], axis=1) * (1.0 + 1e-12))
        rest = float(np.abs((matrix.T @ y)[:-1]).sum()) * _FARTHEST
        rounding = 1e-12 * float(np.abs(y) @ np.abs(bound))
        return bool(-(y @ bound) > rest + rounding)


def _banded(blocks: Floats, shift: int, nodes: int) -> Any:
    """(3 J, 3 nodes), sparse: block j (3, 3) of ``blocks`` (J, 3, 3) at node j + ``shift``."""
    count = len(blocks)
    row = 3 * np.arange(count)[:, None, None] + np.arange(3)[None, :, None]
    column = 3 * (np.arange(count) + shift)[:, None, None] + np.arange(3)[None, None, :]
    place = (np.broadcast_to(row, blocks.shape).ravel(), np.broadcast_to(column, blocks.shape).ravel())
    return csc_matrix((blocks.ravel(), place), shape=(3 * count, 3 * nodes))


@cache
def _settings() -> Any:
    import clarabel

    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.max_threads = 1
    return settings
