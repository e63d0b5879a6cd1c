"""How wrong the linear models are: CWH and Yamanaka-Ankersen beside two bodies with J2, drifts and false GOs.

``python -m benchmarks.model_error [STARTS]`` prints one JSON document. Drifts: distance (m) between the position of the
model and of the truth after a horizon, from rest in LVLH at a range along x and y. GOs: starts near the border of the
paper's corridor are decided by each model, and the history of each GO is flown in the truth: how many leave the
corridor, and how much of the promised margin the worst one lost. CWH takes the mean motion of the semi-major axis.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.asked import parser
from safestart.attitude.spin import Spin
from safestart.constraints.thrust_limit import ball
from safestart.dynamics.cwh import Cwh
from safestart.dynamics.two_body import TwoBodyFlight
from safestart.dynamics.yamanaka_ankersen import YamanakaAnkersen
from safestart.exact.answer import Verdict
from safestart.exact.space.decide import decide_in_space
from safestart.exact.space.question import SpaceQuestion, five_faces
from safestart.model.orbit import MU, KeplerOrbit
from safestart.model.scenario import CorridorShape, Floats

PERIGEE_M, INCLINATION = 6.778e6, math.radians(51.6)
ECCENTRICITIES, RANGES_M, HORIZONS_S = (0.0, 0.01, 0.1, 0.4, 0.73), (50.0, 200.0, 1000.0), (60.0, 300.0)
CORRIDOR = CorridorShape()


@dataclass(frozen=True)
class Truth:
    """The true target's orbit at ``orbit``'s start: what :class:`TwoBodyFlight` asks of an orbit."""

    orbit: KeplerOrbit

    def state(self) -> Floats:
        """Inertial position and velocity (6,) at t = 0."""
        e, nu = self.orbit.eccentricity, self.orbit.true_anomaly
        p = (MU / self.orbit.mean_motion**2) ** (1.0 / 3.0) * (1.0 - e * e)
        r, speed = p / (1.0 + e * math.cos(nu)), math.sqrt(MU / p)
        plane = np.array([[math.cos(nu), math.sin(nu)], [-math.sin(nu), math.cos(nu) + e]])
        plane *= np.array([[r], [speed]])
        ci, si = math.cos(INCLINATION), math.sin(INCLINATION)
        return np.concatenate([[x, y * ci, y * si] for x, y in plane])


def drifts(orbit: KeplerOrbit) -> list[dict[str, float]]:
    """Errors by range and horizon."""
    out = []
    for away in RANGES_M:
        for horizon in HORIZONS_S:
            state = np.array([away, away, 0.0, 0.0, 0.0, 0.0]) / math.sqrt(2.0)
            flight = TwoBodyFlight(Truth(orbit), state)  # type: ignore[arg-type]
            true = flight.fly(np.zeros(3), np.array([0.0, horizon]))[-1, :3]
            row = {"range_m": away, "horizon_s": horizon}
            for name, motion in (("cwh_m", Cwh(orbit.mean_motion)), ("yamanaka_m", YamanakaAnkersen(orbit))):
                row[name] = float(np.linalg.norm((motion.transition(0.0, horizon) @ state)[:3] - true))
            out.append(row)
    return out


def flown_margin(question: SpaceQuestion, orbit: KeplerOrbit, state: Floats, thrust: Floats) -> float:
    """Least distance (m) to a face over the flight of a history in the truth."""
    flight, dt = TwoBodyFlight(Truth(orbit), state), question.dt  # type: ignore[arg-type]
    least = math.inf
    for k, push in enumerate(thrust):
        times = dt * k + np.linspace(0.0, dt, 9)
        states = flight.fly(push, times)
        body = np.einsum("tij,tj->ti", question.attitude.rotation(times), states[:, :3])
        for face in question.faces:
            normal = np.array(face.normal)
            least = min(least, float(((face.offset - body @ normal) / np.linalg.norm(normal)).min()))
    return least


def false_gos(orbit: KeplerOrbit, starts: int) -> dict[str, dict[str, float]]:
    """GOs of each model, those that leave the corridor in the truth, and the largest loss of margin (m)."""
    rng = np.random.default_rng(15)
    spin, faces, limit = Spin(math.radians(2.0)), five_faces(CORRIDOR), ball(0.05)
    found = {name: {"go": 0.0, "false_go": 0.0, "worst_loss_m": 0.0} for name in ("cwh", "yamanaka")}
    for _ in range(starts):
        # About where the border of what can stay lies at this rate and thrust.
        y = rng.uniform(50.0, 76.0)
        state = np.array([rng.uniform(-0.3, 0.3) * y, y, rng.uniform(-0.3, 0.3) * y, 0.0, 0.0, 0.0])
        for name, used in (("cwh", KeplerOrbit(orbit.mean_motion)), ("yamanaka", orbit)):
            question = SpaceQuestion(used, spin, faces, limit, 2.0, 60)
            answer = decide_in_space(question, state)
            if answer.verdict is not Verdict.GO or answer.thrust is None:
                continue
            flown = flown_margin(question, orbit, state, answer.thrust)
            found[name]["go"] += 1
            found[name]["false_go"] += flown < 0.0
            found[name]["worst_loss_m"] = max(found[name]["worst_loss_m"], answer.lower - flown)
    return found


def study(starts: int) -> dict[str, Any]:
    """All eccentricities, at perigee."""
    out = {}
    for e in ECCENTRICITIES:
        orbit = KeplerOrbit.of(PERIGEE_M / (1.0 - e), e, 0.0)
        out[str(e)] = {"drifts": drifts(orbit), "verdicts": false_gos(orbit, starts)}
    return out


if __name__ == "__main__":
    asked = parser(__doc__)
    asked.add_argument("starts", nargs="?", type=int, default=8)
    given = asked.parse_args()
    print(json.dumps(study(given.starts), indent=1))
