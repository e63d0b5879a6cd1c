"""Relative motion and attitude.

Frame conventions, in this one place: LVLH has x radial (outward), y along-track, z cross-track; the body frame
of the target rotates about LVLH z at the tumble rate omega_t and coincides with LVLH at t = 0. States are
(x, y, z, vx, vy, vz) or, in the plane, (x, y, vx, vy). Positions in metres, velocities in m/s.
"""
