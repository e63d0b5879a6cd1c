"""Hamilton-Jacobi reachability on a grid, solved by compiled kernels: any affine motion, 2 to 6 states.

    from safestart.levelset import Ball, Box, Input, Kind, Lattice, Linear, Options, Scheme, solve

    lattice = Lattice.of([-10, -5], [10, 5], [101, 51])              # boundary="edge" | "periodic" | ... by axis
    x, v = lattice.coordinates()
    motion = Linear(A, (Input(B, Box(-u, u), "max"), Input(B, Box(-d, d), "min")))
    solution = solve(lattice, motion, np.abs(x) - 1.0 + 0.0 * v, 5.0, kind=Kind.TUBE, options=Options(Scheme.WENO5))

``values`` is l at the horizon (full shape); {V <= 0} is the set. ``kind``: "tube" (reached at some time), "fixed"
(at the horizon), "always" (held throughout). ``cap`` / ``floor``: arrays that broadcast against the lattice, or
functions of time, for a moving target (V <= cap) and an obstacle or state constraint (V >= floor). ``dynamics`` may
also be a model of hj-reachability's form. On numerical failure ``solution.field`` is None and ``solution.failure``
gives the reason; else the field has ``values``, ``value_at(states)``, ``gradient_at(states)``;
``solution.optimal_inputs(states)`` lists each input's best choice. States outside the lattice raise ``InvalidInput``.
For values at several times, solve piece by piece and pass the values of one piece to the next.
"""

from safestart.levelset.dynamics import Ball, Box, Input, Linear, Motion
from safestart.levelset.field import ValueField, optimal_inputs
from safestart.levelset.lattice import Boundary, Lattice
from safestart.levelset.march import March, Options
from safestart.levelset.scheme import Flux, Kind, Scheme
from safestart.levelset.solution import Solution, solve

__all__ = [
    "Ball",
    "Boundary",
    "Box",
    "Flux",
    "Input",
    "Kind",
    "Lattice",
    "Linear",
    "March",
    "Motion",
    "Options",
    "Scheme",
    "Solution",
    "ValueField",
    "optimal_inputs",
    "solve",
]
