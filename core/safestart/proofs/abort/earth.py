"""The checker about the true Earth: sets at a burn off from a reference, cells, trial radii.

The reference is the flight of the planned state, enclosed like the target's course; the rest of a set moves linearly
near it, but for what the trial radii bound. For a cell [a, b] with direction d, a bound K on |G| and
k = K (b - a)^2/8 < 1,

    |d| distance >= min(f(a), f(b)) - k/(1 - k) |d| sum of max(|y(a)|, |y(b)|) - |d| stray,

y the path of the reference, the images of the centre and of the blocks: |y''| <= K |y|, so y is within k sup |y| of
its chord.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from flint import arb, arb_mat, fmpq

from safestart.proofs.abort.complete import Complete
from safestart.proofs.abort.course import Course, inverse
from safestart.proofs.abort.pushes import Pushes, lift
from safestart.proofs.abort.reached import Reached, column
from safestart.proofs.abort.sets import Sets
from safestart.proofs.abort.statement import Asked, Event
from safestart.proofs.abort.taylor import frobenius, middle
from safestart.proofs.strict import ProofRejected


@dataclass(slots=True)
class Reference:
    """A reference from a burn on: its course, its inertial state relative to the target then (6, 1), exact, and what
    is kept of it: transitions, paths, norms of blocks."""

    course: Course
    off: arb_mat
    begin: fmpq
    moved: dict[fmpq, arb_mat] = field(default_factory=dict)
    path: dict[fmpq, arb_mat] = field(default_factory=dict)
    norms: dict[tuple[fmpq, int, int], tuple[arb, arb, arb, arb]] = field(default_factory=dict)


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

    def _reference(self, kind: str, burn: int) -> Reference:
        """The reference of a case: no burn, half of it where it is burnt in part, else all of it."""
        share = {"start": fmpq(0), "partial": fmpq(1, 2)}.get(kind, fmpq(1))
        found = self.references.get((burn, share))
        if found is None:
            begin = self.asked.times[burn] - self.asked.times[0]
            state = [arb(e) for e in self.earth.before[burn]]
            for i in range(3):
                state[3 + i] = arb(self.earth.before[burn][3 + i] + share * self.asked.impulses[burn][i])
            off = middle(lift(self.target, arb(begin)) * column(state))
            at = [middle(m) for m in self.target.state(arb(begin))]
            there = [e for m in at for e in m.entries()]
            # Where the target is then is known to a radius; the chaser's place relative to it is what is exact.
            start = [(a + b).mid() for a, b in zip(there, off.entries(), strict=True)]
            earth = self.earth
            course = Course(earth.mu, earth.j2, earth.radius, start, self.longest(burn))
            away = [e for m in self.target.state(arb(begin)) for e in m.entries()]
            off = column([a - b for a, b in zip(start, away, strict=True)])
            found = Reference(course, off, begin)
            self.references[burn, share] = found
        return found

    def longest(self, burn: int) -> fmpq:
        """The longest drift of all cases of a burn: its parts are those of all of them."""
        asked = self.asked
        out = asked.horizon + max(asked.late, asked.stuck)
        if burn + 1 < len(asked.times):
            out = max(out, asked.times[burn + 1] - asked.times[burn] + asked.late)
        return out * (1 + fmpq(1, 2**30))

    def held(self, event: Event) -> None:
        """Check the cells of an event, after its trial radii."""
        burn = max(event.burn, 0)
        reference = self._reference(event.kind, burn)
        stiffness = arb(reference.course.stiffness.max(self.target.stiffness).abs_upper())
        state = self._state(event, burn, reference, stiffness.sqrt())
        columns = [state.centre - reference.off] + [m for block in state.blocks for m in block]
        table = arb_mat(6, len(columns), [m[k, 0] for k in range(6) for m in columns])
        sizes = [len(block) for block in state.blocks]
        strays = self._strays(event, burn, reference, table, sizes, stiffness)
        part, claim = self.longest(burn) / len(strays), arb(self.asked.least)
        images: dict[fmpq, tuple[arb_mat, list[arb]]] = {}
        for begin, end, *direction in event.cells:
            if not (begin < end and any(direction)):
                raise ProofRejected(f"{event.kind}, burn {event.burn}: a cell without length or direction")
            at = []
            for time in (begin, end):
                if time not in images:
                    images[time] = self._image(reference, time, table, sizes)
                at.append(images[time])
            row = arb_mat([[arb(e) for e in direction]])
            length = arb(sum((e * e for e in direction), fmpq(0))).sqrt()
            low = [_level(row * image, sizes) for image, _ in at]
            k = stiffness * arb((end - begin) ** 2) / 8
            if not k < 1:
                raise ProofRejected(
                    f"{event.kind}, burn {event.burn}: a cell of {float(end - begin):g} s is too long"
                )
            spread = sum((a.max(b) for a, b in zip(at[0][1], at[1][1], strict=True)), arb(0))
            # A cell that ends within a part gets the stray up to the end of that part.
            last = min(max(int((end / part).ceil()), 1), len(strays))
            room = low[0].min(low[1]) - length * (k / (1 - k) * spread + strays[last - 1] + claim)
            if not room >= 0:
                raise ProofRejected(
                    f"{event.kind}, burn {event.burn}: distance >= {float(claim):.9g} m from {float(begin):.9g} to "
                    f"{float(end):.9g} s after it: short by {-float(room.mid()):.3g} (scaled by the direction)"
                )

    def _image(
        self, reference: Reference, time: fmpq, table: arb_mat, sizes: list[int]
    ) -> tuple[arb_mat, list[arb]]:
        """Positions (3, 1 + C) of centre and columns, and sizes of path, centre and blocks."""
        whole = arb_mat(_moved(reference, time).tolist()[:3]) * table
        path = reference.path.get(time)
        if path is None:
            path = reference.course.state(arb(time))[0] - self.target.state(arb(reference.begin + time))[0]
            reference.path[time] = path
        off = _sizes(whole, sizes)
        for i in range(3):
            whole[i, 0] += path[i, 0]
        return whole, [frobenius(path), *off]

    def _state(self, event: Event, burn: int, reference: Reference, k: arb) -> Reached:
        """The set of an event at the planned time of its burn, inertial, relative to the target."""
        asked = self.asked
        lifted = lift(self.target, arb(reference.begin))
        if event.kind not in ("late", "stuck"):
            return self.sets.of(event).moved(lifted)
        impulse = [arb(e) for e in asked.impulses[burn]]
        limits = arb(asked.share), arb(asked.angle)
        pushes = Pushes(self.target, reference.course, reference.begin, k)
        if event.kind == "late":
            return pushes.late(self.sets.before[burn].moved(lifted), impulse, limits, event.first, event.last)
        after, thrust = self.sets.after[burn].moved(lifted), arb(asked.acceleration)
        return pushes.stuck(after, impulse, thrust, limits, event.first, event.last)

    def _detour(self, event: Event, burn: int, k: arb) -> arb:
        """Bound on the distance of the actual position during a late or lasting burn from its equivalent state's."""
        last, most = arb(event.last), 1 + arb(self.asked.share)
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
        count, h, k = len(event.radii), self.longest(burn) / len(event.radii), stiffness.sqrt()
        step = arb(h)
        curve = stiffness * step * step / 8
        if not curve < 1:
            raise ProofRejected("radii_m: the parts are too long")
        moves = [_moved(reference, h * j) for j in range(count + 1)]
        nodes = [_sizes(arb_mat(m.tolist()[:3]) * table, sizes) for m in moves]
        grown, slid = (k * step).cosh(), (k * step).sinh() / k
        pushed = (grown - 1) / stiffness
        kicks: list[arb] = []
        out = []
        detour = self._detour(event, burn, k)
        for j, radius in enumerate(event.radii):
            reached = sum((a.max(b) for a, b in zip(nodes[j], nodes[j + 1], strict=True)), arb(0)) / (
                1 - curve
            )
            at, fast = arb(0), arb(0)
            for m, kick in enumerate(kicks, 1):
                norms = _norms(reference, h, j, m)
                at += (norms[0] * pushed + norms[1] * slid) * kick
                fast += (norms[2] * pushed + norms[3] * slid) * kick
            push = self._remainder(arb(radius), reference.course.lowest)
            there = grown * at + slid * fast + pushed * push
            if not reached + detour + there < arb(radius):
                raise ProofRejected(
                    f"radii_m: part {j} does not hold the motion within {float(radius):.9g} m"
                )
            kicks.append(arb(push.abs_upper()))
            out.append(arb(there.abs_upper()))
        return out

    def _remainder(self, rho: arb, lowest: arb) -> arb:
        """Bound on what the linear motion leaves out, up to the distance rho from a reference above ``lowest``."""
        r = lowest - rho
        if not r > lowest / 2:
            raise ProofRejected(
                f"radii_m: required less than half the orbit's radius, received {float(rho):.9g}"
            )
        return (3 * self.mu / r**4 + 30 * self.bulge / r**6) * rho * rho


def _moved(reference: Reference, time: fmpq) -> arb_mat:
    """Transition (6, 6) from the burn, ``time`` s long."""
    found = reference.moved.get(time)
    if found is None:
        found = reference.moved[time] = reference.course.motion(arb(time))
    return found


def _norms(reference: Reference, h: fmpq, j: int, m: int) -> tuple[arb, arb, arb, arb]:
    """Norms of the blocks of the transition from m h to j h, the same for all cases of a reference."""
    found = reference.norms.get((h, j, m))
    if found is None:
        whole = _moved(reference, h * j) * inverse(_moved(reference, h * m))
        one, two, three, four = (
            frobenius(arb_mat([[whole[r + i, c + e] for e in range(3)] for i in range(3)]))
            for r in (0, 3)
            for c in (0, 3)
        )
        found = reference.norms[h, j, m] = one, two, three, four
    return found


def _sizes(image: arb_mat, sizes: list[int]) -> list[arb]:
    """Sizes, from above, of the centre and of each block, from their images (3, 1 + C)."""
    out, at = [], 0
    for size in (1, *sizes):
        total = sum((image[i, at + j] * image[i, at + j] for i in range(3) for j in range(size)), arb(0))
        out.append(arb(total.abs_upper()).sqrt())
        at += size
    return out


def _level(values: arb_mat, sizes: list[int]) -> arb:
    """f at one time."""
    level, at = values[0, 0], 1
    for size in sizes:
        total = sum((values[0, at + j] * values[0, at + j] for j in range(size)), arb(0))
        level = level - arb(total.abs_upper()).sqrt()
        at += size
    return level
