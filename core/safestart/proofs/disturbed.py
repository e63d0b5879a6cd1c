"""Checker of proofs against a disturbance (schema ``safestart-proof-disturbed/1``) in ball arithmetic.

The flown thrust is u_k = v_k + K e_k, with e the state minus the plan's state. CWH is linear, so e does not depend on
plan or corridor:

    e_{k+1} = F e_k + int Phi_v(s) w(s) ds,   F = Phi(dt) + B(dt) K,   r_e(t_k + s) = M(s) e_k + int Phi_rv w,

M = (Phi + B K)_r. Carrying q back through F bounds every row q . e over all disturbances and starts; 96 directions
bound the worst direction of the plane; the error's largest acceleration bounds the values between the samples of an
interval. The checker then flies the plan with less thrust and keeps it away from every face by the bound on the error.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from flint import acb, arb, arb_mat, fmpq

from safestart.proofs.balls import PRECISION, Motion
from safestart.proofs.disturbed_statement import StatedDisturbed, read
from safestart.proofs.single import Verified, Witness
from safestart.proofs.strict import ProofRejected
from safestart.proofs.wording import lines_disturbed
from safestart.runtime.precision import precise

_DIRECTIONS, _PANELS = 96, 8
_REST = 1e-11
"""Share of a bound that may come from the coarser bound of the unit rows."""
_LONGEST_SAMPLE, _FEWEST_SAMPLES, _MOST_SAMPLES = fmpq(1, 4), 4, 64


def check(document: Any) -> Verified:
    """Check a proof; raise :class:`ProofRejected` with the reason when it is malformed or an inequality fails."""
    stated = read(document)
    plan = stated.plan
    with precise(PRECISION):
        _require_tube(stated)
        if stated.thrust > plan.a_max:
            raise ProofRejected("tube.thrust_m_s2: required at most max_acceleration_m_s2")
        c_z, radius, height = arb(plan.shape["c_z"]), arb(stated.radius), arb(stated.height)
        # The normal of a z face has 1 across the plane and c_z in it.
        upper = (c_z * radius + height) / (1 + c_z * c_z).sqrt()
        taken = {name: upper if name in ("top", "bottom") else radius for name in plan.faces}
        pieces = Witness(replace(plan, a_max=plan.a_max - stated.thrust), taken).check()
    return Verified("GO", float(document["margin_m"]), pieces, lines_disturbed(stated))


def _require_tube(stated: StatedDisturbed) -> None:
    plane = _worst(stated, (0, 1), stated.plane)
    cross = _worst(stated, (2,), stated.cross) if stated.cross else _Worst(arb(0), arb(0))
    thrust = (plane.thrust**2 + cross.thrust**2).sqrt()
    for name, found, claim, unit in (
        ("radius_m", plane.position, stated.radius, "m"),
        ("height_m", cross.position, stated.height, "m"),
        ("thrust_m_s2", thrust, stated.thrust, "m/s^2"),
    ):
        if not found <= arb(claim):
            raise ProofRejected(
                f"tube.{name}: required at least the bound for all disturbances, {float(found):.9g} {unit}, received "
                f"{float(arb(claim)):.9g}"
            )


@dataclass(frozen=True, slots=True)
class _Worst:
    """Bounds on the position error at all times (m) and on the feedback's thrust at the nodes (m/s^2)."""

    position: arb
    thrust: arb


def _worst(stated: StatedDisturbed, axes: tuple[int, ...], gain: list[list[fmpq]]) -> _Worst:
    """The error along ``axes``, the orbit plane or the line across it, which CWH decouples."""
    plan, error = stated.plan, _Error(stated, axes, gain)
    n, dt, push = error.motion.n, arb(plan.dt), arb(stated.push)
    unit, widen = _directions(len(axes))
    samples = min(max(_FEWEST_SAMPLES, int((plan.dt / _LONGEST_SAMPLE).ceil())), _MOST_SAMPLES)
    d = len(axes)
    # After a unit kick |v| <= this: the Coriolis term does no work, the gravity gradient is 3 n^2 |r|.
    fastest = _kick(n, dt)
    blocks, late = (
        [unit * error.gain, unit * arb_mat([[int(j == d + i) for j in range(2 * d)] for i in range(d)])],
        [
            arb(0),
            arb(0),
        ],
    )
    for j in range(samples + 1):
        s = dt * j / samples
        blocks.append(unit * error.position(s))
        late.append(push * s * s / 2 * fastest)
    bounds = [widen * (b + more) for b, more in zip(error.over(blocks), late, strict=True)]
    thrust, speed, position = bounds[0], bounds[1], _largest(bounds[2:])
    # n . r_e between samples h apart: h^2 / 8 of |r''| <= 3 n^2 |r| + 2 n |v| + |K e| + |w|, and |v| grows by the
    # accelerations; the largest |r| appears on both sides.
    h, gravity = dt / samples, 3 * n * n
    bend = h * h / 8
    share = bend * gravity * (1 + 2 * n * dt)
    if not share < 1:
        raise ProofRejected("dt_s: required so short that gravity does not rule the error")
    push_now = thrust + push
    whole = (position + bend * (2 * n * (speed + dt * push_now) + push_now)) / (1 - share)
    return _Worst(whole.abs_upper(), thrust.abs_upper())


class _Error:
    """The motion of the error along some axes, and bounds of rows on it."""

    def __init__(self, stated: StatedDisturbed, axes: tuple[int, ...], gain: list[list[fmpq]]) -> None:
        plan = stated.plan
        self.motion, self.steps, self.dt = Motion(plan), plan.steps, arb(plan.dt)
        self.d, self.push, self.away, self.fast = (
            len(axes),
            arb(stated.push),
            arb(stated.away),
            arb(stated.fast),
        )
        self.kept = [*axes, *(plan.d + axis for axis in axes)]
        self.axes = list(axes)
        self.gain = arb_mat([[arb(e) for e in row] for row in gain])
        phi, held = self._over(self.dt)
        self.closed = phi + held * self.gain
        panels = [self._over(self.dt * j / _PANELS)[0] for j in range(_PANELS + 1)]
        d = self.d
        self.kicks = [arb_mat([[phi[i, d + c] for c in range(d)] for i in range(2 * d)]) for phi in panels]
        n, fastest = self.motion.n, _kick(self.motion.n, self.dt)
        # Second derivatives of position and velocity after a unit kick.
        self.bend = 3 * n * n * self.dt * fastest + 2 * n * fastest
        self.jerk = 3 * n * n * fastest + 2 * n * self.bend

    def _over(self, s: arb) -> tuple[arb_mat, arb_mat]:
        phi, held = self.motion.over(s)
        return (
            arb_mat([[phi[i, j] for j in self.kept] for i in self.kept]),
            arb_mat([[held[i, j] for j in self.axes] for i in self.kept]),
        )

    def position(self, s: arb) -> arb_mat:
        """M(s), (d, 2 d)."""
        phi, held = self._over(s)
        whole = phi + held * self.gain
        return arb_mat([[whole[i, j] for j in range(2 * self.d)] for i in range(self.d)])

    def over(self, blocks: list[arb_mat]) -> list[arb]:
        """For each block of rows (R, 2 d) the largest |q . e_k| of its rows, all k up to N, disturbances and starts."""
        count, size = blocks[0].nrows(), 2 * self.d
        basis = arb_mat([[int(i == j) for j in range(size)] for i in range(size)])
        units, _ = self._carried(basis, self.steps, arb(0), None)
        rows = arb_mat([[block[i, j] for j in range(size)] for block in blocks for i in range(count)])
        bounds, _ = self._carried(rows, self.steps, arb(_REST), units)
        return [_largest(bounds[i : i + count]) for i in range(0, len(bounds), count)]

    def _carried(
        self, rows: arb_mat, steps: int, least: arb, units: list[arb] | None
    ) -> tuple[list[arb], int]:
        """Bounds on |q . e_k| for rows q (R, 2 d) and all k up to ``steps``, and how many steps were carried.

        With ``units``, the bounds of the unit rows, it ends when the remainder is small: (q F^m) . e is at most the sum
        of its entries' sizes times the units' bounds.
        """
        driven, begun = [arb(0)] * rows.nrows(), [arb(0)] * rows.nrows()
        known = bool(self.away == 0) and bool(self.fast == 0)
        for k in range(steps + 1):
            near, fast = _sizes(rows, 0, self.d), _sizes(rows, self.d, 2 * self.d)
            if not known:
                now = [r * self.away + v * self.fast for r, v in zip(near, fast, strict=True)]
                begun = [max(a, b, key=_top) for a, b in zip(begun, now, strict=True)]
            if units is not None and k % 8 == 7:
                rest = [
                    sum((abs(e) * u for e, u in zip(row, units, strict=True)), arb(0)) for row in _rows(rows)
                ]
                if all(more < least * (a + b) for more, a, b in zip(rest, driven, begun, strict=True)):
                    return [a + b + more for a, b, more in zip(driven, begun, rest, strict=True)], k
            if k == steps:
                break
            pushed = self._pushed(rows, near, fast)
            driven = [a + self.push * b for a, b in zip(driven, pushed, strict=True)]
            rows = rows * self.closed
        return [a + b for a, b in zip(driven, begun, strict=True)], steps

    def _pushed(self, rows: arb_mat, near: list[arb], fast: list[arb]) -> list[arb]:
        """Upper bound on the effect of a unit disturbance on each row within one interval: int |q Phi_v(s)| ds.

        The norm of a linear interpolant is at most the interpolated norm; the interpolant errs by h^2 / 8 of the second
        derivative, h^2 / 12 on average.
        """
        h = self.dt / _PANELS
        sizes = [_sizes(rows * kick, 0, self.d) for kick in self.kicks]
        inner = [sum(row[1:-1], (row[0] + row[-1]) / 2) for row in zip(*sizes, strict=True)]
        missed = self.dt * h * h / 12
        return [
            h * e + missed * (r * self.bend + v * self.jerk)
            for e, r, v in zip(inner, near, fast, strict=True)
        ]


def _kick(n: arb, dt: arb) -> arb:
    """Largest speed within dt after a unit kick: |v| <= 1 + 3 n^2 int |r|, |r| <= s |v|."""
    left = 1 - 3 * n * n * dt * dt / 2
    if not left > 0:
        raise ProofRejected("mean_motion_rad_s * dt_s: required well under 1")
    return 1 / left


def _directions(d: int) -> tuple[arb_mat, arb]:
    """Unit rows over half a turn, and the factor by which a direction between two may exceed both.

    Between directions 2 b apart any unit vector is their combination with weights >= 0 of sum at most 1 / cos b.
    """
    if d == 1:
        return arb_mat([[arb(1)]]), arb(1)
    angles = [arb.pi() * j / _DIRECTIONS for j in range(_DIRECTIONS)]
    return arb_mat([[a.cos(), a.sin()] for a in angles]), 1 / (arb.pi() / (2 * _DIRECTIONS)).cos()


def _rows(matrix: arb_mat) -> list[list[arb]]:
    """The rows as lists."""
    entries, columns = matrix.entries(), matrix.ncols()
    return [entries[i : i + columns] for i in range(0, len(entries), columns)]


def _sizes(matrix: arb_mat, begin: int, end: int) -> list[arb]:
    """Norms of the rows' entries from ``begin`` to ``end``, one or two of them."""
    entries, columns = matrix.entries(), matrix.ncols()
    if end - begin == 1:
        return [abs(e) for e in entries[begin::columns]]
    return [
        abs(acb(a, b)) for a, b in zip(entries[begin::columns], entries[begin + 1 :: columns], strict=True)
    ]


def _top(value: arb) -> float:
    return float(value.abs_upper())


def _largest(values: list[arb]) -> arb:
    """Upper bound on the largest of non-negative numbers."""
    return max((value.abs_upper() for value in values), key=float)
