"""Cone programs, built from named blocks and solved by Clarabel.

Minimise sum_v cost_v . v + 1/2 sum_vw v' P_vw w over variables v, subject to constant + sum_v G_v v in K for every
block: nonnegative numbers (``rows``) or second-order cones, |y| <= head, heads first (``norms``). Clarabel reads
b - A x in K: the columns stand in the order of the variables, all rows before all norms, both in the order in which
they were added.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from safestart.errors import invalid
from safestart.model.scenario import Floats

Ints = np.ndarray[tuple[int, ...], np.dtype[np.int64]]


class Each:
    """Component i of a variable (n,) enters w rows of a block, ``rows[i]`` of (n, w), times ``value``.

    Raises ``InvalidInput`` where the rows of a component do not rise.
    """

    def __init__(self, rows: Ints, value: float = 1.0) -> None:
        if rows.ndim != 2 or rows.min(initial=0) < 0 or (rows[:, 1:] <= rows[:, :-1]).any():
            raise invalid("rows", "numbers of rows (n, w), rising along the last axis", rows)
        self.rows, self.value, self.last = rows, value, int(rows.max(initial=-1))


class Part(NamedTuple):
    """A variable's part of a block: its columns, and for each column up to w ``values`` (negative) in ``rows``."""

    columns: slice
    values: Floats | float
    rows: Ints
    width: int


class Block(NamedTuple):
    """``constant`` (R,), length of the second-order cones (0 for rows), and parts, the widest of them ``width``."""

    constant: Floats
    cone: int
    parts: list[Part]
    width: int


class Columns:
    """A sparse matrix by columns as Clarabel reads it; lists, because it would box every element of an array."""

    has_canonical_format = has_sorted_indices = True

    def __init__(
        self, data: list[float], indices: list[int], indptr: list[int], shape: tuple[int, int]
    ) -> None:
        self.data, self.indices, self.indptr, self.shape = data, indices, indptr, shape


class Found:
    """The solver's result: its status, values of the variables, weights (dual variables) of the blocks.

    Values and weights exist whatever the ``status``, but may not be finite.
    """

    def __init__(self, solution: Any, variables: Mapping[str, slice], blocks: Mapping[str, Block]) -> None:
        self.status = str(solution.status)
        self._x, self._z, self._variables, self._blocks = solution.x, solution.z, variables, blocks

    @property
    def solved(self) -> bool:
        """Whether the status is Solved or AlmostSolved."""
        return self.status in ("Solved", "AlmostSolved")

    def value(self, variable: str) -> Floats:
        """Values (n,) of a variable."""
        return np.array(self._x[self._variables[variable]])

    def weights(self, block: str) -> Floats:
        """Weights (R,) of a block's rows; those of each norm are one vector of the second-order cone."""
        first = 0
        for name, other in self._blocks.items():
            if name == block:
                break
            first += len(other.constant)
        return np.array(self._z[first : first + len(self._blocks[block].constant)])


class ConeProgram:
    """One program; ``sizes`` gives the variables' names and their numbers of components.

    A block takes its coefficients by variable: an array (R, n), :class:`Each`, or, for a variable of one component, a
    number that enters every row, of norms every head. Raises ``InvalidInput`` for an unknown variable, a repeated name
    and a wrong shape.
    """

    def __init__(self, **sizes: int) -> None:
        self._columns: dict[str, slice] = {}
        self._count = 0
        for variable, size in sizes.items():
            self._columns[variable] = slice(self._count, self._count + size)
            self._count += size
        self._rows: dict[str, Block] = {}
        self._norms: dict[str, Block] = {}
        self._cost = [0.0] * self._count
        self._squares: Floats | None = None

    def rows(self, name: str, constant: Floats, **coefficients: Floats | Each | float) -> None:
        """Add R rows, ``constant`` (R,) + ... >= 0."""
        self._rows[name] = self._block(name, constant, 0, coefficients)

    def norms(self, name: str, constant: Floats, **coefficients: Floats | Each | float) -> None:
        """Add B norms, |y| <= head: ``constant`` (B, 1 + d) + ..., each with its head first, in B (1 + d) rows."""
        if constant.ndim != 2 or constant.shape[1] < 2:
            raise invalid(name, "constants (B, 1 + d): a head and what it bounds", constant.shape)
        self._norms[name] = self._block(name, constant.ravel(), constant.shape[1], coefficients)

    def minimise(self, **cost: Floats | float) -> None:
        """Set the costs of variables: (n,) for each component, or one number for all; other costs stay, 0 at first."""
        for variable, given in cost.items():
            columns = self._of(variable)
            size = columns.stop - columns.start
            if isinstance(given, np.ndarray) and given.shape != (size,):
                raise invalid(variable, f"{size} costs", given.shape)
            self._cost[columns] = given.tolist() if isinstance(given, np.ndarray) else [given] * size

    def curve(self, variable: str, other: str, matrix: Floats) -> None:
        """Set P_vw (n, m) of two variables, the earlier one first; P is symmetric, so P_wv follows."""
        rows, columns = self._of(variable), self._of(other)
        shape = rows.stop - rows.start, columns.stop - columns.start
        if matrix.shape != shape or columns.start < rows.start:
            raise invalid(
                f"{variable}.{other}", f"a matrix {shape}, the earlier variable first", matrix.shape
            )
        if self._squares is None:
            self._squares = np.zeros((self._count, self._count))
        self._squares[rows, columns] = matrix

    def solve(self, *, fine: bool = True, plain: bool = False) -> Found:
        """Solve; without ``fine`` the solver stops some iterations earlier, some 1e-5 from the optimum.

        ``plain``: with Clarabel's own settings, for programs that its presolving and refinement help.
        """
        cost, matrix, constant, cones = self.standard_form()
        settings = plain_settings() if plain else _settings(fine)
        squares = None if self._squares is None else _upper(self._squares)
        solution = solved(cost, matrix, constant, cones, settings, squares)
        return Found(solution, self._columns, self._rows | self._norms)

    def standard_form(self) -> tuple[list[float], Columns, list[float], list[tuple[int, int]]]:
        """Cost (n,), A (m, n), b (m,) and cones: minimise cost . x with b - A x in K.

        Cones are (length, how many): first the nonnegative rows as (0, how many), then the second-order cones.
        """
        rows, norms = list(self._rows.values()), list(self._norms.values())
        cones = [(0, sum([len(block.constant) for block in rows]))]
        cones += [(block.cone, len(block.constant) // block.cone) for block in norms]
        constant = np.concatenate([block.constant for block in rows + norms]).tolist()
        return self._cost, self._matrix(rows + norms, len(constant)), constant, cones

    def _matrix(self, blocks: list[Block], height: int) -> Columns:
        """A by columns, without zeros."""
        # One line per column with its entries and their rows, block after block. In every line a block takes as many
        # places as its fullest column needs.
        count, width, first, at = self._count, sum([block.width for block in blocks]), 0, 0
        filled, where = np.zeros((count, width)), np.empty((count, width), dtype=np.int64)
        for block in blocks:
            for part in block.parts:
                place = part.columns, slice(at, at + part.width)
                filled[place], where[place] = part.values, part.rows + first
            first, at = first + len(block.constant), at + block.width
        # Flat indices are several times faster than masks, and sorted: they give the columns' ends.
        kept = (filled != 0.0).ravel().nonzero()[0]
        data, indices = filled.ravel().take(kept), where.ravel().take(kept)
        starts = kept.searchsorted(width * np.arange(count + 1))
        return Columns(data.tolist(), indices.tolist(), starts.tolist(), (height, count))

    def _block(
        self, name: str, constant: Floats, cone: int, coefficients: Mapping[str, Floats | Each | float]
    ) -> Block:
        if name in self._rows or name in self._norms:
            raise invalid(name, "a name that no other block has", name)
        parts, count = [], len(constant)
        for variable, given in coefficients.items():
            columns = self._of(variable)
            size = columns.stop - columns.start
            if isinstance(given, np.ndarray):
                fits = given.shape == (count, size)
                parts.append(Part(columns, -given.T, np.arange(count), count))
            elif isinstance(given, Each):
                fits = len(given.rows) == size and given.last < count
                parts.append(Part(columns, -given.value, given.rows, given.rows.shape[1]))
            else:
                fits, rows = size == 1, np.arange(0, count, cone or 1)
                parts.append(Part(columns, -given, rows, len(rows)))
            if not fits:
                raise invalid(
                    f"{name}.{variable}", f"coefficients for {count} rows and {size} components", given
                )
        return Block(constant, cone, parts, max([part.width for part in parts], default=0))

    def _of(self, variable: str) -> slice:
        if variable not in self._columns:
            raise invalid(variable, f"one of the variables {', '.join(self._columns)}", variable)
        return self._columns[variable]


def solved(
    cost: Any, matrix: Any, constant: Any, cones: list[tuple[int, int]], settings: Any, squares: Any = None
) -> Any:
    """Clarabel's solution of a program in standard form; see :meth:`ConeProgram.standard_form`.

    ``matrix``: :class:`Columns` or SciPy's ``csc_matrix``; ``squares``: the same, P on and above its diagonal.
    """
    # Imported with the first program, so that importing this module stays light.
    import clarabel

    kinds: list[Any] = []
    for length, count in cones:
        kinds += [clarabel.SecondOrderConeT(length)] * count if length else [clarabel.NonnegativeConeT(count)]
    if squares is None:
        squares = Columns([], [], [0] * (len(cost) + 1), (len(cost), len(cost)))
    return clarabel.DefaultSolver(squares, cost, matrix, constant, kinds, settings).solve()


def _upper(square: Floats) -> Columns:
    """The upper triangle of a dense matrix (n, n), by columns, without zeros."""
    by_column, size = np.triu(square).T, len(square)
    kept = (by_column != 0.0).ravel().nonzero()[0]
    starts = kept.searchsorted(size * np.arange(size + 1))
    return Columns(
        by_column.ravel().take(kept).tolist(), (kept % size).tolist(), starts.tolist(), (size, size)
    )


@cache
def plain_settings() -> Any:
    """Clarabel's own settings, silent and in one thread."""
    import clarabel

    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.max_threads = 1
    return settings


@cache
def _settings(fine: bool) -> Any:
    """Clarabel's settings for programs of this size."""
    import clarabel

    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.max_threads = 1
    settings.presolve_enable = False
    settings.chordal_decomposition_enable = False
    settings.iterative_refinement_enable = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-8
    if not fine:
        settings.tol_gap_abs, settings.tol_gap_rel, settings.tol_feas = 2e-5, 1e-7, 1e-6
    return settings
