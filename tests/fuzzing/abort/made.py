"""One small document of every kind of missed-burn proof."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from safestart.missed_burn.document import document_of
from safestart.missed_burn.earth.motion import Earth
from safestart.missed_burn.plan import Burn, Errors, Failures, Plan, Question
from safestart.missed_burn.prove import prove
from safestart.missed_burn.zone import Zone

Document = dict[str, Any]
N, AXIS = 8.66e-4, 8.1e6
ERRORS = Errors((0.5, 0.4, 0.3), (1e-3, 2e-3, 1e-3), 0.01, 0.01)
FAILED = Failures(10.0, True, 3.0, 0.002, 0.05)
PLAN = Plan(
    N,
    (20.0, -300.0, 5.0, 0.0, -0.01, 0.0),
    (Burn(0.0, (0.05, 0.02, 0.0)), Burn(120.0, (-0.03, -0.02, 0.01))),
)
LONG = Plan(
    N,
    (20.0, -300.0, 5.0, 0.0, -0.01, 0.0),
    (Burn(0.0, (0.05, 0.02, 0.0), 4.0), Burn(60.0, (-0.03, -0.02, 0.01))),
)
ZONES = (
    Zone.sphere(15.0, (10.0, 20.0, 0.0)),
    Zone("ellipsoid", (0.0, 0.0, 0.0), ((30.0, 0.0, 0.0), (0.0, 10.0, 0.0), (0.0, 0.0, 5.0))),
    Zone("box", (0.0, 5.0, 0.0), ((5.0, 0.0, 0.0), (0.0, 20.0, 0.0), (0.0, 0.0, 4.0))),
)
ROUND = tuple(
    tuple(float(s) if i == j else 0.0 for i in range(6)) for j, s in enumerate([0.3] * 3 + [1e-3] * 3)
)


def _made(question: Question) -> Document:
    return document_of(prove(question))


MADE: dict[str, Callable[[], Document]] = {
    "abort-linear": lambda: _made(Question(PLAN, 50.0, 600.0, ERRORS, FAILED)),
    "abort-added": lambda: _made(
        Question(
            PLAN, 50.0, 400.0, Errors((0.5, 0.4, 0.3), (1e-3,) * 3, 0.01, 0.01, at_each_burn=False), FAILED
        )
    ),
    "abort-lasting": lambda: _made(
        Question(
            LONG,
            50.0,
            60.0,
            Errors((0.1,) * 3, (1e-4,) * 3, 0.01, 0.01, ellipsoid=ROUND),
            Failures(2.0, False, 0.0, 0.0, 0.05),
            zones=ZONES,
        )
    ),
    "abort-nonlinear": lambda: _made(Question(PLAN, 50.0, 300.0, ERRORS, FAILED, radius=AXIS)),
    "abort-earth": lambda: _made(
        Question(
            PLAN,
            50.0,
            60.0,
            ERRORS,
            Failures(0.0, True, 2.0, 0.002, 0.0),
            earth=Earth.of(PLAN, AXIS, 0.1, 1.0, 0.4, 0.3),
        )
    ),
}
