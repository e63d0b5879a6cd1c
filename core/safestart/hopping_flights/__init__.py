"""Hopping approaches flown in the true motion, and what becomes of them when the thrusters die after a hop."""
