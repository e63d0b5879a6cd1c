"""Pictures of hopping: the plan with free drifts coloured by the proof (Figs. 4, 6, 9), flights (Figs. 5, 7, 10)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from safestart.dynamics.cwh import transition_matrix
from safestart.hopping.approach import Approach, line
from safestart.hopping_flights.fly import HoppingFlight, World
from safestart.missed_burn.prove import Proof
from safestart.model.scenario import Floats
from safestart.processes.hopping.spec import HoppingInputs
from safestart.processes.plotting import drawn_as, figure

PROVED, UNPROVED = "#1B7F3B", "#C0392B"
_SAMPLES = 300


@drawn_as("plan.png")
def plan_picture(inputs: HoppingInputs, plan: Approach, proof: Proof) -> Figure:
    """Left: hops and the drift after each in the orbit plane. Right: the impulses."""
    drawing = figure(12.0, 5.2)
    plane, fuel = drawing.subplots(1, 2, width_ratios=(1.4, 1.0))
    kept = [finding for finding in proof.findings if finding.case.kind == "made"]
    drift = np.linspace(0.0, proof.question.horizon, _SAMPLES)
    matrices = np.array([transition_matrix(plan.mean_motion, float(t)) for t in drift])
    for hop, finding in zip(plan.hops, kept, strict=True):
        colour = PROVED if finding.least >= inputs.keep_out_m else UNPROVED
        path = matrices @ hop.left_with
        points = path[:, [1, 0]]
        drawn = LineCollection(
            list(np.stack([points[:-1], points[1:]], axis=1)), colors=colour, linewidths=1.0
        )
        drawn.set_alpha(np.linspace(0.6, 0.05, _SAMPLES - 1).tolist())
        plane.add_collection(drawn)
        times = np.linspace(0.0, hop.time, 60)
        flown = np.array([transition_matrix(plan.mean_motion, float(t)) @ hop.left_with for t in times])
        plane.plot(flown[:, 1], flown[:, 0], color="#1F4E9E", linewidth=1.6)
        plane.plot(hop.left_with[1], hop.left_with[0], "x", color="#222222", markersize=6, zorder=6)
    plane.plot([], [], color="#1F4E9E", label="hops")
    plane.plot([], [], color=PROVED, label="free drift, proved to keep out")
    plane.plot([], [], color=UNPROVED, label="free drift, not proved")
    _plane(plane, inputs)
    plane.set_title(f"{inputs.angle_deg:g} deg, {plan.orbits:.3f} orbits", fontsize=10)
    times = plan.times * plan.mean_motion / (2.0 * np.pi)
    width = 0.12 * float(np.diff(times).min())
    for axis, (name, colour) in enumerate((("radial", "#C46A1B"), ("along-track", "#1F4E9E"))):
        fuel.bar(times + (axis - 0.5) * width, plan.impulses[:, axis], width, color=colour, label=name)
    fuel.axhline(0.0, color="#666666", linewidth=0.8)
    fuel.set_xlabel("time [orbits]")
    fuel.set_ylabel("impulse, LVLH [m/s]")
    fuel.set_title(
        f"{plan.fuel_1norm:.3f} m/s in the 1-norm, {plan.fuel_2norm:.3f} in the 2-norm", fontsize=10
    )
    fuel.legend(fontsize=8)
    drawing.suptitle(
        f"Hopping approach, planned; drifts of {inputs.abort_orbits:g} orbits with errors of one sigma "
        f"({inputs.proof_model} motion)",
        fontsize=11,
    )
    return drawing


@drawn_as("flights.png")
def flights_picture(
    inputs: HoppingInputs, world: World, flights: Sequence[HoppingFlight], breach: dict[str, Any]
) -> Figure:
    """Left: approaches flown. Right: how near an abort after each hop would come."""
    drawing = figure(12.0, 5.2)
    plane, near = drawing.subplots(1, 2, width_ratios=(1.4, 1.0))
    for flight in flights:
        for k in range(len(flight.times) - 1):
            times = np.linspace(0.0, flight.times[k + 1] - flight.times[k], 40)
            path = _drift(world.mean_motion, flight.states[k], times)
            plane.plot(path[:, 1], path[:, 0], color="#1F4E9E", alpha=0.3, linewidth=0.7)
        plane.plot(flight.states[:, 1], flight.states[:, 0], ".", color="#222222", markersize=2)
    _plane(plane, inputs)
    plane.set_title(
        f"{len(flights)} of {inputs.runs} approaches (drawn with CWH between impulses)", fontsize=10
    )
    rng = np.random.default_rng(0)
    for flight in flights:
        hops = np.arange(1, world.hops + 1)
        entered = flight.closest[:-1] < world.keep_out
        place = hops + rng.uniform(-0.15, 0.15, world.hops)
        near.scatter(place, flight.closest[:-1], s=9, c=np.where(entered, UNPROVED, PROVED), alpha=0.7)
    near.axhline(world.keep_out, color="#8C2B1D", linewidth=1.0)
    near.set_yscale("log")
    near.set_xticks(range(1, world.hops + 1))
    near.set_xlabel("thrusters die after the impulse of hop")
    near.set_ylabel(f"least distance in {inputs.abort_orbits:g} orbits [m]")
    near.set_title("red: would enter the keep-out sphere", fontsize=10)
    drawing.suptitle(
        f"Hopping flown, barrier {inputs.barrier}: {100 * breach['probability']:.2f} % of approaches have an abort "
        f"that enters {inputs.keep_out_m:g} m (95 %: {100 * breach['low']:.2f} to {100 * breach['high']:.2f} %)",
        fontsize=11,
    )
    return drawing


def _drift(n: float, state: Floats, times: Floats) -> Floats:
    path: Floats = np.array([transition_matrix(n, float(t)) @ state for t in times])
    return path


def _plane(axes: Axes, inputs: HoppingInputs) -> None:
    """The orbit plane around line and target; the target flies to the left, the Earth is below."""
    end = inputs.start_m * line(inputs.angle_deg)
    axes.plot([0.0, end[1]], [0.0, end[0]], ":", color="#888888", linewidth=1.0, zorder=0)
    axes.add_patch(Circle((0.0, 0.0), inputs.keep_out_m, facecolor="#F6D5D0", edgecolor="#8C2B1D", zorder=1))
    axes.plot(0.0, 0.0, "s", color="#333333", markersize=4, zorder=5)
    low, high = np.minimum(end, 0.0), np.maximum(end, 0.0)
    room = 0.35 * inputs.start_m
    axes.set_aspect("equal")
    axes.set_xlim(high[1] + room, low[1] - room)
    axes.set_ylim(low[0] - room, high[0] + room)
    axes.set_xlabel("along-track y [m] (the target flies to the left)")
    axes.set_ylabel("radial x [m] (Earth below)")
    if axes.get_legend_handles_labels()[0]:
        axes.legend(fontsize=8, loc="best")
