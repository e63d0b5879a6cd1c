"""Settings of the three-regime controller and its filter; the paper gives two weights and no gain."""

from __future__ import annotations

from dataclasses import dataclass, fields

from safestart.errors import invalid
from safestart.model.scenario import number


@dataclass(frozen=True, slots=True)
class Gains:
    """Gains, weights and bands; every default is the tuned preset's, with its reason in a comment.

    Raises ``InvalidInput`` for a value that is negative, not finite, or zero where a division needs it.
    """

    # Close approach, body-frame PD. Critically damped (kd = 2 sqrt(kp)), and kd dt = 0.8 at dt = 2 s: nearly the
    # fastest loop that a held command leaves well damped (the sampled loop needs kd dt + kp dt^2 / 2 < 2).
    kp: float = 0.04
    """Position gain of the close approach, 1/s^2."""
    kd: float = 0.4
    """Velocity gain of the close approach, 1/s."""

    # Far approach, LVLH PD on the spiral: the same loop, so that the handover at r_sync causes no jump in stiffness.
    kp_far: float = 0.04
    """Position gain of the far approach, 1/s^2."""
    kd_far: float = 0.4
    """Velocity gain of the far approach, 1/s."""

    # Hold: stiffer, still critically damped and inside the sampled loop's stability limit (kd dt = 1).
    kp_hold: float = 0.0625
    """Position gain of the hold, 1/s^2."""
    kd_hold: float = 0.5
    """Velocity gain of the hold, 1/s."""

    # Braking from v needs v^2 / (2 a_max): at c = 0.6 that is 0.18 r0, so most of the thrust stays free to build up the
    # co-rotation. At c = 1 it is r0 / 2, taken from the thrust disk that must also turn: the paper's false positives.
    # Without the second cap below, c = 0.5, 0.6, 0.7, 1 fly certified starts (2944 of 10 800 drawn, 60 s) with
    # precision 0.998, 0.994, 0.968, 0.776.
    closing_factor: float = 0.6
    """c of the speed cap v_max = c sqrt(a_max r0)."""
    # The PD alone demands a deceleration of v kp / kd, more than a_max at high speed; the flight then overshoots into
    # the corridor's tip. At c = 0.6 the cap lifts the precision over 60 s from 0.994 to 0.997, and the share of
    # certified starts still flying after 400 s from 0.60 to 0.83.
    braking_share: float = 0.25
    """Share of a_max that the close approach plans to brake with near the hold point; 0 switches this cap off."""

    effort_weight: float = 0.1
    """w_u of eq. (7), the paper's."""
    # The paper's 2.0 lets a command follow its demand with a time constant of two steps, most of the filter's
    # horizon; 0.2 still removes chatter and delays nothing.
    move_weight: float = 0.2
    """w_du of eq. (7)."""

    # About the distance that a face sweeps past the chaser between two checked instants near the hold point.
    corridor_margin: float = 0.05
    """epsilon_m of eq. (7), in the scaling of eq. (4) (metres on the hold plane)."""

    # The plane y = r_h is a face of the corridor: a hold point on it would be violated by any ripple.
    hold_clearance: float = 1.5
    """The hold point lies at (0, r_h + hold_clearance) in the body frame, metres."""
    hold_band: float = 1.0
    """Half-width epsilon of the hold band about the hold point's range, metres."""
    switch_speed: float = 0.1
    """v_switch, body-frame speed below which the hold law takes over, m/s."""

    # The two row families that the paper mentions and omits. Off when tuned: the hold plane implies the keep-out, and
    # the closing cap bounds the speed.
    keep_out_radius: float = 0.0
    """Radius of the single-step, linearised keep-out ball, metres; 0 switches the row off."""
    speed_limit: float = 0.0
    """Limit on each LVLH velocity component one step ahead, m/s; 0 switches the rows off."""

    disk_limit: float = 1.0
    """Length, in a_max, to which the projection after the solve cuts the command; from sqrt(3) on it cuts nothing."""

    def __post_init__(self) -> None:
        for item in fields(self):
            divisor = item.name in ("kd", "kd_far", "kd_hold", "disk_limit")
            number(item.name, getattr(self, item.name), 0.0, 1e6, open_low=divisor)


TUNED = Gains()

# A documented guess. The paper gives w_u = 0.1 and w_du = 2.0, states both optional row families, and describes no cap
# tied to the braking distance (c = 1). PD gains, bands and limits are our tuned ones, so that the presets differ only
# in the paper's own choices.
PAPER = Gains(closing_factor=1.0, braking_share=0.0, move_weight=2.0, keep_out_radius=0.5, speed_limit=5.0)

PRESETS = {"tuned": TUNED, "paper": PAPER}


def preset(name: str) -> Gains:
    """Return the gains called ``name``; raises ``InvalidInput`` with the known names otherwise."""
    if name not in PRESETS:
        raise invalid("preset", f"one of {', '.join(PRESETS)}", name)
    return PRESETS[name]
