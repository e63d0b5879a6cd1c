"""Pictures of passive-safety: powered tubes (positions, velocities, thrust), drifts after an abort; their arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch, Polygon, Rectangle

from safestart.model.scenario import Floats
from safestart.passive_safety.flights.rk8_flights import simulate
from safestart.passive_safety.model import LOS_SLOPE, MAX_SPEED, MAX_THRUST, NEWTON, gain
from safestart.passive_safety.reach.passive import cell_positions, flow_steps, make_bins, prove_drift
from safestart.passive_safety.reach.reach_set import Reach
from safestart.passive_safety.reach.tube import Tube
from safestart.passive_safety.requirements import SPEED_FACES, SPEED_LIMITS
from safestart.passive_safety.switching_guard import FACE_LIMITS, FACES, GAP_GUARD, Guard
from safestart.passive_safety.verify import Verification, drift_sources
from safestart.processes.passive_safety.outlines import outlines
from safestart.processes.plotting import drawn_as, figure
from safestart.runtime.progress import Context

_FAR, _NEAR, _DRIFT, _BAD, _CONE = "#0072B2", "#009E73", "#CC79A7", "#D55E00", "#F0E442"


@drawn_as("tubes.png")
def powered_picture(answer: Verification) -> Figure:
    """Positions, positions near the target, velocities in mode 2, thrust over time."""
    reach = answer.reach
    drawing = figure(10.4, 8.0)
    (whole, close), (speed, force) = drawing.subplots(2, 2)
    for axes in (whole, close):
        frame(axes, answer.question.system.guard)
        _fill(axes, _nodes(reach.far, slice(0, 2)), _FAR)
        for branch in reach.branches:
            for tube in branch.tubes:
                _fill(axes, _nodes(tube, slice(0, 2)), _NEAR)
    whole.autoscale_view()
    whole.set_title("positions", fontsize=10)
    whole.legend(handles=_POWERED_LEGEND, fontsize=8, loc="best")
    close.set_xlim(-115, 15)
    close.set_ylim(-75, 75)
    close.set_title("positions near the target", fontsize=10)
    for branch in reach.branches:
        for tube in branch.tubes:
            _fill(speed, _nodes(tube, slice(2, 4)) / 60.0, _NEAR)
    limit = MAX_SPEED / 60.0
    speed.add_patch(Circle((0, 0), limit, fill=False, color="#333333", linestyle=":", label="true disc"))
    octagon = _ring(SPEED_FACES, SPEED_LIMITS / 60.0)
    speed.add_patch(
        Polygon(octagon, fill=False, edgecolor="#666666", linestyle="--", label="published octagon")
    )
    speed.legend(fontsize=8, loc="lower left")
    speed.autoscale_view()
    speed.set_aspect("equal")
    speed.set_xlabel("vx [m/s]")
    speed.set_ylabel("vy [m/s]")
    speed.set_title("velocities in mode 2; limits of 0.05 m/s", fontsize=10)
    _thrust(force, reach)
    system = answer.question.system
    gains = "published" if system.design is None else "own"
    drawing.suptitle(
        f"Reach tubes with the engines on: {system.dynamics.value} dynamics, {gains} gains, {system.guard.value}",
        fontsize=11,
    )
    return drawing


@drawn_as("after_abort.png")
def drift_picture(answers: Sequence[Verification]) -> Figure:
    """Positions after an abort, a row for each window: as a whole, and near the target's box."""
    drawing = figure(10.4, 0.4 + 4.4 * len(answers))
    for (whole, close), answer in zip(drawing.subplots(len(answers), 2, squeeze=False), answers, strict=True):
        _drift_row(whole, close, answer)
    until = answers[0].question.horizon
    drawing.suptitle(f"Where the chaser drifts after an abort, until {until:g} min", fontsize=11)
    return drawing


def _drift_row(whole: Axes, close: Axes, answer: Verification) -> None:
    question = answer.question
    box = question.box
    _guard(whole, question.system.guard)
    cells = _drifts(answer)
    for axes in (whole, close):
        _name(axes)
        for polygons, colour in cells:
            _fill(axes, polygons, colour, 0.35)
        axes.add_patch(
            Rectangle((-box, -box), 2 * box, 2 * box, fill=False, edgecolor="#000000", lw=1.5, zorder=5)
        )
    whole.plot(0.0, 0.0, marker="s", color="#333333", markersize=3, zorder=6)
    handles = list(_DRIFT_LEGEND)
    example = answer.findings["separation"].counter_example
    if example is not None:
        handles += _contact(close, answer, example)
    close.legend(handles=handles, fontsize=8, loc="upper right")
    whole.autoscale_view()
    whole.set_aspect("auto")
    close.set_xlim(-20 * box, 20 * box)
    close.set_ylim(-20 * box, 20 * box)
    close.set_aspect("equal")
    assert question.window is not None
    first, last = question.window
    when = f"at {first:g} min" if first == last else f"between {first:g} and {last:g} min"
    whole.set_title(f"abort {when}: all drifts", fontsize=10)
    verdict = answer.findings["separation"].verdict.value
    close.set_title(f"near the target, half-width {box:g} m: {verdict}", fontsize=10)


def arrays(answer: Verification) -> dict[str, Floats]:
    """Bounds per segment: times (n+1,) in min, state bounds (n, 4) in m and m/s, thrust bounds (n, 2) in N."""
    scale = np.array([1.0, 1.0, 1.0 / 60.0, 1.0 / 60.0])
    out: dict[str, Floats] = {}
    for name, tube in _named(answer.reach):
        rows = gain(tube.motion)
        out[f"{name}_time_min"] = tube.start + tube.step * np.arange(tube.steps + 1.0)
        out[f"{name}_upper"] = tube.upper(np.eye(4)) * scale
        out[f"{name}_lower"] = -tube.upper(-np.eye(4)) * scale
        out[f"{name}_thrust_n"] = np.maximum(tube.upper(rows), tube.upper(-rows)) / NEWTON
    return out


def _named(reach: Reach) -> list[tuple[str, Tube]]:
    named = [("mode1", reach.far)]
    for k, branch in enumerate(reach.branches):
        named += [(f"mode2_{k}_part{j}", tube) for j, tube in enumerate(branch.tubes)]
    return named


def _nodes(tube: Tube, part: slice) -> Floats:
    """Outlines of the hull of neighbouring nodes, as one zonotope per segment."""
    low, high = tube.centre[:-1, part], tube.centre[1:, part]
    first, last = tube.gens[:-1, :, part], tube.gens[1:, :, part]
    box = tube.bend[:, part] + 0.5 * np.abs(last - first).sum(axis=1)
    sweep = 0.5 * (high - low)[:, None, :]
    gens = np.concatenate([0.5 * (first + last), sweep, box[:, None, :] * np.eye(2)], axis=1)
    return outlines(0.5 * (low + high), gens)


def _drifts(answer: Verification) -> list[tuple[Floats, str]]:
    """Outlines of the cells of the proof, with their colours."""
    question = answer.question
    assert question.window is not None
    steps = flow_steps(question.horizon)
    cells: list[tuple[Floats, str]] = []
    for tube, clock, level in drift_sources(answer.reach):
        ends = question.window, question.horizon, question.box
        leaves = prove_drift(tube, clock, *ends, level, Context()).leaves
        for kind in np.unique(leaves[:, [0, 1, 4]], axis=0):
            own = leaves[(leaves[:, [0, 1, 4]] == kind).all(axis=1)]
            blocks, pick = np.unique(own[:, 2], return_inverse=True)
            bins = make_bins(tube, clock, int(kind[0]), blocks)
            centre, gens, box = cell_positions(bins, pick, int(kind[1]), own[:, 3], steps)
            shapes = outlines(centre, np.concatenate([gens, box[:, None, :] * np.eye(2)], axis=1))
            cells.append((shapes, _DRIFT if kind[2] else _BAD))
    return cells


def _contact(axes: Axes, answer: Verification, example: Mapping[str, Any]) -> list[Line2D]:
    """The drift of a counter-example, from its abort to its contact, and its handles for the legend."""
    times = np.linspace(example["abort_min"], example["contact_min"], 200)
    start, abort = np.array([example["start"]]), np.array([example["abort_min"]])
    states, _ = simulate(answer.question.system, start, abort, times[None, :])
    path = axes.plot(*states[0, :, :2].T, color=_BAD, lw=1.5, zorder=7, label="counter-example")
    return path + axes.plot(
        *states[0, -1, :2], "x", color=_BAD, markersize=9, zorder=8, ls="", label="contact"
    )


def _thrust(axes: Axes, reach: Reach) -> None:
    """Over the time since the mode began, because the thrust changes only in the first minutes of each mode."""
    for name, tube in _named(reach):
        near = name != "mode1"
        times = tube.start + tube.step * np.arange(tube.steps)
        rows = gain(tube.motion)
        for axis, alpha in ((0, 0.6), (1, 0.3)):
            upper = tube.upper(-rows)[:, axis] / NEWTON
            lower = -tube.upper(rows)[:, axis] / NEWTON
            colour = _NEAR if near else _FAR
            first = tube.start == 0.0 and name in ("mode1", "mode2_0_part0")
            label = f"mode {1 + near}, F{'xy'[axis]}" if first else None
            axes.fill_between(
                times, lower, upper, color=colour, alpha=alpha, linewidth=0.8, label=label, step="post"
            )
    for limit in (-MAX_THRUST, MAX_THRUST):
        axes.axhline(limit / NEWTON, color="#333333", linestyle=":")
    axes.set_xscale("symlog", linthresh=0.1)
    axes.set_xlim(0.0, None)
    axes.legend(fontsize=8, loc="lower right")
    axes.set_xlabel("time since the mode began [min]")
    axes.set_ylabel("thrust per axis [N]")
    axes.set_title("thrust; limit 10 N", fontsize=10)


def frame(axes: Axes, guard: Guard) -> None:
    """Guard, line-of-sight cone, target and the names of the axes."""
    _guard(axes, guard)
    cone = [(0, 0), (-100, -100 * LOS_SLOPE), (-100, 100 * LOS_SLOPE)]
    axes.add_patch(Polygon(cone, color=_CONE, alpha=0.35, zorder=0))
    axes.plot(0.0, 0.0, marker="s", color="#333333", markersize=3, zorder=6)
    axes.set_aspect("equal")
    _name(axes)


def _name(axes: Axes) -> None:
    axes.set_xlabel("x radial [m]")
    axes.set_ylabel("y along-track [m]")


def _guard(axes: Axes, guard: Guard) -> None:
    shape: Patch = Circle((0, 0), GAP_GUARD) if guard is Guard.CIRCLE else Polygon(_ring(FACES, FACE_LIMITS))
    shape.set(fill=False, edgecolor="#666666", linestyle="--")
    axes.add_patch(shape)


def _ring(faces: Floats, limits: Floats) -> Floats:
    """Corners (8, 2) of an octagon in order."""
    order = np.array([0, 4, 2, 7, 1, 5, 3, 6])
    pairs = np.stack([order, np.roll(order, -1)], axis=1)
    corners: Floats = np.linalg.solve(faces[pairs], limits[pairs][..., None])[..., 0]
    return corners


_POWERED_LEGEND = (
    Patch(color=_FAR, alpha=0.6, label="mode 1"),
    Patch(color=_NEAR, alpha=0.6, label="mode 2"),
    Patch(color=_CONE, alpha=0.35, label="line-of-sight cone"),
    Line2D([], [], color="#666666", ls="--", label="guard: mode 2 begins"),
)
_DRIFT_LEGEND = (
    Patch(color=_DRIFT, alpha=0.6, label="proved apart"),
    Patch(color=_BAD, alpha=0.6, label="not proved"),
    Line2D([], [], color="#000000", label="target's box"),
)


def _fill(axes: Axes, polygons: Floats, colour: str, alpha: float = 0.6) -> None:
    axes.add_collection(
        PolyCollection(list(polygons), facecolors=colour, edgecolors="none", alpha=alpha), autolim=True
    )
