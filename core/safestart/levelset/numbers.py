"""Codes that control the compiled kernels, and the memory that they may overrun."""

from __future__ import annotations

SLACK = 8
"""Values before the first block and behind the last."""
FIRST, ENO2, WENO3, ENO3, WENO5 = 0, 1, 2, 3, 4
EDGE, PERIODIC, EXTRAPOLATE, AWAY = 0, 1, 2, 3
FIXED, TUBE, ALWAYS = 0, 1, 2
LAX_FRIEDRICHS, GODUNOV = 0, 1
