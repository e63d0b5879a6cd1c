"""The turns of :mod:`safestart.attitude.body_frame`, for compiled kernels: the same text, compiled."""

from __future__ import annotations

from safestart.attitude import body_frame
from safestart.runtime.kernels.compiled import compiled

into_body = compiled(error_model="numpy")(body_frame.into_body)
"""R_z(-theta) (x, y) from (cos, sin, x, y): LVLH coordinates to body coordinates."""

out_of_body = compiled(error_model="numpy")(body_frame.out_of_body)
"""R_z(theta) (x, y) from (cos, sin, x, y): body coordinates to LVLH coordinates."""
