"""Pictures of the sets: unsafe slices, capture slices in the plane and in space, the escape modes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch, Rectangle

from safestart.collision_avoidance.bounds.certified import lower, upper
from safestart.collision_avoidance.capture import arrival_times
from safestart.collision_avoidance.encounters.escape import Escape
from safestart.collision_avoidance.encounters.slot import RECOVERY, Slot
from safestart.collision_avoidance.game import Game, Players
from safestart.collision_avoidance.tube import Tube
from safestart.levelset import ValueField
from safestart.model.scenario import Floats
from safestart.processes.collision_avoidance.captured import BEYOND, HALF_WIDTH_M, Captured
from safestart.processes.collision_avoidance.spec import CollisionAvoidanceInputs
from safestart.processes.plotting import drawn_as, figure

LOST, SAFE, OPEN, LINE = "#D55E00", "#0072B2", "#F0E442", "#333333"
_POINTS = 141


@dataclass(frozen=True, slots=True)
class Slice:
    """Positions over the lattice's box at one velocity: level-set value, and the certified bounds (None: not
    computed)."""

    velocity: tuple[float, float]
    axis: Floats
    raw: Floats
    above: Floats | None
    below: Floats | None


def slices(inputs: CollisionAvoidanceInputs, tube: Tube) -> list[Slice]:
    """One slice per requested velocity; slices outside the lattice's box are left out."""
    found = []
    axis = np.linspace(tube.lattice.low[0], tube.lattice.high[0], _POINTS)
    for vx, vy in inputs.slices_m_s:
        if max(abs(vx), abs(vy)) > tube.lattice.high[-1]:
            continue
        place = np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1)
        states = np.concatenate([place, np.broadcast_to([vx, vy], place.shape)], axis=-1)
        raw = ValueField(tube.lattice, tube.raw[-1]).value_at(states)
        above = below = None
        if tube.settings.players is Players.AVOID:
            above = upper(tube.game, states, tube.horizon_s)
            below = lower(tube.game, states, tube.horizon_s, goal_m=1e-6, effort=0)
        found.append(Slice((vx, vy), axis, raw, above, below))
    return found


@drawn_as("unsafe.png")
def unsafe_picture(inputs: CollisionAvoidanceInputs, drawn: Sequence[Slice], tube: Tube) -> Figure:
    """Where separation cannot be kept, by velocity: proved (filled) and by the level set alone (line)."""
    drawing = figure(0.6 + 4.3 * max(1, len(drawn)), 5.6)
    panels = drawing.subplots(1, max(1, len(drawn)), sharex=True, sharey=True, squeeze=False)[0]
    reach = max((_extent(one) for one in drawn), default=1.0)
    for axes, one in zip(panels, drawn, strict=False):
        x = one.axis
        if one.above is not None and one.below is not None:
            state = np.where(one.above <= 0.0, 2.0, np.where(one.below > 0.0, 0.0, 1.0))
            # Cells, not contours: no values lie between lost and safe.
            shades = ListedColormap(["white", OPEN, LOST])
            axes.pcolormesh(x, x, state.T, cmap=shades, vmin=0.0, vmax=2.0, alpha=0.55, shading="nearest")
        if np.isfinite(one.raw).all() and one.raw.min() < 0.0 < one.raw.max():
            axes.contour(x, x, one.raw.T, levels=[0.0], colors=LINE, linewidths=1.2)
        axes.add_patch(Circle((0, 0), inputs.keep_out_m, fill=False, edgecolor=LINE, linestyle="--"))
        vx, vy = one.velocity
        size = float(np.hypot(vx, vy))
        if size > 0.0:
            length = 0.28 * reach
            start = -0.93 * reach, 0.85 * reach if vy <= 0.0 else 0.5 * reach
            start = (start[0] + (length if vx < 0.0 else 0.0), start[1])
            end = (start[0] + length * vx / size, start[1] + length * vy / size)
            axes.annotate("", end, start, arrowprops={"arrowstyle": "-|>", "color": SAFE, "lw": 2})
        axes.set_title(f"relative velocity ({vx:g}, {vy:g}) m/s", fontsize=10)
        _frame(axes)
        axes.set_xlim(-reach, reach)
        axes.set_ylim(-reach, reach)
    panels[0].set_ylabel("y radial [m]")
    handles: list[Any] = [
        Line2D([], [], color=LINE, linestyle="--", label="keep-out distance"),
        Line2D([], [], color=LINE, label=f"level set ({tube.settings.accuracy})"),
    ]
    if tube.settings.players is Players.AVOID:
        handles += [
            Patch(color=LOST, alpha=0.55, label="proved lost"),
            Patch(color=OPEN, alpha=0.55, label="not proved either way"),
        ]
    drawing.legend(handles=handles, loc="outside lower center", ncol=len(handles), fontsize=9, frameon=False)
    what = "eq. (12) as printed: Player 1 seeks the disk" if inputs.players == "paper" else "unsafe set"
    drawing.suptitle(
        f"Positions of the {what} within {inputs.horizon_s:g} s (arrow: direction of motion)", fontsize=11
    )
    return drawing


def _extent(one: Slice) -> float:
    """Half-width of a picture that shows the whole region that is not safe."""
    unsafe = one.raw <= 0.0 if one.above is None else (one.above <= 0.0) | (one.raw <= 0.0)
    far = np.abs(one.axis)[unsafe.any(axis=0) | unsafe.any(axis=1)].max(initial=0.0)
    return float(min(1.5 * far, one.axis[-1]) or one.axis[-1])


@drawn_as("capture.png")
def capture_picture(inputs: CollisionAvoidanceInputs, taken: Captured) -> Figure:
    """Time to the recovery slot by position, with only a radial speed (Fig. 3)."""
    count = len(taken.times)
    drawing = figure(1.6 + 4.0 * count, 4.7)
    panels = drawing.subplots(1, count, sharex=True, sharey=True, squeeze=False)[0]
    arrived = taken.times[taken.times <= taken.horizon]
    levels = np.linspace(0.0, inputs.capture_horizon_s, 12)
    if arrived.size:
        least = 50.0 * np.floor(np.quantile(arrived, 0.01) / 50.0)
        levels = np.linspace(least, inputs.capture_horizon_s, 10)
    shown = None
    for axes, times, speed in zip(panels, taken.times, inputs.capture_radial_m_s, strict=True):
        axes.set_facecolor("#D9D9D9")
        if (times <= taken.horizon).any():
            flown = np.minimum(times.T, BEYOND * taken.horizon)
            shown = axes.contourf(taken.x, taken.y, flown, levels=levels, cmap="viridis_r", extend="min")
        slot = inputs.slot
        corner = (slot.x_m - slot.half_x_m, slot.y_m - slot.half_y_m)
        axes.add_patch(Rectangle(corner, 2 * slot.half_x_m, 2 * slot.half_y_m, color=LOST, zorder=4))
        axes.add_patch(Circle((0, 0), inputs.keep_out_m, fill=False, edgecolor=LINE, linestyle="--"))
        axes.set_title(f"radial speed {speed:g} m/s", fontsize=10)
        _frame(axes)
        axes.set_xlim(taken.x[0], taken.x[-1])
        axes.set_ylim(taken.y[0], taken.y[-1])
        axes.locator_params(nbins=5)
    panels[0].set_ylabel("y radial [m]")
    if shown is not None:
        drawing.colorbar(shown, ax=list(panels), shrink=0.85, format="%.0f").set_label("time to the slot [s]")
    drawing.suptitle(
        f"Capture set of the recovery slot (orange) in {inputs.capture_horizon_s:g} s, by flight; grey: not captured",
        fontsize=11,
    )
    return drawing


@drawn_as("capture_space.png")
def capture_space_picture(inputs: CollisionAvoidanceInputs, game: Game, slot: Slot) -> Figure:
    """Draw the capture set over positions and tangential speed (Fig. 4): outlines at some tangential speeds."""
    count = len(inputs.capture_radial_m_s)
    drawing = figure(0.8 + 4.4 * count, 4.8)
    x, y = (slot.centre[k] + np.linspace(-HALF_WIDTH_M, HALF_WIDTH_M, 41) for k in range(2))
    place = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
    speeds = np.linspace(-8.0, 8.0, 9)
    for index, radial in enumerate(inputs.capture_radial_m_s):
        axes: Any = drawing.add_subplot(1, count, index + 1, projection="3d")
        for speed in speeds:
            states = np.concatenate([place, np.broadcast_to([speed, radial], place.shape)], axis=-1)
            longest = BEYOND * inputs.capture_horizon_s
            times = arrival_times(game, slot, RECOVERY, states, longest).T
            left = inputs.capture_horizon_s - np.minimum(times, longest)
            if (left > 0.0).any():
                # A rim of uncaptured points closes the outlines at the picture's edge.
                rim = np.pad(left, 1, constant_values=-1e-3)
                wide = [np.concatenate([[v[0] - 1.0], v, [v[-1] + 1.0]]) for v in (x, y)]
                level: Any = {"zdir": "z", "offset": speed}
                axes.contourf(*wide, rim, levels=[0.0, longest], colors=[SAFE], alpha=0.25, **level)
                axes.contour(*wide, rim, levels=[0.0], colors=[SAFE], linewidths=1, **level)
        axes.set_xlim(x[0], x[-1])
        axes.set_ylim(y[0], y[-1])
        axes.set_zlim(speeds[0], speeds[-1])
        axes.set_xlabel("x [m]", fontsize=8)
        axes.set_ylabel("y [m]", fontsize=8)
        axes.set_zlabel("tangential speed [m/s]", fontsize=8)
        axes.tick_params(labelsize=7)
        axes.locator_params(nbins=4)
        axes.set_box_aspect(None, zoom=0.86)
        axes.set_title(f"radial speed {radial:g} m/s", fontsize=10)
    drawing.suptitle(
        f"Capture set within {inputs.capture_horizon_s:g} s at nine tangential speeds", fontsize=11
    )
    return drawing


@drawn_as("escape.png")
def escape_picture(escapes: Sequence[Escape], burn_s: float, orbit_s: float) -> Figure:
    """The four escape modes: the first minutes, and one orbit (Fig. 2)."""
    drawing = figure(11.0, 4.8)
    near, far = drawing.subplots(1, 2)
    colours = (SAFE, "#56B4E9", LOST, "#009E73")
    for one, colour in zip(escapes, colours, strict=True):
        y, x = one.path.states[:, 0], one.path.states[:, 1]
        early = one.path.times <= 0.1 * orbit_s
        near.plot(x[early], y[early], color=colour, label=one.mode.title)
        far.plot(x / 1000.0, y / 1000.0, color=colour)
        far.plot(x[-1] / 1000.0, y[-1] / 1000.0, marker="s", markersize=5, color=colour)
    for axes in (near, far):
        axes.plot(0.0, 0.0, marker="o", color=LINE, markersize=4)
        axes.grid(color="#E5E5E5")
        axes.axhline(0.0, color="#999999", linewidth=0.8, zorder=0)
        axes.axvline(0.0, color="#999999", linewidth=0.8, zorder=0)
    near.set_xlabel("x tangential [m]")
    near.set_ylabel("y radial [m]")
    near.set_title(f"first {0.1 * orbit_s / 60.0:.0f} min", fontsize=10)
    near.legend(fontsize=8)
    far.set_xlabel("x tangential [km]")
    far.set_ylabel("y radial [km]")
    far.set_title(f"{orbit_s / 60.0:.0f} min (one orbit); square: its end", fontsize=10)
    drawing.suptitle(f"Escape modes: {burn_s:g} s of full thrust from the dot, then free motion", fontsize=11)
    return drawing


def _frame(axes: Axes) -> None:
    axes.plot(0.0, 0.0, marker="s", color=LINE, markersize=3)
    axes.set_aspect("equal")
    axes.set_xlabel("x tangential [m]")
