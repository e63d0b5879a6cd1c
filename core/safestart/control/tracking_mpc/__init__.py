"""MPC for tracking a freely tumbling target (paper 002): a body-fixed artificial reference allows short horizons.

States are LVLH position and velocity; an impulse acts at the end of its step. The deviation e = x - x_e(theta) from an
equilibrium trajectory obeys the time-invariant HCW motion in LVLH, so everything but the attitude is constant.
"""
