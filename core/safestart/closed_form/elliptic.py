"""`certified` on an elliptic orbit, for a target that spins steadily in inertial space (docs/theory/certified.md).

In body axes that turn with W in inertial space, a chaser at q (complex, m) near a target on any Kepler orbit needs

    u = q'' + 2 i W q' - W^2 q - k(t) (q + 3 e^{i phase(t)} conj(q)) / 2,    k = mu / r^3,

and k stays between n^2 / (1 + e)^3 and n^2 / (1 - e)^3. With k_m in the middle and k_d half the difference the
certificate's bounds hold with g = 1 + k_m / 2 W^2 and, in the place of (3/2) nu^2, (3 k_max + k_d) / 2 W^2; out of the
plane |u_z| <= |z''| + k_max |z|. A start at rest in LVLH moves with lambda = 1 - nu'(0) / W, nu the true anomaly.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from safestart.closed_form.certified import FARTHEST, Certified, certify_by
from safestart.closed_form.family import family_under
from safestart.closed_form.rates import GUARD, Rates
from safestart.errors import invalid
from safestart.model.scenario import (
    MAX_ACCELERATION,
    MAX_MEAN_MOTION,
    MAX_TUMBLE_RATE,
    MIN_ACCELERATION,
    CorridorShape,
    Floats,
    Rest,
    number,
)

LARGEST_ECCENTRICITY = 0.95
_STEP = 0.005


@dataclass(frozen=True, slots=True)
class EllipticScenario:
    """``spin`` W about the orbit normal, rad/s in inertial space; ``mean_motion`` rad/s; ``anomaly`` rad at the start.

    ``max_acceleration`` m/s^2. Raises ``InvalidInput`` for values out of range.
    """

    spin: float
    mean_motion: float
    eccentricity: float
    anomaly: float
    max_acceleration: float
    corridor: CorridorShape

    def __post_init__(self) -> None:
        number("spin", self.spin, 0.0, MAX_TUMBLE_RATE + MAX_MEAN_MOTION, open_low=True)
        number("mean_motion", self.mean_motion, 0.0, MAX_MEAN_MOTION)
        number("eccentricity", self.eccentricity, 0.0, LARGEST_ECCENTRICITY)
        number("anomaly", self.anomaly, -1e3, 1e3)
        number("max_acceleration", self.max_acceleration, MIN_ACCELERATION, MAX_ACCELERATION)

    @property
    def lvlh_rate(self) -> float:
        """Rate of LVLH at the start, rad/s: n (1 + e cos nu)^2 / (1 - e^2)^(3/2)."""
        e = self.eccentricity
        return self.mean_motion * (1.0 + e * math.cos(self.anomaly)) ** 2 / math.sqrt(1.0 - e * e) ** 3


def elliptic_rates(scenario: EllipticScenario, rest: Rest) -> Rates:
    """The certificate's shared numbers; raises ``InvalidInput`` if a start at rest in LVLH would outrun the body."""
    e, n, spin = scenario.eccentricity, scenario.mean_motion, scenario.spin
    speed = 0.0
    if rest is Rest.LVLH:
        speed = 1.0 - scenario.lvlh_rate / spin
        if speed < 0.0:
            raise invalid(
                "spin", f"at least LVLH's own rate at the start, {scenario.lvlh_rate:g} rad/s", spin
            )
    most, least = (n * n / (1.0 - e) ** 3, n * n / (1.0 + e) ** 3)
    square, thrust = spin * spin, scenario.max_acceleration * (1.0 - GUARD)
    turning = 1.0 + 0.25 * (most + least) / square
    gradient = (1.5 * most + 0.25 * (most - least)) / square
    across = max(turning, 2.0 * speed - turning)
    lost = gradient * math.sqrt(1.0 + speed * speed / (2.0 * turning))
    return Rates(
        # Also where LVLH keeps up with the body: its gradient is not constant here, so never the case of no tumble.
        speed * spin or spin,
        n,
        spin,
        square / thrust,
        most / thrust,
        speed,
        math.sqrt(most / square),
        turning,
        across,
        lost,
        1.0 / (lost + math.sqrt(across * across + 2.0 * turning * speed * speed)),
        family_under(speed, turning, gradient),
    )


def certify_elliptic(scenario: EllipticScenario, points: Floats, rest: Rest = Rest.LVLH) -> Certified:
    """Certify starts at rest, body-frame positions ``points`` (..., 2) or (..., 3), m; body and LVLH axes agree then.

    GO: a manoeuvre keeps the chaser in the corridor for ever, at least ``margin`` from every face. Raises
    ``InvalidInput`` like :func:`safestart.closed_form.certified.certify`.
    """
    points = np.asarray(points, dtype=np.float64)
    if points.ndim == 0 or points.shape[-1] not in (2, 3) or not (np.abs(points) <= FARTHEST).all():
        raise invalid("points", f"(..., 2) or (..., 3), finite within {FARTHEST:g} m", points.shape)
    return certify_by(elliptic_rates(scenario, rest), scenario.corridor, points)


def largest_eccentricity(scenario: EllipticScenario, point: Floats, rest: Rest = Rest.LVLH) -> float | None:
    """Eccentricity up to which ``point`` (2,) or (3,) stays certified, to 1e-6; None: not even on a circular orbit.

    Scans in steps of 0.005 up to :data:`LARGEST_ECCENTRICITY`, then bisects the first step that loses the start; the
    scenario's own eccentricity is not used.
    """

    def holds(e: float) -> bool:
        tried = EllipticScenario(
            scenario.spin,
            scenario.mean_motion,
            e,
            scenario.anomaly,
            scenario.max_acceleration,
            scenario.corridor,
        )
        if rest is Rest.LVLH and tried.lvlh_rate > tried.spin:
            return False
        return bool(certify_elliptic(tried, point, rest).go)

    good = 0.0
    if not holds(good):
        return None
    while good < LARGEST_ECCENTRICITY:
        bad = min(good + _STEP, LARGEST_ECCENTRICITY)
        if holds(bad):
            good = bad
            continue
        while bad - good > 1e-6:
            middle = 0.5 * (good + bad)
            good, bad = (middle, bad) if holds(middle) else (good, middle)
        return good
    return good
