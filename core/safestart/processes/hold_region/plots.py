"""Picture of hold-region: start positions in the body frame, and errors of position against velocity."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from safestart.attitude.body_frame import rotation
from safestart.control.hold.ellipsoid import Ellipsoid
from safestart.control.hold.loop import Hold
from safestart.control.hold.polyhedron import Polyhedron
from safestart.control.hold.regime_hold import RegimeHold
from safestart.model.scenario import Floats
from safestart.processes.hold_region.spec import HoldRegionInputs
from safestart.processes.plotting import draw_corridor, drawn_as, figure
from safestart.sets.backward.polygon import box, cut, hull

_SMALL, _LARGE, _OWN = "#D55E00", "#0072B2", "#009E73"


@drawn_as("hold_region.png")
def picture(
    inputs: HoldRegionInputs,
    hold: Hold,
    inner: Ellipsoid,
    outer: Polyhedron | None,
    phase: float,
    own: RegimeHold,
    kept: Ellipsoid | None,
) -> Figure:
    """Left: where a start that turns with the reference may be. Right: the sets' shadows along x and y, LVLH."""
    drawing = figure(12.0, 5.0)
    place, radial, along = drawing.subplots(1, 3)
    back = rotation(-phase)
    point = np.array([0.0, inputs.corridor.r_h_m + inputs.hold_clearance_m])
    small, large = _section(hold, inner) @ back.T + point, None
    if outer is not None:
        # Velocity as the reference's: the section through velocity error 0.
        wide = 2.0 * float(np.abs(outer.vertices[:, :2]).max())
        whole = box(np.zeros(2), np.full(2, wide))
        lengths = np.linalg.norm(outer.rows[:, :2], axis=1)
        flat_rows = lengths > 0.0
        assert whole is not None
        flat = cut(
            whole,
            outer.rows[flat_rows, :2] / lengths[flat_rows, None],
            outer.bounds[flat_rows] / lengths[flat_rows],
        )
        large = None if flat is None else flat @ back.T + point
    top = max(float(one[:, 1].max()) for one in (small, large) if one is not None)
    draw_corridor(place, inputs.scenario().corridor, 1.3 * top)
    _ring(place, small, _SMALL, "ellipsoid")
    if large is not None:
        _ring(place, large, _LARGE, "polyhedron")
    place.plot(*point, marker="+", color="black", markersize=9)
    place.set_title("starts with the reference's velocity", fontsize=10)
    place.legend(fontsize=8, loc="lower right")
    inverse = np.linalg.inv(hold.cost)
    for axes, pair, name in ((radial, [0, 2], "x"), (along, [1, 3], "y")):
        root = np.linalg.cholesky(inner.level * inverse[np.ix_(pair, pair)])
        _ring(axes, _circle() @ root.T, _SMALL, "ellipsoid")
        if kept is not None and kept.level > 0.0:
            root = np.linalg.cholesky(kept.level * np.linalg.inv(own.cost)[np.ix_(pair, pair)])
            _ring(axes, _circle() @ root.T, _OWN, "the controller's own hold")
        if outer is not None:
            _ring(axes, hull(outer.vertices[:, pair]), _LARGE, "polyhedron")
        axes.set_xlabel(f"error of {name} [m]")
        axes.set_ylabel(f"error of v{name} [m/s]")
        axes.set_title(f"shadow on {name}, v{name} (LVLH)", fontsize=10)
        axes.legend(fontsize=8)
    drawing.suptitle(
        f"Hold region, {inputs.omega_t_deg_s:g} deg/s, {inputs.a_max_m_s2:g} m/s², body at {inputs.phase_deg:g} deg",
        fontsize=11,
    )
    return drawing


def _circle() -> Floats:
    angle = np.linspace(0.0, 2.0 * np.pi, 121)
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


def _section(hold: Hold, inner: Ellipsoid) -> Floats:
    """Outline of the ellipsoid at velocity error 0."""
    root = np.linalg.cholesky(hold.cost[:2, :2] / inner.level)
    return np.asarray(np.linalg.solve(root.T, _circle().T).T)


def _ring(axes: Axes, outline: Floats, colour: str, label: str) -> None:
    closed = np.concatenate([outline, outline[:1]])
    axes.plot(*closed.T, color=colour, linewidth=1.5, label=label)
