"""The motions of a scenario, one entry each, the only place with facts about one. Importing this loads none of them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from safestart.errors import invalid
from safestart.model.orbit import EARTH_RADIUS, MU
from safestart.model.registry import by_name
from safestart.model.scenario import MAX_MEAN_MOTION, Target
from safestart.runtime.named import load

if TYPE_CHECKING:
    from safestart.dynamics.motion import Motion


@dataclass(frozen=True, slots=True)
class NamedMotion:
    """A motion that flights may ask for by name.

    ``text`` describes it on the wire. ``make`` names the function, ``module:function``, from the scenario's target to
    the motion. ``mean_motions`` (rad/s): the least and the greatest that it can have. ``note`` is said of it in every
    result, such as how far it is from CWH, of which verdicts speak.
    """

    name: str
    text: str
    make: str
    mean_motions: tuple[float, float] = (0.0, MAX_MEAN_MOTION)
    note: str = ""

    def of(self, target: Target) -> Motion:
        """The motion near ``target``; raises ``InvalidInput`` for a mean motion that it cannot have."""
        if not self.takes(target.mean_motion):
            raise invalid("mean_motion", self.required, target.mean_motion)
        made: Motion = load(self.make, f"make of motion {self.name}")(target)
        return made

    def takes(self, mean_motion: float) -> bool:
        """Whether it can have this mean motion, rad/s."""
        least, greatest = self.mean_motions
        return least <= mean_motion <= greatest

    @property
    def required(self) -> str:
        """What it requires of the mean motion, in words."""
        least, greatest = self.mean_motions
        return f"{least:g} to {greatest:g} rad/s for {self.name}"


CWH = "cwh"
"""The motion of the certificates and of every compiled flight."""

_ALL = (
    NamedMotion(CWH, "exact linear motion", "safestart.dynamics.cwh:cwh_of"),
    NamedMotion(
        "two_body_j2",
        "nonlinear two-body motion with J2 (DOP853)",
        "safestart.dynamics.two_body:two_body_of",
        # From beyond the Moon down to the Earth's surface.
        mean_motions=(1e-6, math.sqrt(MU / EARTH_RADIUS**3)),
        note="the truth differs by millimetres to centimetres",
    ),
)

MOTIONS = by_name("motions", _ALL, lambda one: one.name)
TEXTS = "; ".join(f"{one.name}: {one.text}" for one in _ALL)
"""All of them in words."""

if TYPE_CHECKING:
    MotionName = str
else:
    MotionName = Literal[tuple(MOTIONS)]
