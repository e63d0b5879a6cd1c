"""A body's course about the Earth with J2 and the linear motion near it, enclosed at all times.

The pieces of :mod:`safestart.proofs.abort.earth.taylor` make one course p and one motion F, from F = I on. With the
true fundamental solution Psi = F (I + eta),

    |eta| <= exp(E) - 1,  E = sum of length x |F^-1| x (defect of F + 2 c |e| |F|) + 2 |F^-1| |jump|,

where |F^-1| <= 3 |F| as long as |eta| <= 1/2, because Psi is symplectic. The true course is p + e with |e| <= 2 B,
B = K (T defect + jumps), K = (3/2 |F|)^2 >= |Psi(t) Psi(s)^-1|, provided that 4 K T c B < 1, c a bound on half of
gravity's second derivative. Times are scaled by a number near the mean motion, velocities are in metres.
"""

from __future__ import annotations

from bisect import bisect_right

from flint import arb, arb_mat, fmpq

from safestart.proofs.abort.earth.pull import Field
from safestart.proofs.abort.earth.taylor import Step, frobenius, middle, step
from safestart.proofs.strict import ProofRejected

_MOST_STEPS = 20_000


class Course:
    """From an inertial state (6 exact numbers, m and m/s) for ``span`` s; times count from there."""

    def __init__(self, mu: fmpq, j2: fmpq, radius: fmpq, start: list[arb], span: fmpq) -> None:
        size = sum((e * e for e in start[:3]), arb(0)).sqrt()
        if not size > arb(radius):
            raise ProofRejected("target: required a position outside the Earth")
        # A rational near the mean motion.
        self.rate = fmpq(round(float((arb(mu) / size**3).sqrt()) * 2**60), 2**60)
        square = arb(self.rate) ** 2
        self.bulge = arb(mu) * arb(j2) * arb(radius) ** 2 / square
        self.mu = arb(mu) / square
        self.steps: list[Step] = []
        self.begins: list[float] = []
        self._carried(Field(self.mu, self.bulge * 3 / 2), start, arb(self.rate * span))
        self._enclosed()

    def _carried(self, field: Field, start: list[arb], end: arb) -> None:
        r, v = arb_mat(3, 1, start[:3]), arb_mat(3, 1, [e / arb(self.rate) for e in start[3:]])
        unit = arb_mat(6, 6, [int(i == j) for i in range(6) for j in range(6)])
        f, rate = arb_mat(unit.tolist()[:3]), arb_mat(unit.tolist()[3:])
        now, self.course_jumps, self.motion_jumps = arb(0), arb(0), []
        while now < end:
            if len(self.steps) >= _MOST_STEPS:
                raise ProofRejected(f"target: more than {_MOST_STEPS} steps")
            exact = [middle(m) for m in (r, v, f, rate)]
            loose = [frobenius(a - b) for a, b in zip((r, v, f, rate), exact, strict=True)]
            self.course_jumps += loose[0] + loose[1]
            made = step(field, now, arb(1), (exact[0], exact[1], exact[2], exact[3]))
            self.motion_jumps.append((loose[2] + loose[3], made.largest))
            self.steps.append(made)
            self.begins.append(float(now))
            r, v = made.course.at(made.length)
            f, rate = made.motion.at(made.length)
            now = now + made.length
            if not now.is_exact():
                raise ProofRejected("target: the times of the steps are not exact")
        self.end = now

    def _enclosed(self) -> None:
        largest = self.steps[0].largest
        square = self.steps[0].square
        for one in self.steps:
            largest, square = largest.max(one.largest), square.min(one.square)
        k = (largest * 3 / 2) ** 2
        b = k * (sum((s.length * s.course_defect for s in self.steps), arb(0)) + self.course_jumps)
        self.off = arb((2 * b).abs_upper())
        self.lowest = arb((square.sqrt() - self.off).abs_lower())
        # Half of gravity's second derivative, up to twice e away from the course.
        c = 3 * self.mu / self.lowest**4 + 30 * self.bulge / self.lowest**6
        exponent = arb(0)
        for s in self.steps:
            exponent += 3 * s.length * s.largest * (s.motion_defect + 2 * c * self.off * s.largest)
        for jump, size in self.motion_jumps:
            exponent += 6 * size * jump
        eta = exponent.exp() - 1
        if not (4 * k * self.end * c * b < 1 and eta < arb(1) / 2 and self.lowest > 0):
            raise ProofRejected("target: the course cannot be enclosed over so long a time")
        self.eta = arb(0, 1) * arb(eta.abs_upper())

    def within(self, begin: arb, end: arb) -> list[Step]:
        """The steps that may hold a time between two, s."""
        low, high = arb((begin * arb(self.rate)).lower()), arb((end * arb(self.rate)).upper())
        return [s for s in self.steps if not (s.begin + s.length < low or s.begin > high)]

    def least(self, begin: arb, end: arb) -> arb:
        """Lower bound on the radius, m, between two times, s. ``lowest`` is that of all steps, the last of which is not
        cut to the span: a short drift away from the perigee stays well above it."""
        low, high = arb((begin * arb(self.rate)).lower()), arb((end * arb(self.rate)).upper())
        square = arb("inf")
        for one in self.within(begin, end):
            if low <= one.begin and one.begin + one.length <= high:
                square = square.min(one.square)
            else:
                square = square.min(
                    one.least((low - one.begin).max(arb(0)), (high - one.begin).min(one.length))
                )
        if not (begin >= 0 and high <= self.end * (1 + arb(2) ** -30) and square > self.off**2):
            raise ProofRejected("target: a time outside the course")
        return arb((square.sqrt() - self.off).abs_lower())

    def _step(self, time: arb) -> Step:
        """The step that holds the ball of a scaled time; a ball over an end of a step belongs to the earlier one."""
        found = self.steps[max(bisect_right(self.begins, float(time.lower())) - 1, 0)]
        if not (time.lower() >= found.begin and time.upper() <= found.begin + found.length):
            raise ProofRejected("target: a time outside its step")
        return found

    def state(self, time: arb) -> tuple[arb_mat, arb_mat]:
        """Position and velocity (3, 1), m and m/s, at a time in s, which may be a ball; also where it spans steps."""
        scaled = time * arb(self.rate)
        low, high = arb(scaled.lower()), arb(scaled.upper())
        out: tuple[arb_mat, arb_mat] | None = None
        for one in self.steps[max(bisect_right(self.begins, float(low)) - 2, 0) :]:
            end = one.begin + one.length
            if end < low or one.begin > high:
                if out is not None:
                    break
                continue
            a, b = low.max(one.begin), high.min(end)
            ball = (a + b) / 2 + arb(0, 1) * ((b - a) / 2)
            r, v = one.course.at(ball - one.begin)
            out = (r, v) if out is None else (_union(out[0], r), _union(out[1], v))
        if out is None:
            raise ProofRejected("target: a time outside the course")
        loose = arb(0, 1) * self.off
        wide = arb_mat(3, 1, [loose] * 3)
        return out[0] + wide, (out[1] + wide) * arb(self.rate)

    def motion(self, time: arb) -> arb_mat:
        """Psi (6, 6) at a time in s, in seconds: positions and velocities at ``time`` of those at the start."""
        scaled = time * arb(self.rate)
        one = self.steps[max(bisect_right(self.begins, float(scaled.mid())) - 1, 0)]
        there = scaled - one.begin
        if not (abs(there - one.length / 2) <= one.length / 2 * (1 + arb(2) ** -30)):
            raise ProofRejected("target: a time outside its step")
        f, rate = one.motion.at(there)
        whole = arb_mat(f.tolist() + rate.tolist())
        size = frobenius(whole)
        whole = whole + arb_mat(6, 6, [size * self.eta] * 36)
        n = arb(self.rate)
        for i in range(3):
            for j in range(3):
                whole[i, j + 3] = whole[i, j + 3] / n
                whole[i + 3, j] = whole[i + 3, j] * n
        return whole


def inverse(phi: arb_mat) -> arb_mat:
    """The inverse of a symplectic matrix (6, 6)."""
    out = arb_mat(6, 6)
    for i in range(3):
        for j in range(3):
            out[i, j], out[i + 3, j + 3] = phi[j + 3, i + 3], phi[j, i]
            out[i, j + 3], out[i + 3, j] = -phi[j, i + 3], -phi[j + 3, i]
    return out


def _union(a: arb_mat, b: arb_mat) -> arb_mat:
    return arb_mat(3, 1, [x.union(y) for x, y in zip(a.entries(), b.entries(), strict=True)])
