"""The three-regime controller's own hold: its set, and flights of the controller from the set's boundary."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from safestart.attitude.spin import Spin
from safestart.control.forecast import flight_plan
from safestart.control.gains import Gains, preset
from safestart.control.hold.ellipsoid import Ellipsoid, ellipsoid
from safestart.control.hold.regime_hold import RegimeHold
from safestart.control.three_regimes import ThreeRegimes
from safestart.dynamics.cwh import Cwh
from safestart.model.scenario import Scenario
from safestart.processes.hold_region.flown import summary
from safestart.processes.hold_region.spec import HoldRegionInputs
from safestart.simulation.loop import fly
from safestart.simulation.plant import Plant
from safestart.simulation.record import Record

_NODES = 6
"""Forecast of the filter, intervals: what every process flies."""
_STEPS, _EARLIER = 40, 60


def regime(inputs: HoldRegionInputs) -> tuple[RegimeHold, Ellipsoid | None]:
    """The loop, and its set where errors shrink."""
    own = RegimeHold.of(
        inputs.scenario(),
        _gains(inputs),
        inputs.dt_s,
        _NODES,
        inputs.position_scale_m,
        inputs.velocity_scale_m_s,
    )
    return own, ellipsoid(own) if own.stable else None


def _gains(inputs: HoldRegionInputs) -> Gains:
    return replace(preset(inputs.preset), hold_clearance=inputs.hold_clearance_m)


def regime_document(own: RegimeHold, kept: Ellipsoid | None) -> dict[str, Any]:
    """See :class:`RegimeOutput`."""
    place, _ = own.reference.between(0.0)
    there = kept is not None and kept.level > 0.0
    return {
        "code": "unstable" if kept is None else "ok" if there else "no_hold",
        "spectral_radius": own.spectral_radius,
        "level": kept.level if kept is not None else 0.0,
        "limited_by": kept.limited_by if kept is not None else None,
        "half_extents": kept.extents.tolist() if kept is not None and there else None,
        "settles_m": place.tolist() if kept is not None else None,
        "cost": own.cost.tolist() if there else None,
    }


def regime_flights(
    inputs: HoldRegionInputs, own: RegimeHold, kept: Ellipsoid | None, random: np.random.Generator
) -> list[dict[str, Any]]:
    """The controller itself, with its filter, from the boundary, at a few angles of the body."""
    if kept is None or kept.level <= 0.0 or inputs.flights == 0:
        return []
    scenario, step = inputs.scenario(), inputs.dt_s
    plan = flight_plan(scenario, _gains(inputs), step, _EARLIER + _STEPS, nodes=_NODES)
    sphere = random.standard_normal((inputs.flights, 6))
    sphere /= np.linalg.norm(sphere, axis=1)[:, None]
    shell = math.sqrt(kept.level) * sphere @ np.linalg.inv(np.linalg.cholesky(own.cost))
    records: list[Record] = []
    for error, first in zip(shell, random.integers(0, _EARLIER, len(shell)).tolist(), strict=True):
        angle = own.reference.rate * step * first
        x, y, vx, vy, *before = own.at(error, angle)
        pilot = ThreeRegimes(plan, first=first, before=np.array(before))
        start = np.array([x, y, 0.0, vx, vy, 0.0])
        records.append(fly(_plant(scenario, angle), [own.corridor], pilot, start, _STEPS, step))
    return [summary("regime", records, own.most, without_fallback=True)]


def _plant(scenario: Scenario, angle: float) -> Plant:
    target = scenario.target
    return Plant(Cwh(target.mean_motion), Spin(target.tumble_rate, phase=angle))
