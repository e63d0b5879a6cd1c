"""Run hop-angles: sample the measure over all angles, close in on every crossing."""

from __future__ import annotations

from typing import Any

from safestart.hopping.approach import approach, mean_motion_of
from safestart.hopping.inverse import curve_of, greatest_angle
from safestart.processes.base import ProcessOutput
from safestart.processes.hop_angles.spec import WANTED, HopAnglesInputs
from safestart.runtime.progress import Context


def run(inputs: HopAnglesInputs, context: Context) -> ProcessOutput:
    """Raises ``InvalidInput`` for distances without hops."""
    n = mean_motion_of(inputs.semi_major_axis_m)
    hops = inputs.start_m, inputs.hold_m, inputs.hops, inputs.gamma
    wanted = next(name for name in WANTED if getattr(inputs, name) is not None)
    curve = curve_of(wanted.removesuffix("_m_s"), n, *hops)
    context.step(1, 2, "angles")

    def line_at(angle: float) -> dict[str, Any]:
        plan = approach(n, angle, *hops)
        return {
            "angle_deg": angle,
            "orbits": plan.orbits,
            "fuel_1norm_m_s": plan.fuel_1norm,
            "fuel_2norm_m_s": plan.fuel_2norm,
        }

    return ProcessOutput(
        {
            "wanted": wanted,
            "angles": [line_at(angle) for angle in curve.angles_for(getattr(inputs, wanted))],
            "greatest_angle_deg": greatest_angle(*hops),
            "least": min(curve.values),
            "greatest": max(curve.values),
            "curve": [
                {"angle_deg": angle, "value": value}
                for angle, value in zip(curve.angles, curve.values, strict=True)
            ],
        }
    )
