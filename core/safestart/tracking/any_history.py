"""Does any impulse history from a start keep the chaser in the turning corridor at all nodes?

s(0) and s(1) of :class:`Sampled` follow from the start; s(k) is free for k >= 2, for u(k) = P s(k+2) + Q s(k+1) +
R s(k). So the s in body axes, C(k) s(k), are the variables (with impulses they are the positions), and every row
touches three neighbours at most: a banded linear program (a second-order cone program for inputs in a ball). Starts may
be variables too: the set of all starts is convex, and its extent along a line takes two programs.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import csc_matrix, hstack, kron, vstack
from scipy.sparse import eye as identity

from safestart.control.tracking_mpc.sampled import Sampled
from safestart.control.tracking_mpc.tuning import DockingCorridor
from safestart.model.scenario import Floats
from safestart.optim.cone_program import plain_settings, solved

FEASIBLE = 1e-7
"""A smaller violation of the corridor, m, counts as none: the solver's own tolerance."""
_FARTHEST = 1e4
"""Variables are within this, m; the proof of infeasibility multiplies its residual by it."""


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
        nodes = len(attitudes)
        # Impulses: the position is s. Held thrust: it is a sum of s at two nodes, one of them after the last node.
        frames = np.concatenate([attitudes, attitudes[-1:]]) if motion.held else attitudes
        count, width = len(frames) - 2, len(frames)
        back = frames.swapaxes(1, 2)

        def rows(matrix: Floats, shift: int, rows: int) -> Any:
            return _banded(frames[:rows] @ matrix @ back[shift : shift + rows], shift, width)

        corridor: Any = kron(identity(nodes), csc_matrix(faces.normals))
        self._places: Any = None
        if motion.held:
            self._places = rows(motion.flat[0, :3], 0, nodes) + rows(motion.flat[1, :3], 1, nodes)
            corridor = corridor @ self._places
        inputs: Any = rows(motion.r, 0, count) + rows(motion.q, 1, count) + rows(motion.p, 2, count)
        room, limit = np.tile(faces.offsets, nodes), np.full(3 * count, u_max)
        self._soft = len(room)
        if ball:
            # Cones of |u| <= u_max, heads first.
            order = np.arange(4 * count).reshape(count, 4)
            spread = csc_matrix((np.ones(3 * count), (order[:, 1:].ravel(), np.arange(3 * count))))
            heads = np.zeros(4 * count)
            heads[order[:, 0]] = u_max
            matrix, self._bound = vstack([corridor, -spread @ inputs]), np.concatenate([room, heads])
            self._cones = [(0, len(room)), (4, count)]
        else:
            matrix = vstack([corridor, inputs, -inputs])
            self._bound = np.concatenate([room, limit, limit])
            self._cones = [(0, matrix.shape[0])]
        whole = csc_matrix(matrix)
        # s(0) and s(1) from the start; with impulses they are the positions at nodes 0 and 1.
        if motion.held:
            first = np.linalg.inv(np.hstack([motion.flat[0], motion.flat[1]]))
            first = np.vstack([frames[0] @ first[:3], frames[1] @ first[3:]])
        else:
            first = np.vstack([np.hstack([frames[0], np.zeros((3, 3))]), frames[1] @ motion.a[:3]])
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
        positions = np.concatenate([self._first @ state, found[:-1]])
        if self._places is not None:
            positions = self._places @ positions
        positions = positions.reshape(-1, 3)
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
        """Minimise sign times the last variable, whose column is given.

        Not a ``ConeProgram``, whose blocks are dense: here thousands of starts share one banded matrix.
        """
        matrix = csc_matrix(hstack([self._free, csc_matrix(column[:, None])]))
        cost = np.zeros(matrix.shape[1])
        cost[-1] = sign
        return solved(cost, matrix, bound, self._cones, plain_settings()), matrix

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
