"""One small document of every kind of proof in space."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from safestart.attitude.in_lvlh import InLvlh, torque_free
from safestart.attitude.spin import Spin
from safestart.attitude.table import Table
from safestart.constraints.thrust_limit import ThrustLimit, ball
from safestart.exact.question import Goal
from safestart.exact.space.decide import decide_in_space
from safestart.exact.space.demands.rules import Demands, FieldOfView, KeepOut, Plume
from safestart.exact.space.prove import proof_in_space
from safestart.exact.space.question import Face, SpaceQuestion, five_faces
from safestart.exact.space.start_box import decide_from_box
from safestart.exact.space.unknowns import Unknowns
from safestart.model.orbit import KeplerOrbit
from safestart.model.scenario import CorridorShape

Document = dict[str, Any]
ROUND, LONG = KeplerOrbit(1.1e-3), KeplerOrbit.of(9e6, 0.2, 0.5)
BODY = ((120.0, 2.0, -1.0), (2.0, 100.0, 3.0), (-1.0, 3.0, 60.0))
FACES = (*five_faces(CorridorShape(1.2, 0.7, 3.0, 2.0, 0.75)), Face("far", (0.3, 1.0, 0.2), 30.0, "lvlh"))
STEEP = Spin(0.06, (0.1, 0.2, 1.0), 0.05)
SIX = tuple((float(x), float(y), float(z)) for x, y, z in np.vstack([np.eye(3), -np.eye(3)]))
ARMS = ThrustLimit("thrusters", (0.05, 0.04, 0.05, 0.06, 0.05, 0.04), SIX, "body")
FREE, SLOW = (
    torque_free(BODY, (0.99, 0.01, -0.02, 0.03), (0.01, -0.02, 0.05), "inertial", orbit)
    for orbit in (LONG, ROUND)
)
TABLE = Table((0.0, 3.0, 9.0), ((1.0, 0.0, 0.0, 0.0), (0.99, 0.02, 0.0, 0.1), (0.95, 0.05, 0.02, 0.25)))


def _asked(**changes: Any) -> SpaceQuestion:
    parts: dict[str, Any] = {"orbit": ROUND, "attitude": STEEP, "faces": FACES, "thrust": ball(0.1)}
    return SpaceQuestion(**{**parts, "dt": 2.0, "steps": 3, **changes})


def _made(question: SpaceQuestion, *start: float, half: tuple[float, ...] | None = None) -> Document:
    state = np.array(start)
    if half is None and not question.unknowns:
        return proof_in_space(question, state, decide_in_space(question, state))
    wide = np.zeros(6) if half is None else np.array(half)
    answer = decide_from_box(question, state, wide)
    return proof_in_space(question, state, answer, None if half is None else wide)


_GOAL = Goal(1.0, 0.2, (0.0, 2.5, 0.0))
MADE: dict[str, Callable[[], Document]] = {
    "space-go": lambda: _made(_asked(attitude=FREE, orbit=LONG, steps=2), 1.0, 6.0, 0.5, 0.1, -0.2, 0.05),
    "space-no-go": lambda: _made(
        _asked(attitude=InLvlh(STEEP, LONG), orbit=LONG, thrust=ARMS, steps=2), 7.0, 6.0, 0.5, 0.6, 0.0, 0.05
    ),
    "space-table-go": lambda: _made(
        _asked(attitude=TABLE, thrust=ThrustLimit("box", (0.05, 0.06, 0.04), frame="body")),
        *(1.0, 6.0, 0.5, 0.1, -0.2, 0.05),
    ),
    "space-synchronize-go": lambda: _made(
        _asked(goal=_GOAL, speed_limit=1.0, steps=4), 0.2, 2.6, 0.1, -0.1, 0.02, 0.0
    ),
    "space-synchronize-no-go": lambda: _made(
        _asked(goal=_GOAL, steps=3, thrust=ball(0.05)), 0.5, 5.0, 0.1, 0.1, 0.0, 0.0
    ),
    "space-box-go": lambda: _made(
        _asked(), 1.0, 7.0, 0.5, 0.1, -0.2, 0.05, half=(0.2, 0.3, 0.0, 0.02, 0.0, 0.01)
    ),
    "space-box-no-go": lambda: _made(
        _asked(thrust=ball(0.02)), 9.0, 6.0, 0.5, 0.8, 0.0, 0.0, half=(0.2, 0.3, 0.0, 0.02, 0.0, 0.01)
    ),
    "space-members-go": lambda: _made(
        _asked(attitude=SLOW, unknowns=Unknowns(0.02, 1e-3, 0.01, 1e-3), steps=1, dt=4.0),
        *(1.0, 7.0, 0.5, 0.1, -0.2, 0.05),
        half=(0.1, 0.1, 0.0, 0.0, 0.0, 0.0),
    ),
    "space-members-no-go": lambda: _made(
        _asked(unknowns=Unknowns(0.02, 1e-3, 0.0, 1e-3), thrust=ball(0.02)), 9.0, 6.0, 0.5, 0.8, 0.0, 0.0
    ),
    "space-demands-go": lambda: _made(
        _asked(
            demands=Demands(
                (
                    KeepOut("panel", (4.0, 3.0, 0.0), (2.0,)),
                    KeepOut("arm", (-4.0, 6.0, 0.0), (1.0, 1.5, 1.0)),
                ),
                FieldOfView((0.0, -1.0, 0.0), math.radians(40.0)),
                Plume(math.radians(30.0), 20.0),
            )
        ),
        *(1.0, 9.0, 0.5, 0.0, -0.1, 0.05),
    ),
    "space-violated-no-go": lambda: _made(
        _asked(demands=Demands((KeepOut("panel", (1.0, 7.0, 0.0), (2.0,)),))), 1.0, 7.5, 0.5, 0.0, 0.0, 0.0
    ),
    "space-view-no-go": lambda: _made(
        _asked(demands=Demands(view=replace(FieldOfView((0.0, -1.0, 0.0), 0.3), axis=(1.0, 1.0, 0.0)))),
        *(1.0, 7.5, 0.5, 0.0, 0.0, 0.0),
    ),
}
