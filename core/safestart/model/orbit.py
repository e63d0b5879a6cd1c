"""The target's Kepler orbit: how LVLH turns in inertial space, at any time and eccentricity.

The inertial axes are those of LVLH at t = 0: x radial, y along-track, z along the orbit's angular momentum. LVLH turns
about z by the increase of the true anomaly nu. Kepler's equation is E - e sin E = M with M = n t + M(0).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Self

import numpy as np

from safestart.errors import invalid
from safestart.model.scenario import MAX_MEAN_MOTION, Floats, number

MU = 3.986004418e14
"""Gravitational parameter of the Earth, m^3/s^2 (EGM2008)."""
EARTH_RADIUS = 6_378_137.0
"""Equatorial radius of the Earth, m."""
MAX_ECCENTRICITY = 0.8
_FURTHEST = 1e9
_HALLEY_STEPS = 40


@dataclass(frozen=True, slots=True)
class KeplerOrbit:
    """``mean_motion`` rad/s, ``eccentricity``, ``true_anomaly`` rad at t = 0; a mean motion of 0 does not turn.

    Raises ``InvalidInput`` for a mean motion or an eccentricity out of range, and a perigee inside the Earth.
    """

    mean_motion: float
    eccentricity: float = 0.0
    true_anomaly: float = 0.0

    def __post_init__(self) -> None:
        number("mean_motion", self.mean_motion, 0.0, MAX_MEAN_MOTION)
        number("eccentricity", self.eccentricity, 0.0, MAX_ECCENTRICITY)
        number("true_anomaly", self.true_anomaly, -1e3, 1e3)
        if self.eccentricity > 0.0:
            if self.mean_motion == 0.0:
                raise invalid("mean_motion", "more than 0 rad/s on an eccentric orbit", self.mean_motion)
            self._above_ground((MU / self.mean_motion**2) ** (1.0 / 3.0))

    @classmethod
    def of(cls, semi_major_axis: float, eccentricity: float, true_anomaly: float = 0.0) -> Self:
        """The orbit of a semi-major axis in metres; raises ``InvalidInput`` if the perigee lies inside the Earth."""
        number("semi_major_axis", semi_major_axis, EARTH_RADIUS, _FURTHEST)
        orbit = cls(math.sqrt(MU / semi_major_axis**3), 0.0, true_anomaly)
        number("eccentricity", eccentricity, 0.0, MAX_ECCENTRICITY)
        cls(orbit.mean_motion, eccentricity, true_anomaly)._above_ground(semi_major_axis)
        return cls(orbit.mean_motion, eccentricity, true_anomaly)

    def _above_ground(self, semi_major_axis: float) -> None:
        perigee = semi_major_axis * (1.0 - self.eccentricity)
        if perigee < EARTH_RADIUS * (1.0 - 1e-12):
            raise invalid(
                "eccentricity", f"a perigee at or above {EARTH_RADIUS:g} m from the centre", perigee
            )

    @property
    def circular(self) -> bool:
        """Whether LVLH turns steadily."""
        return self.eccentricity == 0.0

    def eccentric_anomaly(self, times: Floats) -> Floats:
        """E (...), rad, at ``times`` (...), growing through all revolutions, by Halley's method."""
        e = self.eccentricity
        begin = _eccentric(self.true_anomaly, e)
        mean = begin - e * math.sin(begin) + self.mean_motion * np.asarray(times, dtype=np.float64)
        if e == 0.0:
            return mean
        turns = 2.0 * math.pi * np.round(mean / (2.0 * math.pi))
        left = mean - turns
        # Between M and M + e lies the root for M > 0; this start leaves a handful of steps at any e <= 0.8.
        found = left + e * np.sin(left) / (1.0 - np.sin(left + e) + np.sin(left))
        for _ in range(_HALLEY_STEPS):
            sine, cosine = np.sin(found), np.cos(found)
            miss, slope = found - e * sine - left, 1.0 - e * cosine
            step = miss / (slope - 0.5 * e * sine * miss / slope)
            found = found - step
            if float(np.abs(step).max(initial=0.0)) < 1e-9:
                # The error of the next iterate is the cube of this one's.
                break
        out: Floats = found + turns
        return out

    def turned(self, times: Floats) -> Floats:
        """Turn of LVLH about z since t = 0, rad (...): nu(t) - nu(0)."""
        times = np.asarray(times, dtype=np.float64)
        if self.circular:
            return self.mean_motion * times
        e = self.eccentricity
        begin = _eccentric(self.true_anomaly, e)
        # nu - E = 2 atan(b sin E / (1 - b cos E)), b = e / (1 + sqrt(1 - e^2)): no jump anywhere.
        share = e / (1.0 + math.sqrt(1.0 - e * e))
        now = self.eccentric_anomaly(times)
        ahead = 2.0 * np.arctan(share * np.sin(now) / (1.0 - share * np.cos(now)))
        first = 2.0 * math.atan(share * math.sin(begin) / (1.0 - share * math.cos(begin)))
        out: Floats = (now - begin) + (ahead - first)
        return out

    def rate(self, times: Floats) -> Floats:
        """nu' (...), rad/s: n sqrt(1 - e^2) / (1 - e cos E)^2."""
        times = np.asarray(times, dtype=np.float64)
        if self.circular:
            return np.full(times.shape, self.mean_motion)
        e = self.eccentricity
        near = 1.0 - e * np.cos(self.eccentric_anomaly(times))
        out: Floats = self.mean_motion * math.sqrt(1.0 - e * e) / (near * near)
        return out

    def rate_bounds(self) -> tuple[float, float]:
        """Upper bounds on nu' (rad/s), its value at perigee, and on |nu''| (rad/s^2)."""
        e = self.eccentricity
        most = self.mean_motion * math.sqrt(1.0 - e * e) / (1.0 - e) ** 2
        # nu'' = -2 nu' e E' sin E / (1 - e cos E), E' = n / (1 - e cos E).
        return most, 2.0 * most * e * self.mean_motion / (1.0 - e) ** 2

    def turn_bounds(self) -> tuple[float, float, float, float]:
        """Bounds on the sizes of the first four derivatives of nu at all times, rad/s^k."""
        e = self.eccentricity
        most, _ = self.rate_bounds()
        # nu' = k^2 (1 + e cos nu)^2 is a function w of nu, a cosine polynomial; d/dt = w d/dnu.
        pace = self.mean_motion / (1.0 - e * e) ** 1.5
        a, b, c = (pace * (2.0 * e + e * e * 2.0 ** (j - 1)) for j in (1, 2, 3))
        snap = most * (a * a * a + 4.0 * most * a * b + most * most * c)
        return most, most * a, most * (a * a + most * b), snap

    def tide_bounds(self) -> tuple[float, float, float]:
        """Bounds on mu / r^3 = k^4 (1 + e cos nu)^3 and the sizes of its first two derivatives, 1/s^2 to 1/s^4."""
        e = self.eccentricity
        near, most = 1.0 + e, self.rate_bounds()[0]
        pace = self.mean_motion / (1.0 - e * e) ** 1.5
        slope = 3.0 * pace**2 * near**2 * e
        bend = 3.0 * pace**2 * (2.0 * near * e * e + near * near * e)
        # d/dt g = w g_nu, and once more w (w_nu g_nu + w g_nunu).
        change = pace * (2.0 * e + e * e)
        return pace**2 * near**3, most * slope, most * (change * slope + most * bend)

    def further_bounds(self) -> tuple[float, float]:
        """Bounds on the sizes of the fifth derivative of nu, rad/s^5, and the third of mu / r^3, 1/s^5."""
        e = self.eccentricity
        most, near = self.rate_bounds()[0], 1.0 + e
        pace = self.mean_motion / (1.0 - e * e) ** 1.5
        a, b, c, d = (pace * (2.0 * e + e * e * 2.0 ** (j - 1)) for j in (1, 2, 3, 4))
        turn = a**4 + 11.0 * most * a * a * b + 4.0 * (most * b) ** 2 + 7.0 * most**2 * a * c + most**3 * d
        slope = 3.0 * pace**2 * near**2 * e
        bend = 3.0 * pace**2 * (2.0 * near * e * e + near * near * e)
        twist = 3.0 * pace**2 * (2.0 * e**3 + 6.0 * near * e * e + near * near * e)
        tide = (a * a + most * b) * slope + 3.0 * most * a * bend + most * most * twist
        return most * turn, most * tide

    def pulls(self, times: Floats) -> tuple[Floats, Floats, Floats]:
        """nu' (rad/s), nu'' (rad/s^2) and mu / r^3 (1/s^2), each (...)."""
        w = self.rate(times)
        e = self.eccentricity
        if self.circular:
            return w, np.zeros(w.shape), w * w
        pace = self.mean_motion / (1.0 - e * e) ** 1.5
        rho = np.sqrt(w / pace)
        sine = np.sin(self.true_anomaly + self.turned(times))
        return w, -2.0 * pace * e * sine * rho * w, pace * pace * rho**3

    def rotation(self, times: Floats) -> Floats:
        """(..., 3, 3): inertial coordinates to LVLH coordinates."""
        return about_z(self.turned(times))


def about_z(angles: Floats) -> Floats:
    """(..., 3, 3): coordinates to those in axes turned about z by ``angles`` (...), rad."""
    out = np.zeros((*np.shape(angles), 3, 3))
    cosine, sine = np.cos(angles), np.sin(angles)
    out[..., 0, 0] = out[..., 1, 1] = cosine
    out[..., 0, 1], out[..., 1, 0], out[..., 2, 2] = sine, -sine, 1.0
    return out


def _eccentric(true_anomaly: float, e: float) -> float:
    """E of a true anomaly, both in the same revolution."""
    share = e / (1.0 + math.sqrt(1.0 - e * e))
    return true_anomaly - 2.0 * math.atan(
        share * math.sin(true_anomaly) / (1.0 + share * math.cos(true_anomaly))
    )
