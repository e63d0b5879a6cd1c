"""The tumbling target of paper 002, and the bounds of its torque-free motion."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from safestart.attitude.attitude import Attitude
from safestart.attitude.in_lvlh import InLvlh, Reference
from safestart.attitude.torque_free import Inertia, TorqueFree
from safestart.errors import invalid
from safestart.model.orbit import KeplerOrbit
from safestart.model.scenario import Floats

MAX_TURN = 1.0
"""Largest turn per step, rad; with larger turns, staying in the corridor at the nodes says little about the times
between."""


@dataclass(frozen=True)
class Tumble:
    """A torque-free body over a circular orbit; ``body_rate`` rad/s, body axes, against ``reference``.

    ``inertial``: includes LVLH's own turn. ``lvlh``: the body moves as if LVLH did not turn, the paper's (2)-(3).
    Raises ``InvalidInput`` as :class:`TorqueFree` and :class:`KeplerOrbit` do.
    """

    inertia: Inertia
    attitude_wxyz: tuple[float, float, float, float]
    body_rate: tuple[float, float, float]
    mean_motion: float
    reference: Reference = "inertial"
    body: TorqueFree = field(init=False, repr=False, compare=False)
    attitude: Attitude = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        body = TorqueFree(self.inertia, self.attitude_wxyz, self.body_rate)
        orbit = KeplerOrbit(self.mean_motion)
        object.__setattr__(self, "body", body)
        object.__setattr__(self, "attitude", body if self.reference == "lvlh" else InLvlh(body, orbit))

    def nodes(self, period: float, count: int) -> Floats:
        """Attitudes (count, 3, 3), LVLH to body, at 0, T, 2 T .. for T = ``period`` s."""
        return np.ascontiguousarray(self.attitude.rotation(period * np.arange(float(count))))

    def frame_turn(self, time: float) -> Floats:
        """LVLH coordinates to those ``time`` s later (3, 3); the identity where LVLH's own turn is left out."""
        if self.reference == "lvlh":
            return np.eye(3)
        return KeplerOrbit(self.mean_motion).rotation(np.asarray(time))

    def slow_enough(self, period: float) -> None:
        """Raise ``InvalidInput`` if the body turns by more than a radian in one step."""
        turn = self.attitude.rate_bounds()[0] * period
        if turn > MAX_TURN:
            raise invalid("period", f"a turn per step of at most {MAX_TURN:g} rad", f"{turn:.3g} rad")

    def changed(self, shares: Floats, spin: float = 1.0) -> Tumble:
        """The target with principal moments off by ``shares`` (3,), halved until a rigid body has them; rate x spin."""
        moments, axes = np.linalg.eigh(np.array(self.inertia))
        off = moments * (1.0 + shares)
        while off.min() <= 0.0 or 2.0 * off.max() > off.sum():
            shares = 0.5 * shares
            off = moments * (1.0 + shares)
        rows = axes @ np.diag(off) @ axes.T
        inertia = tuple(tuple(row) for row in (0.5 * (rows + rows.T)).tolist())
        x, y, z = (spin * w for w in self.body_rate)
        return Tumble(inertia, self.attitude_wxyz, (x, y, z), self.mean_motion, self.reference)  # type: ignore[arg-type]

    def principal(self) -> tuple[Floats, Floats]:
        """Principal moments (3,), rising, and the squares (3,) of the body rate along their axes at t = 0."""
        moments, axes = np.linalg.eigh(np.array(self.inertia))
        return moments, (axes.T @ np.array(self.body_rate)) ** 2

    def rates(self) -> tuple[float, float]:
        """The largest |omega| (rad/s) and |omega dot| (rad/s^2), exact for the torque-free motion.

        Along the polhode the squares of the three components are affine in each other (momentum and energy stay), so
        |omega|^2 is linear in one of them and |omega dot|^2 quadratic.
        """
        moments, squares = self.principal()
        i1, i2, i3 = (float(e) for e in moments)
        grown = 1.0 + 1e-12
        if i3 - i1 <= 1e-12 * i3:
            # A ball but for rounding: its energy bounds |omega|, Euler's equations |omega dot|.
            most = float(squares.sum()) * i3 / i1
            return grown * float(np.sqrt(most)), grown * most * (i3 - i1) / i1
        # The middle square is the free variable: w1^2 = s1 + b1 (q - s2), w3^2 = s3 + b3 (q - s2).
        s1, s2, s3 = (float(e) for e in squares)
        b1 = -i2 * (i3 - i2) / (i1 * (i3 - i1))
        b3 = -i2 * (i2 - i1) / (i3 * (i3 - i1))
        ends = [
            q for q, b in ((s2 - s1 / b1 if b1 else np.inf, b1), (s2 - s3 / b3 if b3 else np.inf, b3)) if b
        ]
        high = min(ends)
        first, third = np.array([b1, s1 - b1 * s2]), np.array([b3, s3 - b3 * s2])
        middle = np.array([1.0, 0.0])
        total = np.polyadd(np.polyadd(first, middle), third)
        turning: Floats = np.zeros(3)
        # Not polymul, which drops leading zeros: with two equal moments one of the squares stays.
        for (near, far), moment, gap in (
            ((middle, third), i1, i2 - i3),
            ((third, first), i2, i3 - i1),
            ((first, middle), i3, i1 - i2),
        ):
            turning = turning + (gap / moment) ** 2 * np.convolve(near, far)
        places = [0.0, high]
        if turning[0] != 0.0:
            places.append(float(np.clip(-0.5 * turning[1] / turning[0], 0.0, high)))
        return (
            grown * float(np.sqrt(max(np.polyval(total, places)))),
            grown * float(np.sqrt(max(0.0, *np.polyval(turning, places)))),
        )
