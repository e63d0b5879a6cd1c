"""`fly`: the best flight from a start, or a controller's."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from safestart.control.controller import Controller
from safestart.errors import invalid
from safestart.model.scenario import Floats, Rest, Scenario, number
from safestart.processes.wire import DT_S
from safestart.public.decisions import Asked, asked_of, state_at_rest
from safestart.public.shown import COLOURS, Shown
from safestart.public.starts import point_of, rest_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike

    from safestart.attitude.attitude import Attitude
    from safestart.control.limited import Steering
    from safestart.public.controllers import Pilot
    from safestart.simulation.record import Record


@dataclass(frozen=True, slots=True, eq=False)
class Flight(Shown):
    """A flight as curves over K times.

    ``time_s`` (K,); ``body_m`` and ``lvlh_m`` (K, d), positions in metres; ``thrust_m_s2`` (K, d), LVLH, held from each
    time on; ``distance_m`` (K, F), to each of ``faces``, negative outside. ``closest_m`` is the least distance (of a
    controller's flight at all times, else along the curves), at ``closest_face`` and ``closest_s``. ``delta_v_m_s``.
    ``verdict`` is that of the exact question if it was asked, else None.
    """

    scenario: Scenario
    time_s: Floats
    body_m: Floats
    lvlh_m: Floats
    thrust_m_s2: Floats
    faces: tuple[str, ...]
    distance_m: Floats
    closest_m: float
    closest_face: str
    closest_s: float
    delta_v_m_s: float
    verdict: str | None

    @classmethod
    def of(cls, scenario: Scenario, found: Mapping[str, Any]) -> Flight:
        """The flight from the outputs of process ``flight``."""
        array = {name: np.array(found[name], dtype=np.float64) for name in _CURVES}
        return cls(
            scenario=scenario,
            faces=tuple(found["faces"]),
            closest_m=float(found["closest_m"]),
            closest_face=str(found["closest_face"]),
            closest_s=float(found["closest_s"]),
            delta_v_m_s=float(found["delta_v_m_s"]),
            verdict=str(found["verdict"]),
            **array,
        )

    @property
    def safe(self) -> bool:
        """True if no check found it outside the corridor."""
        return self.closest_m >= 0.0

    def facts(self) -> Mapping[str, object]:
        """Verdict, closest approach to a face, impulse."""
        return {
            **({} if self.verdict is None else {"verdict": self.verdict}),
            "closest": f"{self.closest_m:.4g} m to {self.closest_face} after {self.closest_s:.4g} s",
            "duration": f"{self.time_s[-1]:g} s",
            "delta-v": f"{self.delta_v_m_s:.4g} m/s",
        }

    def columns(self) -> Mapping[str, Any]:
        """One row for each time; vectors by axis, distances by face."""
        found: dict[str, Any] = {"time_s": self.time_s}
        for name in ("body_m", "lvlh_m", "thrust_m_s2"):
            stem, _, unit = name.partition("_")
            for axis, values in zip("xyz", getattr(self, name).T, strict=False):
                found[f"{stem}_{axis}_{unit}"] = values
        for face, values in zip(self.faces, self.distance_m.T, strict=True):
            found[f"distance_{face}_m"] = values
        return found

    def draw(self, axes: Axes) -> None:
        """The path in the body frame, in the corridor."""
        from safestart.processes.plotting import draw_corridor

        draw_corridor(axes, self.scenario.corridor, 1.2 * max(float(self.body_m[:, 1].max()), 10.0))
        colour = COLOURS["GO" if self.safe else "NO_GO"]
        axes.plot(self.body_m[:, 0], self.body_m[:, 1], color=colour, linewidth=1.2, zorder=3)
        axes.plot(*self.body_m[0, :2], marker="o", color=colour, zorder=4)


_CURVES = ("time_s", "body_m", "lvlh_m", "thrust_m_s2", "distance_m")


def fly(
    scenario: Scenario,
    start: ArrayLike,
    controller: Steering | Pilot | Literal["filter", "sequence"] | None = None,
    rest: Rest | str = Rest.LVLH,
    *,
    question: Asked = "stay",
    horizon_s: float = 60.0,
    within_s: float = 200.0,
    motion: str = "cwh",
    attitude: str = "spin",
    dt_s: float | None = None,
) -> Flight:
    """Fly from rest at ``start`` (2,) or (3,), body frame, metres.

    Without a ``controller``: the thrust history of the largest margin, as in `decide`. With one, ours by name or
    anything with ``command(k, state)``, which returns thrust (3,), LVLH, m/s²: a closed loop of ``horizon_s`` seconds
    with a command every ``dt_s`` (2 s, or the pilot's own), to its first violation, watched at all times. ``motion`` is
    a name in ``safestart.dynamics.registry`` (such as ``two_body_j2``), ``attitude`` one of ``ATTITUDES`` in
    ``safestart.simulation.plant``; with another attitude than ``spin`` the start has three coordinates and the
    controller is not one of ours. Raises ``InvalidInput`` for other inputs.
    """
    from safestart.processes.flight.run import best_flight

    point, rest = point_of(start), rest_of(rest)
    if controller is None:
        for name, value, only in (("motion", motion, "cwh"), ("attitude", attitude, "spin")):
            if value != only:
                raise invalid(name, f"{only}, without a controller", value)
        asked_of(question, horizon_s, within_s)
        return Flight.of(scenario, best_flight(scenario, point.tolist(), rest, question, horizon_s, within_s))
    if question != "stay":
        raise invalid("question", "stay, with a controller", question)
    return _closed_loop(scenario, point, controller, rest, horizon_s, motion, attitude, dt_s)


def _closed_loop(
    scenario: Scenario,
    point: Floats,
    controller: Steering | Pilot | Literal["filter", "sequence"],
    rest: Rest,
    horizon_s: float,
    motion: str,
    attitude: str,
    dt_s: float | None,
) -> Flight:
    from safestart.attitude.attitude import to_lvlh
    from safestart.constraints.corridor import corridor_of
    from safestart.control.limited import Limited
    from safestart.public.controllers import LONGEST, Pilot
    from safestart.public.controllers import controller as named
    from safestart.simulation.loop import fly as fly_loop
    from safestart.simulation.plant import plant_of
    from safestart.simulation.starts import steps_of

    d = len(point)
    plant = plant_of(scenario, motion, attitude)
    if not isinstance(controller, str) and not callable(getattr(controller, "command", None)):
        raise invalid("controller", "filter, sequence or an object with command(k, state)", controller)
    if attitude != "spin" and isinstance(controller, str | Pilot):
        raise invalid("attitude", "spin, which our controllers count on", attitude)
    if attitude != "spin" and d == 2:
        raise invalid("start", "shape (3,), as the attitude may leave the plane", point.shape)
    dt = number(
        "dt_s", getattr(controller, "dt_s", DT_S) if dt_s is None else dt_s, 0.0, LONGEST, open_low=True
    )
    steps = steps_of(number("horizon_s", horizon_s, 0.0, LONGEST, open_low=True), dt)
    pilot: Controller
    if isinstance(controller, str):
        pilot = named(controller, scenario, duration_s=horizon_s, dt_s=dt, spatial=d == 3)
    elif isinstance(controller, Pilot):
        pilot = controller
    else:
        pilot = Limited(controller, scenario.chaser.max_acceleration)
    made_for = getattr(pilot, "steps", steps), getattr(pilot, "dt_s", dt)
    if made_for[0] < steps or made_for[1] != dt:
        asked = f"one for {steps} intervals of {dt:g} s"
        raise invalid("controller", asked, f"{made_for[0]} of {made_for[1]:g} s")
    start = np.zeros(6)
    if attitude == "spin":
        flat = state_at_rest(scenario, point, rest)
        start[:d], start[3 : 3 + d] = flat[:d], flat[d:]
    else:
        start[:3] = point
        start = to_lvlh(plant.attitude, np.zeros(1), start[None])[0]
        start[3:] *= rest is Rest.BODY
    corridor = corridor_of(scenario.corridor, d)
    record = fly_loop(plant, [corridor], pilot, start, steps, dt)
    return _measured(scenario, d, plant.attitude, record, corridor.names)


def _measured(
    scenario: Scenario, d: int, attitude: Attitude, record: Record, faces: tuple[str, ...]
) -> Flight:
    from safestart.constraints.corridor import corridor_of

    path = record.paths[0]
    body = path.seen_from(attitude)[:, :d]
    corridor = corridor_of(scenario.corridor, d)
    distance: Floats = corridor.slack(body) / corridor.lengths
    when, face = np.unravel_index(int(np.argmin(distance)), distance.shape)
    last = path.thrust[-1:] if len(path.thrust) else np.zeros((1, 3))
    return Flight(
        scenario,
        path.times,
        body,
        path.states[:, :d],
        np.concatenate([path.thrust, last])[:, :d],
        faces,
        distance,
        float(record.margin[0]),
        faces[int(face)],
        float(path.times[when]),
        float(record.delta_v[0]),
        None,
    )
