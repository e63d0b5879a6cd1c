"""The nominal command: far approach, close approach and hold, by range and speed (paper 000, section 5.1)."""

from __future__ import annotations

import math
from typing import NamedTuple

from safestart.attitude.turn_kernel import into_body, out_of_body
from safestart.control.gains import Gains
from safestart.model.scenario import Scenario
from safestart.runtime.kernels.compiled import compiled

FAR, CLOSE, HOLD = 0, 1, 2
REGIMES = ("far", "close", "hold")
"""Names of the regime codes that :func:`nominal_command` returns."""


class Law(NamedTuple):
    """The numbers of the control law, as the compiled kernels take them (SI)."""

    mean_motion: float
    tumble_rate: float
    max_acceleration: float
    sync_radius: float
    hold_range: float
    hold_band: float
    switch_speed: float
    kp_far: float
    kd_far: float
    kp: float
    kd: float
    braking: float
    kp_hold: float
    kd_hold: float


def control_law(scenario: Scenario, gains: Gains, dt: float) -> Law:
    """Law of a scenario, with softer gains when the control interval ``dt`` (s) is too long for them.

    A command held for dt destabilises a PD loop unless kd dt + kp dt^2 / 2 < 2; the gains are scaled in time,
    kd to at most 1 / dt and kp with its square, which keeps the damping ratio.
    """

    def soften(kp: float, kd: float) -> tuple[float, float]:
        scale = min(1.0, 1.0 / (kd * dt))
        return kp * scale * scale, kd * scale

    return Law(
        scenario.target.mean_motion,
        scenario.target.tumble_rate,
        scenario.chaser.max_acceleration,
        scenario.sync_radius,
        scenario.corridor.hold_radius + gains.hold_clearance,
        gains.hold_band,
        gains.switch_speed,
        *soften(gains.kp_far, gains.kd_far),
        *soften(gains.kp, gains.kd),
        gains.braking_share * scenario.chaser.max_acceleration,
        *soften(gains.kp_hold, gains.kd_hold),
    )


@compiled(error_model="numpy")
def nominal_command(x, y, z, vx, vy, vz, time, cos, sin, r0, v_max, law):  # type: ignore[no-untyped-def]
    """Command (ax, ay, az) in LVLH, m/s^2, not limited, and the regime's code.

    State in LVLH (m, m/s), ``time`` since the start (s), ``cos`` and ``sin`` of theta = omega_t time, ``r0`` the
    range of the start (m), ``v_max`` the speed cap (m/s). All three regimes add the feedforward of eq. (6).

    - Far (r > r_sync): PD in LVLH on a spiral reference, a point on the corridor's axis that closes in from r0 at
      v_achv = min(a_max t / 2, v_max); the demanded velocity is limited to v_achv.
    - Close: PD in the body frame to the hold point, demanded velocity limited to v_max, with the exact Coriolis
      and centripetal terms of the rotating frame (the derivative of eq. 5).
    - Hold (range within the band about the hold point's, body-frame speed under v_switch): the same, stiffer and
      without limit.
    """
    n, omega = law.mean_motion, law.tumble_rate
    radius = math.sqrt(x * x + y * y + z * z)
    # eq. (6)
    fx = -(3.0 * n * n * x + 2.0 * n * vy)
    fy = 2.0 * n * vx
    fz = n * n * z
    if radius > law.sync_radius:
        speed = min(0.5 * law.max_acceleration * time, v_max)
        # The integral of min(a t / 2, v_max) from 0: (a t^2 / 4) up to the time at which the cap binds.
        ramp = min(time, 2.0 * v_max / law.max_acceleration)
        range_ = r0 - (0.25 * law.max_acceleration * ramp * ramp + v_max * (time - ramp))
        closing = speed
        if range_ < law.hold_range:
            range_, closing = law.hold_range, 0.0
        ratio = law.kp_far / law.kd_far
        # The reference in the body frame is (0, range_), moving with (0, -closing); eqs. (3) and (5).
        wx = -sin * -closing - cos * omega * range_ + ratio * (-sin * range_ - x)
        wy = cos * -closing - sin * omega * range_ + ratio * (cos * range_ - y)
        wz = -ratio * z
        length = math.sqrt(wx * wx + wy * wy + wz * wz)
        scale = speed / length if length > speed else 1.0
        kd = law.kd_far
        return kd * (scale * wx - vx) + fx, kd * (scale * wy - vy) + fy, kd * (scale * wz - vz) + fz, FAR
    # Body frame: p_B = R(-theta) p, v_B = R(-theta) v - omega x p_B.
    bx, by = into_body(cos, sin, x, y)
    ux, uy = into_body(cos, sin, vx, vy)
    ux, uy = ux + omega * by, uy - omega * bx
    ex, ey, ez = -bx, law.hold_range - by, -z
    regime = CLOSE
    if abs(radius - law.hold_range) <= law.hold_band and ux * ux + uy * uy + vz * vz < law.switch_speed**2:
        regime = HOLD
        dx = law.kp_hold * ex - law.kd_hold * ux
        dy = law.kp_hold * ey - law.kd_hold * uy
        dz = law.kp_hold * ez - law.kd_hold * vz
    else:
        ratio = law.kp / law.kd
        distance = math.sqrt(ex * ex + ey * ey + ez * ez)
        limit = v_max
        if law.braking > 0.0:
            limit = min(limit, math.sqrt(2.0 * law.braking * distance))
        scale = limit / distance if ratio * distance > limit else ratio
        dx = law.kd * (scale * ex - ux)
        dy = law.kd * (scale * ey - uy)
        dz = law.kd * (scale * ez - vz)
    # a = R(theta) (a_B + 2 omega x v_B + omega x (omega x p_B))
    dx -= 2.0 * omega * uy + omega * omega * bx
    dy += 2.0 * omega * ux - omega * omega * by
    ax, ay = out_of_body(cos, sin, dx, dy)
    return ax + fx, ay + fy, dz + fz, regime
