"""Pictures of tracking-mpc: the path in LVLH (Fig. 4) and in the body, inputs (Fig. 5), the region."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import-untyped]

from safestart.model.scenario import Floats
from safestart.processes.base import Artifact
from safestart.processes.output import Undrawn
from safestart.processes.plotting import drawn_as, figure, npz
from safestart.processes.tracking_mpc.setup import Setup
from safestart.tracking.flight import TrackedFlight

_COLOURS = ("#0072B2", "#D55E00", "#009E73")
_PLAN, _WALL, _INK = "#CC79A7", "#888888", "#333333"


def pictures(setup: Setup, flight: TrackedFlight, document: dict[str, Any]) -> Iterator[Artifact | Undrawn]:
    """The pictures and arrays of a request."""
    if flight.plans:
        yield _path(setup, flight, np.array(document["predicted_body_m"]))
        yield _over_time(setup, flight)
        yield npz(
            "flight.npz",
            {
                "flight_time_s": np.array(document["time_s"]),
                "flight_body_m": flight.body,
                "lvlh_state": flight.states,
                "inputs_m_s": flight.inputs,
                "theta_m": np.array(document["thetas_m"]),
                "attitude": setup.attitudes[: len(flight.states)],
            },
        )
    if document["region"] is not None:
        yield _region(setup, document["region"])


@drawn_as("path.png")
def _path(setup: Setup, flight: TrackedFlight, predicted: Floats) -> Figure:
    drawing = figure(11.0, 5.4)
    lvlh: Any = drawing.add_subplot(1, 2, 1, projection="3d")
    body: Any = drawing.add_subplot(1, 2, 2, projection="3d")
    path = flight.states[:, :3]
    lvlh.plot(*path.T, color=_COLOURS[0], marker=".", markersize=4, label="flown")
    lvlh.plot(*path[0], "o", color=_COLOURS[0], markersize=7, label="start")
    lvlh.plot(0.0, 0.0, 0.0, "s", color=_INK, label="target")
    reach = float(np.abs(path).max())
    for index, colour in zip(_frames(len(path)), ("#BBBBBB", "#888888", "#444444"), strict=False):
        for axis, style in zip(setup.attitudes[index], ("-", "--", ":"), strict=True):
            lvlh.plot(*np.outer(0.5 * reach * axis, [0.0, 1.0]), color=colour, linestyle=style, linewidth=1.2)
    lvlh.set_title("LVLH; grey: body axes x (–), y (- -), z (···), darker with time", fontsize=9)
    _label(lvlh, "x radial [m]", "y along-track [m]", "z cross-track [m]", path)
    height = 1.1 * float(flight.body[:, 1].max()) + 0.2
    _prism(setup, body, height)
    body.plot(*flight.body.T, color=_COLOURS[0], marker=".", markersize=4, label="flown")
    body.plot(*predicted.T, color=_PLAN, linestyle="--", linewidth=1.2, label="first plan")
    theta = np.array([plan.theta for plan in flight.plans])
    body.plot(*theta.T, ".", color=_COLOURS[1], markersize=4, label="theta")
    body.plot(*flight.body[0], "o", color=_COLOURS[0], markersize=7)
    body.set_title("body frame, with the corridor", fontsize=9)
    _label(body, "x body [m]", "y body [m]", "z body [m]", None)
    for axes in (lvlh, body):
        axes.legend(fontsize=8, loc="upper left")
    return drawing


def _prism(setup: Setup, axes: Any, height: float) -> None:
    shape = setup.shape
    rings = []
    for y in (0.0, height):
        x, z = shape.x0 + y / shape.c_x, shape.z0 + y / shape.c_z
        rings.append([(-x, y, -z), (x, y, -z), (x, y, z), (-x, y, z)])
    near, far = rings
    sides = [[near[i], near[(i + 1) % 4], far[(i + 1) % 4], far[i]] for i in range(4)]
    axes.add_collection3d(
        Poly3DCollection([near, *sides], facecolor=_WALL, edgecolor=_WALL, alpha=0.12, linewidths=0.8)
    )


def _label(axes: Any, x: str, y: str, z: str, path: Floats | None) -> None:
    axes.set_xlabel(x, fontsize=8)
    axes.set_ylabel(y, fontsize=8)
    axes.set_zlabel(z, fontsize=8)
    axes.tick_params(labelsize=7)
    if path is not None:
        middle, half = 0.5 * (path.max(axis=0) + path.min(axis=0)), 0.55 * float(np.ptp(path, axis=0).max())
        for set_limits, centre in zip((axes.set_xlim, axes.set_ylim, axes.set_zlim), middle, strict=True):
            set_limits(centre - half, centre + half)
    axes.set_box_aspect((1, 1, 1))


def _frames(count: int) -> tuple[int, ...]:
    return tuple(dict.fromkeys((0, (count - 1) // 4, (count - 1) // 2)))


@drawn_as("over_time.png")
def _over_time(setup: Setup, flight: TrackedFlight) -> Figure:
    drawing = figure(10.4, 6.6)
    (inputs, ranges), (place, cost) = drawing.subplots(2, 2)
    period = setup.motion.period
    nodes = period * np.arange(len(flight.states))
    for axis, colour in enumerate(_COLOURS):
        inputs.stairs(flight.inputs[:, axis], nodes, baseline=None, color=colour, label=f"u{'xyz'[axis]}")
        place.plot(nodes, flight.body[:, axis], color=colour, label=f"{'xyz'[axis]}")
        theta = [plan.theta[axis] for plan in flight.plans]
        place.plot(nodes[:-1], theta, color=colour, linestyle=":", linewidth=1.0)
    for sign in (-1.0, 1.0):
        inputs.axhline(sign * setup.tuning.u_max, color=_WALL, linestyle="--", linewidth=1.0)
    inputs.set_ylabel("impulse, body axes [m/s]")
    place.set_ylabel("position (–) and theta (···), body [m]")
    ranges.semilogy(nodes, np.maximum(flight.ranges, 1e-12), color=_COLOURS[0], label="range")
    ranges.axhline(0.05, color=_WALL, linestyle="--", linewidth=0.8)
    ranges.axhline(0.01, color=_WALL, linestyle="--", linewidth=0.8)
    ranges.set_ylabel("range [m]; dashed: 5 cm, 1 cm")
    cost.semilogy(nodes[:-1], np.maximum([plan.cost for plan in flight.plans], 1e-15), color=_COLOURS[1])
    cost.set_ylabel("optimal cost V")
    for axes in (inputs, place):
        axes.legend(fontsize=8)
    for axes in (inputs, ranges, place, cost):
        _grid(axes)
    return drawing


def _grid(axes: Axes) -> None:
    axes.set_xlabel("t [s]")
    axes.grid(alpha=0.3)


@drawn_as("region.png")
def _region(setup: Setup, region: dict[str, Any]) -> Figure:
    drawing = figure(7.4, 5.4)
    axes = drawing.subplots()
    x, y = np.array(region["x_m"]), np.array(region["y_m"])
    taken, reached = np.array(region["mpct"]["mask"]), np.array(region["exact"]["mask"])
    top = float(y.max()) + 0.5
    half = [setup.shape.x0, setup.shape.x0 + top / setup.shape.c_x]
    axes.fill([-half[1], -half[0], half[0], half[1]], [top, 0, 0, top], facecolor="#F4F4F4", edgecolor=_WALL)
    for mask, colour, label in (
        (taken & reached, "#009E73", "the controller can take it"),
        (~taken & reached, "#56B4E9", "only another history can"),
        (~taken & ~reached, "#D55E00", "no history can"),
        (taken & ~reached, "#000000", "claimed against the exact answer"),
    ):
        if mask.any():
            axes.plot(
                x[mask], y[mask], "s", color=colour, markersize=4.5, label=f"{label}: {int(mask.sum())}"
            )
    axes.set_aspect("equal")
    axes.set_xlabel("x body [m]")
    axes.set_ylabel("y body [m]")
    axes.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=2)
    axes.set_title(
        f"starts at rest in LVLH, z = 0; N_c = {setup.tuning.n_c}, theta: {setup.tuning.theta_limit}",
        fontsize=10,
    )
    return drawing
