"""The checker about the true Earth: sets at a burn off from a reference, cells, trial radii.

The reference is the flight of the planned state, enclosed like the target's course; the rest of a set moves linearly
near it, but for what the trial radii bound. For a cell [a, b] with direction d, a bound K on |G| and
k = K (b - a)^2/8 < 1,

    |d| distance >= min(f(a), f(b)) - k/(1 - k) |d| sum of max(|y(a)|, |y(b)|) - |d| stray,

y the path of the reference, the images of the centre and of the blocks: |y''| <= K |y|, so y is within k sup |y| of
its chord. A zone's centre and blocks z turn with LVLH, and are within W (b - a)^2/8 |z| of theirs.
"""

from __future__ import annotations

from flint import arb, arb_mat, fmpq

from safestart.proofs.abort.complete import Complete
from safestart.proofs.abort.earth.course import Course
from safestart.proofs.abort.earth.pushes import LastingPushes, Pushes, lift
from safestart.proofs.abort.earth.reference import Reference
from safestart.proofs.abort.earth.taylor import frobenius, middle
from safestart.proofs.abort.earth.turning import turning
from safestart.proofs.abort.finite import burning, times
from safestart.proofs.abort.reached import Reached, column, level, reach, sizes_along, sizes_of
from safestart.proofs.abort.sets import Sets
from safestart.proofs.abort.statement import Asked, Event, Zone
from safestart.proofs.strict import ProofRejected


class EarthChecker(Complete):
    """One statement about two bodies with J2."""

    def __init__(self, asked: Asked) -> None:
        super().__init__(asked)
        earth = asked.earth
        if earth is None:
            raise ProofRejected("model: required earth")
        self.earth, self.sets = earth, Sets(asked)
        begins = [time - asked.times[0] for time in asked.times]
        span = max(begin + self.longest(k) for k, begin in enumerate(begins))
        self.target = Course(earth.mu, earth.j2, earth.radius, [arb(e) for e in earth.state], span)
        self.mu, self.bulge = arb(earth.mu), arb(earth.mu) * arb(earth.j2) * arb(earth.radius) ** 2
        self.references: dict[tuple[int, fmpq], Reference] = {}

    def _reference(self, share: fmpq, burn: int) -> Reference:
        """The reference of cases of a burn, with a share of it."""
        found = self.references.get((burn, share))
        if found is None:
            begin = self.asked.times[burn] - self.asked.times[0]
            state = column([arb(e) for e in self.earth.before[burn]]) + arb(share) * self.sets.given(burn)
            off = middle(lift(self.target, arb(begin)) * state)
            at = [middle(m) for m in self.target.state(arb(begin))]
            there = [e for m in at for e in m.entries()]
            # Where the target is then is known to a radius; the chaser's place relative to it is what is exact.
            start = [(a + b).mid() for a, b in zip(there, off.entries(), strict=True)]
            earth = self.earth
            course = Course(earth.mu, earth.j2, earth.radius, start, self.longest(burn))
            away = [e for m in self.target.state(arb(begin)) for e in m.entries()]
            off = column([a - b for a, b in zip(start, away, strict=True)])
            until = arb(self.longest(burn))
            lowest = course.least(arb(0), until)
            # The target's whole course may come lower, at another burn's time.
            both = lowest.min(self.target.least(arb(begin), arb(begin) + until))
            stiffness = arb((2 * self.mu / both**3 + 12 * self.bulge / both**5).abs_upper())
            turns = turning(self.target, arb(begin), arb(begin) + until)
            longest = self.longest(burn)
            found = Reference(self.target, course, off, begin, longest, lowest, both, stiffness, turns)
            self.references[burn, share] = found
        return found

    def longest(self, burn: int) -> fmpq:
        """The longest drift of all cases of a burn: its parts are those of all of them."""
        asked = self.asked
        lasts = asked.durations[burn]
        out = asked.horizon + (asked.late + lasts + asked.stuck if lasts else max(asked.late, asked.stuck))
        if burn + 1 < len(asked.times):
            out = max(out, asked.times[burn + 1] - asked.times[burn] + asked.late)
        return out * (1 + fmpq(1, 2**30))

    def held(self, event: Event) -> None:
        """Check the cells of an event, after its trial radii."""
        burn = max(event.burn, 0)
        reference, zone = self._reference(event.reference, burn), self.asked.zones[event.zone]
        stiffness = reference.stiffness
        state = self._state(event, burn, reference, stiffness.sqrt())
        columns = [state.centre - reference.off] + [m for block in state.blocks for m in block]
        table = arb_mat(6, len(columns), [m[k, 0] for k in range(6) for m in columns])
        sizes = [len(block) for block in state.blocks]
        strays = self._strays(event, burn, reference, table, sizes, stiffness)
        part, claim = self.longest(burn) / len(strays), arb(self.asked.least)
        zone_sizes = [] if zone.is_point else [len(block) for block in zone.blocks]
        bend = reference.turning.bend / 8 * reach([zone.centre], *zone.blocks)
        images: dict[fmpq, tuple[arb_mat, list[arb]]] = {}
        for begin, end, *direction in event.cells:
            if not (begin < end and any(direction)):
                raise ProofRejected(f"{event.kind}, burn {event.burn}: a cell without length or direction")
            if not (begin >= 0 and end <= self.longest(burn)):
                # The bounds on the courses are for the times of the drift only.
                raise ProofRejected(f"{event.kind}, burn {event.burn}: a cell outside its drift")
            at = []
            for time in (begin, end):
                if time not in images:
                    images[time] = self._image(reference, time, table, sizes, zone)
                at.append(images[time])
            row = arb_mat([[arb(e) for e in direction]])
            length = arb(sum((e * e for e in direction), fmpq(0))).sqrt()
            low = [level(row * image, sizes + zone_sizes) for image, _ in at]
            k = stiffness * arb((end - begin) ** 2) / 8
            if not k < 1:
                raise ProofRejected(
                    f"{event.kind}, burn {event.burn}: a cell of {float(end - begin):g} s is too long"
                )
            path, *rest = (a.max(b) for a, b in zip(at[0][1], at[1][1], strict=True))
            square = arb((end - begin) ** 2)
            between = (
                self._bent(path, square, reference.both) + k / (1 - k) * sum(rest, arb(0)) + bend * square
            )
            # A cell that ends within a part gets the stray up to the end of that part.
            last = min(max(int((end / part).ceil()), 1), len(strays))
            room = low[0].min(low[1]) - length * (between + strays[last - 1] + claim)
            if not room >= 0:
                raise ProofRejected(
                    f"{event.kind}, burn {event.burn}: distance >= {float(claim):.9g} m from {float(begin):.9g} to "
                    f"{float(end):.9g} s after it: short by {-float(room.mid()):.3g} (scaled by the direction)"
                )

    def _bent(self, path: arb, square: arb, low: arb) -> arb:
        """How far the path may be from its chord over a cell, from its size at the ends: G is that of points between
        both bodies, which stay above ``low``: a little nearer to the Earth than they are."""
        # Nothing is pulled more than at the lowest point: the path does not get longer than this.
        reach = path + (self.mu / low**2 + 6 * self.bulge / low**4) * square / 4
        if not reach < low:
            raise ProofRejected("cell: required a chaser nearer to the target")
        between = (low**2 - reach**2 / 4).sqrt()
        k = (2 * self.mu / between**3 + 12 * self.bulge / between**5) * square / 8
        if not k < 1:
            raise ProofRejected("cell: required a shorter one")
        return k / (1 - k) * path

    def _image(
        self, reference: Reference, time: fmpq, table: arb_mat, sizes: list[int], zone: Zone
    ) -> tuple[arb_mat, list[arb]]:
        """Positions (3, 1 + C + S) of the centre, less the zone's, of columns and of the zone's columns, and sizes of
        path, centre and blocks."""
        whole, path = reference.moved(time) * table, reference.path(time)
        off = sizes_of(whole, sizes)
        for i in range(3):
            whole[i, 0] += path[i, 0]
        if zone.is_point:
            return whole, [frobenius(path), *off]
        still = [zone.centre, *(axis for block in zone.blocks for axis in block)]
        turned = reference.axes(time) * arb_mat(3, len(still), [arb(v[i]) for i in range(3) for v in still])
        for i in range(3):
            whole[i, 0] -= turned[i, 0]
        both = [a + b[1:] for a, b in zip(whole.tolist(), turned.tolist(), strict=True)]
        return arb_mat(both), [frobenius(path), *off]

    def _state(self, event: Event, burn: int, reference: Reference, k: arb) -> Reached:
        """The set of an event at the planned time of its burn, inertial, relative to the target."""
        asked = self.asked
        lifted = lift(self.target, arb(reference.begin))
        if asked.durations[burn] > 0 and event.kind != "start":
            before = self.sets.before[burn].moved(lifted)
            return burning(asked, before, event, self._lasting(reference, burn, k))
        if event.kind not in ("late", "stuck"):
            return self.sets.of(event).moved(lifted)
        impulse = [arb(e) for e in asked.impulses[burn]]
        limits = arb(asked.share), arb(asked.angle)
        pushes = Pushes(self.target, reference.course, reference.begin, k)
        if event.kind == "late":
            return pushes.late(self.sets.before[burn].moved(lifted), impulse, limits, event.first, event.last)
        after, thrust = self.sets.after[burn].moved(lifted), arb(asked.acceleration)
        return pushes.stuck(after, impulse, thrust, limits, event.first, event.last)

    def _lasting(self, reference: Reference, burn: int, k: arb) -> LastingPushes:
        """The pushes of all cases near a reference."""
        asked = self.asked
        if reference.lasting is None:
            longest = asked.late + asked.durations[burn] + asked.stuck
            reference.lasting = LastingPushes(
                self.target, reference.course, reference.begin, k, longest, reference.turning
            )
        return reference.lasting

    def _detour(self, event: Event, burn: int, k: arb) -> arb:
        """Bound on the distance of the actual position during a late or lasting burn from its equivalent state's."""
        last, most = arb(event.last), 1 + arb(self.asked.share)
        if event.kind != "start" and self.asked.durations[burn] > 0:
            size = arb(sum((e * e for e in self.asked.impulses[burn]), fmpq(0))).sqrt()
            (_, late), (_, on) = times(self.asked, event)
            return most * size * arb(on / self.asked.durations[burn]) * (k * arb(late + on)).sinh() / k
        if event.kind == "late":
            size = arb(sum((e * e for e in self.asked.impulses[burn]), fmpq(0))).sqrt()
            return most * size * (k * last).sinh() / k
        if event.kind == "stuck":
            return most * arb(self.asked.acceleration) * ((k * last).cosh() - 1) / k**2
        return arb(0)

    def _strays(
        self, event: Event, burn: int, reference: Reference, table: arb_mat, sizes: list[int], stiffness: arb
    ) -> list[arb]:
        """How far the true motion may be from the linear one in each part; raise if a trial radius does not hold."""
        parts, detour = reference.parts(len(event.radii)), self._detour(event, burn, stiffness.sqrt())
        nodes = sizes_along(parts.rows * table, sizes)
        kicks: list[arb] = []
        out: list[arb] = []
        for j, radius in enumerate(event.radii):
            reached = sum(map(arb.max, nodes[j], nodes[j + 1]), arb(0)) / (1 - parts.curve)
            earlier = (parts.weights[j] * arb_mat(j, 1, kicks))[0, 0] if j else arb(0)
            push = self._remainder(arb(radius), reference.lowest)
            there = earlier + parts.own * push
            if not reached + detour + there < arb(radius):
                raise ProofRejected(
                    f"radii_m: part {j} does not hold the motion within {float(radius):.9g} m"
                )
            kicks.append(arb(push.abs_upper()))
            # What is permitted in a part may be less than in an earlier one, and a cell may span both.
            most = arb(there.abs_upper())
            out.append(most.max(out[-1]) if out else most)
        return out

    def _remainder(self, rho: arb, lowest: arb) -> arb:
        """Bound on what the linear motion leaves out, up to the distance rho from a reference above ``lowest``."""
        r = lowest - rho
        if not r > lowest / 2:
            raise ProofRejected(
                f"radii_m: required less than half the orbit's radius, received {float(rho):.9g}"
            )
        return (3 * self.mu / r**4 + 30 * self.bulge / r**6) * rho * rho
