"""Relative motion: how the chaser moves relative to the target.

The frame conventions stand only here: LVLH has x radial (outward), y along-track, z cross-track. States are
(x, y, z, vx, vy, vz) or, in the plane, (x, y, vx, vy); positions in metres, velocities in m/s. ``motion`` holds the
interfaces; every other file is one motion. :mod:`safestart.attitude` describes the target's turn.
"""
