"""Run hold-region: design, ellipsoid, polyhedron, flights from their boundary, picture."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from safestart.attitude.body_frame import rotation
from safestart.attitude.spin import Spin
from safestart.constraints.corridor import corridor_of
from safestart.control.hold.ellipsoid import Ellipsoid, ellipsoid
from safestart.control.hold.hold_lqr import Design, HoldLqr
from safestart.control.hold.loop import Hold
from safestart.control.hold.polyhedron import Polyhedron, polyhedron
from safestart.control.hold.turning_reference import TurningReference
from safestart.dynamics.cwh import Cwh
from safestart.model.scenario import Floats
from safestart.processes.base import ProcessOutput
from safestart.processes.hold_region.flown import summary
from safestart.processes.hold_region.plots import picture
from safestart.processes.hold_region.regime import regime, regime_document, regime_flights
from safestart.processes.hold_region.spec import HoldRegionInputs
from safestart.processes.plotting import npz
from safestart.runtime.progress import Context
from safestart.simulation.loop import fly
from safestart.simulation.plant import Plant

_AFTER = 15
_BEYOND = 1.02
_PARTS = 4


def run(inputs: HoldRegionInputs, context: Context) -> ProcessOutput:
    """Sets, flights, picture."""
    scenario = inputs.scenario()
    most, rate, n = scenario.chaser.max_acceleration, scenario.target.tumble_rate, scenario.target.mean_motion
    point = np.array([0.0, scenario.corridor.hold_radius + inputs.hold_clearance_m])
    design = Design.of(
        n, inputs.dt_s, inputs.position_scale_m, inputs.velocity_scale_m_s, inputs.thrust_scale_m_s2 or most
    )
    reference = TurningReference.of(point, rate, n, inputs.dt_s)
    hold = Hold.of(design, reference, corridor_of(scenario.corridor), most)
    phase = math.radians(inputs.phase_deg)
    inner = ellipsoid(hold)
    context.step(1, _PARTS, "ellipsoid")
    outer = polyhedron(hold, inner, phase)
    context.step(2, _PARTS, "polyhedron")
    own, kept = regime(inputs)
    context.step(3, _PARTS, "the controller's own hold")
    random = np.random.Generator(np.random.Philox(inputs.seed))
    flown = _flights(inputs, hold, inner, outer, phase, random)
    flown += regime_flights(inputs, own, kept, random)
    document: dict[str, Any] = {
        "code": "no_hold" if inner.level <= 0.0 else "ok" if outer is not None else "not_closed",
        "gain": design.gain.tolist(),
        "cost": design.cost.tolist(),
        "spectral_radius": float(np.abs(np.linalg.eigvals(design.closed_loop)).max()),
        "reference_thrust_m_s2": reference.most_thrust,
        "ellipsoid": None,
        "polyhedron": None,
        "regime": regime_document(own, kept),
        "flown": flown,
    }
    arrays: dict[str, Floats] = {}
    if inner.level > 0.0:
        document["ellipsoid"] = {
            "level": inner.level,
            "limited_by": inner.limited_by,
            "half_extents": inner.extents.tolist(),
            "volume_m4_s2": inner.volume,
        }
    if outer is not None:
        document["polyhedron"] = {
            "faces": len(outer.rows),
            "vertices": len(outer.vertices),
            "steps": outer.steps,
            "low": outer.vertices.min(axis=0).tolist(),
            "high": outer.vertices.max(axis=0).tolist(),
            "volume_m4_s2": outer.volume,
            "volume_ratio": outer.volume / inner.volume,
        }
        arrays = {
            "rows": outer.rows,
            "rows_body": outer.rows @ turning(rate, phase),
            "bounds": outer.bounds,
            "vertices": outer.vertices,
        }
    artifacts = [picture(inputs, hold, inner, outer, phase, own, kept)] if inner.level > 0.0 else []
    if arrays:
        artifacts.append(npz("hold_region.npz", arrays))
    context.step(_PARTS, _PARTS)
    return ProcessOutput(document, tuple(artifacts))


def turning(rate: float, phase: float) -> Floats:
    """(4, 4): an error of position and velocity as the turning body sees it, into the error in LVLH."""
    turn = rotation(phase)
    spin = rate * np.array([[0.0, -1.0], [1.0, 0.0]])
    return np.block([[turn, np.zeros((2, 2))], [turn @ spin, turn]])


def _flights(
    inputs: HoldRegionInputs,
    hold: Hold,
    inner: Ellipsoid,
    outer: Polyhedron | None,
    phase: float,
    random: np.random.Generator,
) -> list[dict[str, Any]]:
    out: list[dict[str, Any]] = []
    if inner.level <= 0.0 or inputs.flights == 0:
        return out
    sphere = random.standard_normal((inputs.flights, 4))
    sphere /= np.linalg.norm(sphere, axis=1)[:, None]
    shell = math.sqrt(inner.level) * sphere @ np.linalg.inv(np.linalg.cholesky(hold.cost))
    out.append(_flown("ellipsoid", hold, shell, random.uniform(0.0, 2.0 * math.pi, len(shell)), 40))
    if outer is None:
        return out
    chosen = outer.vertices[random.permutation(len(outer.vertices))[: inputs.flights]]
    angles = np.full(len(chosen), phase)
    out.append(_flown("polyhedron", hold, chosen, angles, outer.steps + _AFTER))
    out.append(_flown("beyond_polyhedron", hold, _BEYOND * chosen, angles, outer.steps + _AFTER))
    return out


def _flown(name: str, hold: Hold, errors: Floats, phases: Floats, steps: int) -> dict[str, Any]:
    """Fly each error in the loop, which watches the corridor at all times; held: no limit met."""
    records = []
    for error, phase in zip(errors, phases.tolist(), strict=True):
        state = hold.reference.at(phase)[0] + error
        plant = Plant(Cwh(hold.reference.mean_motion), Spin(hold.reference.rate, phase=phase))
        pilot = HoldLqr(hold.design, hold.reference, phase, hold.most)
        start = np.array([state[0], state[1], 0.0, state[2], state[3], 0.0])
        records.append(fly(plant, [hold.corridor], pilot, start, steps, hold.reference.step))
    return summary(name, records, hold.most)
