"""How far the nonlinear motion may be from the linear one: checks a document's trial radii in ball arithmetic.

The error of the linearisation is at most 3 mu rho^2 / (r - rho)^4 at the distance rho, mu = n^2 r^3. A radius holds
over a part if the motion that it and the earlier radii permit stays inside: by continuity no motion then leaves it.
"""

from __future__ import annotations

from flint import arb

from safestart.proofs.strict import ProofRejected


def remainder(n: arb, r: arb, rho: arb) -> arb:
    """Lagrange's bound on the omitted acceleration, up to the distance rho < r/2."""
    if not rho < r / 2:
        raise ProofRejected(f"radii_m: required less than half the orbit's radius, received {float(rho):.9g}")
    return 3 * n * n * r**3 * rho * rho / (r - rho) ** 4


def strays(n: arb, r: arb, h: arb, linear: list[arb], radii: list[arb]) -> list[list[arb]]:
    """Bounds on each axis up to the end of each part of ``h`` s; raise ``ProofRejected`` if a radius does not hold.

    ``linear``: bounds on the linear motion over each part, m.
    """
    reach = [_reach(n, h, m) for m in range(len(radii))]
    pushes: list[arb] = []
    out = []
    for k, (within, radius) in enumerate(zip(linear, radii, strict=True)):
        push = remainder(n, r, radius)
        pushes.append(arb.max(push, pushes[-1]) if pushes else push)
        there = [sum((pushes[j] * reach[k - j][i] for j in range(k + 1)), arb(0)) for i in range(3)]
        if not within + sum((e * e for e in there), arb(0)).sqrt() < radius:
            raise ProofRejected(f"radii_m: part {k} does not hold the motion within {float(radius):.9g} m")
        out.append(there)
    return out


def _reach(n: arb, h: arb, m: int) -> list[arb]:
    """Integral of |rows of Phi_pv| over [m h, (m + 1) h]: mean of the ends, and h^3/12 times the second derivative."""
    ends = [_rows(n, h * k) for k in (m, m + 1)]
    bends = (2 * n, 4 * n, n)
    return [h * (a + b) / 2 + h**3 / 12 * bend for a, b, bend in zip(*ends, bends, strict=True)]


def _rows(n: arb, t: arb) -> list[arb]:
    s, c = (n * t).sin(), (n * t).cos()
    across, along = 2 * (1 - c), 4 * s - 3 * n * t
    return [(s * s + across * across).sqrt() / n, (across * across + along * along).sqrt() / n, abs(s) / n]
