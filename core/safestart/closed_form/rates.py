"""Numbers of the certificate that all starts share, from spin, orbit, thrust and kind of rest."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

from safestart.closed_form.family import Family, family_of
from safestart.model.scenario import Rest, Scenario

GUARD = 1e-9
"""Reserved share of the thrust, far above the rounding of every sum that decides whether thrust suffices."""


SLOWEST = 1e-6
"""A slower start counts as this fast where its braking reach ends: there the angle to the stop becomes 0 over 0."""


@dataclass(frozen=True, slots=True)
class Rates:
    """Units: ``rate`` is W = omega_t + n (rad/s), ``scale`` W^2 / a_max (1/m): a range r counts as rho = r scale.

    ``speed`` and ``nu`` are omega_t / W (0 for rest in the body frame) and n / W; ``turning`` is g = 1 + nu^2 / 2.
    A start brakes and then stands if rho <= ``brake_limit``; ``across`` and ``lost`` are G and (3/2) nu^2 H of the
    page. ``sway`` is n^2 / a_max (1/m), the share of the thrust that holds a metre of z.
    """

    omega: float
    mean_motion: float
    rate: float
    scale: float
    sway: float
    speed: float
    nu: float
    turning: float
    across: float
    lost: float
    brake_limit: float
    family: Family


def rates_of(scenario: Scenario, rest: Rest) -> Rates:
    """The shared numbers of a scenario, which do not depend on its corridor."""
    target = scenario.target
    return _rates(target.tumble_rate, target.mean_motion, scenario.chaser.max_acceleration, rest)


@lru_cache(maxsize=1024)
def _rates(omega: float, mean_motion: float, a_max: float, rest: Rest) -> Rates:
    rate = omega + mean_motion
    thrust = a_max * (1.0 - GUARD)
    # Without any rotation no thrust is needed: scale is 0, which avoids a division by W = 0.
    nu = mean_motion / rate if rate > 0.0 else 0.0
    speed = omega / rate if rest is Rest.LVLH and rate > 0.0 else 0.0
    turning = 1.0 + 0.5 * nu * nu
    across = max(turning, 2.0 * speed - turning)
    lost = 1.5 * nu * nu * math.sqrt(1.0 + speed * speed / (2.0 * turning))
    slowest = max(speed, SLOWEST) if speed > 0.0 else 0.0
    limit = 1.0 / (lost + math.sqrt(across * across + 2.0 * turning * slowest * slowest))
    return Rates(
        omega,
        mean_motion,
        rate,
        rate * rate / thrust,
        mean_motion * mean_motion / thrust,
        speed,
        nu,
        turning,
        across,
        lost,
        limit,
        family_of(speed, nu),
    )
