"""How fast LVLH turns along a target's enclosed course, in ball arithmetic: what zones that turn with it need.

Inertial y'' of a vector z at rest in LVLH is at most W |z|, W = |omega|^2 + |omega'|. With B = mu J2 R^2, r >= r_0 and
c = r x v: J2's torque is at most 3/2 B/r^3, the energy of the start is kept, and

    omega_z = |c|/r^2,  |omega_z'| <= 3/2 B/r^5 + 2 |c| |r'|/r^3,
    |omega_x| <= 3/2 B/(r^3 |c|) = o,  |omega_x'| <= 3 B/(r^3 |c|) (5 |v|/r + 2 o).
"""

from __future__ import annotations

from dataclasses import dataclass

from flint import arb

from safestart.proofs.abort.earth.course import Course
from safestart.proofs.strict import ProofRejected

_BALL = arb(0, 1)


@dataclass(frozen=True, slots=True)
class Turning:
    """From above: ``spin`` |omega|, 1/s, and ``bend`` W, 1/s^2."""

    spin: arb
    bend: arb


def turning(target: Course, begin: arb, end: arb) -> Turning:
    """Bounds between two times, s; raise ``ProofRejected`` where none is found."""
    rate, low = arb(target.rate), target.least(begin, end)
    bulge, mu = target.bulge * rate**2, target.mu * rate**2
    torque = 3 * bulge / (2 * low**3)
    # Steps begin and end beyond these times, maybe lower.
    lowest = target.lowest
    anywhere = 3 * bulge / (2 * lowest**3)
    least, most = arb("inf"), arb(0)
    loose = _BALL * target.off
    for one in target.within(begin, end):
        r = [e + loose for e in one.course.coefficients[0].entries()]
        v = [(e + loose) * rate for e in one.course.coefficients[1].entries()]
        size = _length([r[k - 2] * v[k - 1] - r[k - 1] * v[k - 2] for k in range(3)])
        changed = anywhere * one.length / rate
        least = least.min(arb((size - changed).lower()))
        most = most.max(arb((size + changed).upper()))
    first = target.steps[0]
    r, v = (
        list(first.course.coefficients[0].entries()),
        [e * rate for e in first.course.coefficients[1].entries()],
    )
    size = _length(r)
    twice = _length(v) ** 2 - 2 * mu / size + bulge / size**3 * (3 * (r[2] / size) ** 2 - 1)
    # The true start lies within the loose ball; the energy's change with it is that of v and of gravity.
    twice = twice + _BALL * (4 * target.off * (_length(v) * rate + mu / lowest**2 + 6 * bulge / lowest**4))
    if not least > 0:
        raise ProofRejected("target: its plane turns too far for bounds on LVLH")
    speed = arb((twice + 2 * mu / low + bulge / low**3).abs_upper()).sqrt()
    climb = arb((twice + (mu / least) ** 2 + bulge / low**3).abs_upper()).sqrt()
    tilt = torque / least
    spin = ((most / low**2) ** 2 + tilt**2).sqrt()
    tilting = 3 * bulge / (low**3 * least) * (5 * speed / low + 2 * tilt)
    turned = 3 * bulge / (2 * low**5) + 2 * most * climb / low**3
    bend = spin**2 + (tilting**2 + turned**2).sqrt()
    return Turning(arb(spin.abs_upper()), arb(bend.abs_upper()))


def _length(v: list[arb]) -> arb:
    return sum((e * e for e in v), arb(0)).sqrt()
