"""Relative motion: how the chaser moves against the target.

Frame conventions, in this one place: LVLH has x radial (outward), y along-track, z cross-track. States are
(x, y, z, vx, vy, vz) or, in the plane, (x, y, vx, vy); positions in metres, velocities in m/s. ``motion`` holds the
interfaces; every other file is one motion. How the target turns is :mod:`safestart.attitude`.
"""
