"""Run elliptic-start: certify, then look for the eccentricity of each start."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from safestart.closed_form.elliptic import EllipticScenario, certify_elliptic, largest_eccentricity
from safestart.model.orbit import EARTH_RADIUS, KeplerOrbit
from safestart.processes.base import ProcessOutput
from safestart.processes.elliptic_start.spec import EllipticStartInputs
from safestart.runtime.progress import Context


def run(inputs: EllipticStartInputs, context: Context) -> ProcessOutput:
    """Answers of all starts."""
    said = inputs.orbit
    orbit = KeplerOrbit.of(said.semi_major_axis_m, said.eccentricity, math.radians(said.true_anomaly_deg))
    scenario = EllipticScenario(
        math.radians(inputs.spin_deg_s),
        orbit.mean_motion,
        orbit.eccentricity,
        orbit.true_anomaly,
        inputs.a_max_m_s2,
        inputs.corridor.shape(),
    )
    points = np.array(inputs.points_m)
    found = certify_elliptic(scenario, points, inputs.rest)
    starts = []
    for k, point in enumerate(points):
        upper = largest_eccentricity(replace(scenario, eccentricity=0.0), point, inputs.rest)
        starts.append(
            {
                **dict(zip(("x_m", "y_m", "z_m"), point.tolist(), strict=True)),
                "verdict": "GO" if found.go[k] else "UNDECIDED",
                "margin_m": float(found.margin[k]),
                "binding": found.names[int(found.binding[k])],
                "certified_up_to_eccentricity": upper,
            }
        )
        context.step(k + 1, len(points))
    return ProcessOutput(
        {
            "decided_by": "certified",
            "starts": starts,
            "lvlh_rate_deg_s": math.degrees(scenario.lvlh_rate),
            "ground_eccentricity": 1.0 - EARTH_RADIUS / said.semi_major_axis_m,
        }
    )
