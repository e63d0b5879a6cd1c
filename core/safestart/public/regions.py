"""`region`: all starts at rest of an operating point at once, between two proved polygons."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from safestart.errors import invalid
from safestart.model.scenario import MAX_RANGE, Floats, Scenario, number
from safestart.public.shown import COLOURS, Shown
from safestart.public.starts import points_of, seconds

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike

_ROUNDING_M = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class Region(Shown):
    """Where a chaser at rest in LVLH may start: polygons in the body frame, metres, counter-clockwise.

    Every start inside ``inner_m`` (K, 2) is proved GO, every start of the corridor outside ``outer_m`` (L, 2) is proved
    NO_GO, for ``horizon_s`` seconds, up to y = ``y_max_m``. ``deepest_m`` (2,) is the start with the largest margin,
    ``deepest_margin_m`` that margin. Areas are in m².
    """

    scenario: Scenario
    horizon_s: float
    y_max_m: float
    inner_m: Floats
    outer_m: Floats
    inner_area_m2: float
    outer_area_m2: float
    deepest_m: Floats
    deepest_margin_m: float

    @classmethod
    def of(cls, scenario: Scenario, horizon_s: float, y_max_m: float, found: Mapping[str, Any]) -> Region:
        """The region from the outputs of process ``safe-region``."""
        return cls(
            scenario,
            horizon_s,
            y_max_m,
            np.array(found["inner_polygon_m"], dtype=np.float64).reshape(-1, 2),
            np.array(found["outer_polygon_m"], dtype=np.float64).reshape(-1, 2),
            float(found["inner_area_m2"]),
            float(found["outer_area_m2"]),
            np.array(found["deepest_start_m"], dtype=np.float64),
            float(found["deepest_margin_m"]),
        )

    def verdicts(self, points: ArrayLike) -> NDArray[np.str_]:
        """GO inside the inner polygon, NO_GO outside the outer one, else UNDECIDED, (...), for points (..., 2), metres.

        UNDECIDED within a nanometre of an edge and beyond ``y_max_m``. Raises ``InvalidInput`` for another shape.
        """
        given = points_of(points)
        if given.shape[-1] != 2:
            raise invalid("points", "last axis of length 2 (metres): a region is planar", given.shape)
        inside = _depth(self.inner_m, given) > _ROUNDING_M
        outside = (_depth(self.outer_m, given) < -_ROUNDING_M) & (given[..., 1] <= self.y_max_m)
        return np.where(inside, "GO", np.where(outside, "NO_GO", "UNDECIDED"))

    def facts(self) -> Mapping[str, object]:
        """Areas and the deepest start."""
        x, y = self.deepest_m.tolist()
        return {
            "area proved GO": f"{self.inner_area_m2:.6g} m²",
            "area outside of which NO_GO is proved": f"{self.outer_area_m2:.6g} m²",
            "largest margin": f"{self.deepest_margin_m:.4g} m at ({x:.4g}, {y:.4g}) m",
            "for": f"{self.horizon_s:g} s",
        }

    def columns(self) -> Mapping[str, Any]:
        """The corners of both polygons."""
        corners = np.concatenate([self.inner_m, self.outer_m])
        names = ["inner"] * len(self.inner_m) + ["outer"] * len(self.outer_m)
        return {"polygon": names, "x_m": corners[:, 0], "y_m": corners[:, 1]}

    def draw(self, axes: Axes) -> None:
        """Both polygons in the corridor."""
        from safestart.processes.plotting import draw_corridor

        draw_corridor(axes, self.scenario.corridor, self.y_max_m)
        if len(self.inner_m):
            axes.fill(*self.inner_m.T, color=COLOURS["GO"], alpha=0.35, label="proved GO", zorder=2)
        if len(self.outer_m):
            closed = np.concatenate([self.outer_m, self.outer_m[:1]])
            axes.plot(*closed.T, color=COLOURS["NO_GO"], linewidth=1.0, label="proved NO_GO beyond", zorder=3)
        axes.legend(loc="lower right")


def region(scenario: Scenario, *, horizon_s: float = 60.0, y_max_m: float = 150.0) -> Region:
    """The starts at rest in LVLH from which some thrust history stays for ``horizon_s`` seconds (docs/theory/atlas.md).

    The corridor is cut at ``y_max_m`` metres. The first call takes tenths of a second. Raises ``InvalidInput`` for a
    horizon that is not a multiple of 2 s up to 600 s, or a cut not beyond the hold plane.
    """
    from safestart.processes.safe_region.run import region_of
    from safestart.runtime.progress import Context

    horizon_s = seconds("horizon_s", horizon_s)
    y_max_m = number("y_max_m", y_max_m, scenario.corridor.hold_radius, MAX_RANGE / 2, open_low=True)
    return Region.of(scenario, horizon_s, y_max_m, region_of(scenario, horizon_s, y_max_m, Context()))


def _depth(polygon: Floats, points: Floats) -> Floats:
    """How far inside a convex polygon, counter-clockwise, points (..., 2) lie, metres; negative outside."""
    if len(polygon) < 3:
        return np.full(points.shape[:-1], -np.inf)
    along = np.roll(polygon, -1, axis=0) - polygon
    length = np.hypot(along[:, 0], along[:, 1])
    kept = length > _ROUNDING_M
    corner, along, length = polygon[kept], along[kept], length[kept]
    away = points[..., None, :] - corner
    cross = along[:, 0] * away[..., 1] - along[:, 1] * away[..., 0]
    return np.asarray((cross / length).min(axis=-1))
