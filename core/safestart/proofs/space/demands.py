"""Keep-outs, field of view and plume rule of a statement, read strictly and checked on a flight. Part of the checker.

The demands themselves are checked, whatever convex parts of them a prover used. With p the position in the demand's
frame, over pieces of time that are halved until one of the alternatives holds everywhere on a piece:

    sphere: |p - c|^2 >= (R + claim)^2;   box: some +-(p_i - c_i) >= h_i + claim
    view: l = a . (q - p) sin(angle) - claim for unit a; l^2 >= cos^2(angle) (|q - p|^2 - (a . (q - p))^2) and l >= 0
    plume, d = p - q: |d| >= range, or u . d <= 0, or (u . d)^2 <= cos^2(angle) |u|^2 |d|^2
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from flint import arb, arb_poly, fmpq

from safestart.proofs.space.parts import frame_of
from safestart.proofs.space.series import Series, require_any
from safestart.proofs.strict import ProofRejected, exact, fields, number, part, shown, vector

KEYS = ("keep_outs", "field_of_view", "plume")
_MOST_KEEP_OUTS = 8
_MOST_ANGLE = 1.5


@dataclass(frozen=True, slots=True)
class KeepOut:
    """A sphere (``size`` one number) or a box (three half-widths) about ``centre`` in ``frame``, m."""

    centre: list[fmpq]
    size: list[fmpq]
    frame: str

    def alternatives(self, p: Series, claim: arb) -> list[Series]:
        """Series of which one alternative's are >= 0 where p is at least ``claim`` m outside."""
        away = [e - arb(c) for e, c in zip(p, self.centre, strict=True)]
        if len(self.size) == 1:
            return [[_dot(away, away) - (arb(self.size[0]) + claim) ** 2]]
        return [
            [sign * e - (arb(half) + claim)]
            for e, half in zip(away, self.size, strict=True)
            for sign in (1, -1)
        ]


@dataclass(frozen=True, slots=True)
class View:
    """From p, ``point`` (m) is seen within ``angle`` rad of ``axis``, all in ``frame``."""

    axis: list[fmpq]
    angle: fmpq
    point: list[fmpq]
    frame: str

    def alternatives(self, p: Series, claim: arb) -> list[Series]:
        """See :class:`KeepOut`."""
        size = arb(sum((e * e for e in self.axis), fmpq(0))).sqrt()
        sight = [arb(q) - e for q, e in zip(self.point, p, strict=True)]
        along = _dot([arb_poly([arb(e) / size]) for e in self.axis], sight)
        depth = along * arb(self.angle).sin() - claim
        return [[depth, depth * depth - arb(self.angle).cos() ** 2 * (_dot(sight, sight) - along * along)]]

    def plane(self, pull: list[fmpq]) -> list[arb]:
        """``pull`` p, where p . (point - position) >= 0 for all positions that see the point: p . a >= sin(angle) |p|.

        Then outside of the cone p . (point - position) is at least -|p| times the distance to it.
        """
        p, a = [arb(e) for e in pull], [arb(e) for e in self.axis]
        along = sum((x * y for x, y in zip(p, a, strict=True)), arb(0))
        sizes = [sum((e * e for e in each), arb(0)).sqrt() for each in (p, a)]
        if not along >= arb(self.angle).sin() * sizes[0] * sizes[1]:
            raise ProofRejected("pull: required the normal of a plane that leaves the cone on one side")
        return p


@dataclass(frozen=True, slots=True)
class Plume:
    """Within ``reach`` m of ``point`` no exhaust within ``angle`` rad of the line of sight to it."""

    angle: fmpq
    reach: fmpq
    point: list[fmpq]
    frame: str

    def alternatives(self, p: Series, push: Series) -> list[Series]:
        """As :meth:`KeepOut.alternatives`, for a thrust ``push`` in the rule's frame."""
        away = [e - arb(q) for e, q in zip(p, self.point, strict=True)]
        along, square = _dot(push, away), _dot(away, away)
        cone = arb(self.angle).cos() ** 2 * _dot(push, push) * square - along * along
        return [[square - arb(self.reach) ** 2], [-along], [cone]]


@dataclass(frozen=True, slots=True)
class Demands:
    """All of them by name; empty or None where there is none."""

    regions: dict[str, KeepOut | View]
    plume: Plume | None

    def __bool__(self) -> bool:
        return bool(self.regions) or self.plume is not None

    def keep(
        self,
        p: dict[str, Series],
        push: dict[str, Series],
        claim: arb,
        span: tuple[fmpq, fmpq],
        budget: list[int],
    ) -> None:
        """Positions and thrust by frame, over begin and length ``span`` in s; raises :class:`ProofRejected`."""
        for name, region in self.regions.items():
            require_any(region.alternatives(p[region.frame], claim), name, *span, budget)
        if self.plume is not None and any(e.degree() >= 0 for e in push["lvlh"]):
            frame = self.plume.frame
            require_any(self.plume.alternatives(p[frame], push[frame]), "plume", *span, budget)

    def require_violated(self, name: str, p: dict[str, Series], claim: arb) -> None:
        """The start keeps no more than ``claim`` < 0 m of the demand ``name``: its alternatives all fail by more."""
        region = self.regions.get(name)
        if region is None:
            raise ProofRejected(f"violated: required a keep-out or the field of view, received {shown(name)}")
        at = [arb_poly([e(arb(0))]) for e in p[region.frame]]
        for alternative in region.alternatives(at, claim):
            values = [each(arb(0)) for each in alternative]
            if isinstance(region, KeepOut) and len(region.size) == 1 and not arb(region.size[0]) + claim >= 0:
                raise ProofRejected("margin_m: required at least minus the radius")
            if not any(value <= 0 for value in values):
                raise ProofRejected(f"{name} <= margin_m at the start: it is not shown")


def _dot(a: Series, b: Series) -> arb_poly:
    return sum((x * y for x, y in zip(a, b, strict=True)), arb_poly([0]))


def demands_of(question: Any, taken: set[str]) -> Demands:
    """The demands; raises :class:`ProofRejected`. ``taken`` are the names of faces and limits."""
    regions: dict[str, KeepOut | View] = {}
    if KEYS[0] in question:
        rows = part(question, KEYS[0], list)
        if not 1 <= len(rows) <= _MOST_KEEP_OUTS:
            raise ProofRejected(f"keep_outs: required 1..{_MOST_KEEP_OUTS}, received {len(rows)}")
        for row in rows:
            round_ = isinstance(row, dict) and "radius_m" in row
            fields(row, "keep_outs", ("name", "centre_m", "radius_m" if round_ else "half_widths_m", "frame"))
            name = part(row, "name", str)
            if name in regions or name in taken or name in KEYS or not 0 < len(name) <= 40:
                raise ProofRejected(
                    f"keep_outs: required names that nothing else has, received {shown(name)}"
                )
            given = [row["radius_m"]] if round_ else part(row, "half_widths_m", list)
            size = [exact(e, "keep_outs", 1e-6) for e in given]
            if len(size) != (1 if round_ else 3):
                raise ProofRejected("half_widths_m: required three numbers")
            regions[name] = KeepOut(vector(row["centre_m"], "centre_m", 3), size, frame_of(row, name))
    if KEYS[1] in question:
        said = question[KEYS[1]]
        fields(said, KEYS[1], ("axis", "half_angle_rad", "point_m", "frame"))
        axis = vector(said["axis"], "axis", 3)
        if sum((e * e for e in axis), fmpq(0)) == 0:
            raise ProofRejected("axis: required a vector that is not 0")
        angle = number(said, "half_angle_rad", 1e-3, _MOST_ANGLE)
        regions[KEYS[1]] = View(axis, angle, vector(said["point_m"], "point_m", 3), frame_of(said, KEYS[1]))
    plume = None
    if KEYS[2] in question:
        said = question[KEYS[2]]
        fields(said, KEYS[2], ("half_angle_rad", "range_m", "point_m", "frame"))
        plume = Plume(
            number(said, "half_angle_rad", 1e-3, _MOST_ANGLE),
            number(said, "range_m", 1e-6),
            vector(said["point_m"], "point_m", 3),
            frame_of(said, KEYS[2]),
        )
    return Demands(regions, plume)
