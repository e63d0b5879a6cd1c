"""Convert the wire's rendezvous to the verifier's system, in metres and minutes."""

from __future__ import annotations

from safestart.passive_safety.gains import Bryson, Design
from safestart.passive_safety.model import NEWTON, Dynamics, System
from safestart.passive_safety.switching_guard import Guard
from safestart.processes.passive_safety.rendezvous import BrysonInput, RendezvousInputs

MINUTE = 60.0


def system_of(inputs: RendezvousInputs) -> System:
    """The switched system."""
    design = Design(_limits(inputs.mode_1), _limits(inputs.mode_2)) if inputs.gains == "bryson" else None
    return System(Dynamics(inputs.model), design, Guard(inputs.guard))


def _limits(given: BrysonInput) -> Bryson:
    return Bryson(
        (given.x_m, given.y_m), (given.vx_m_s * MINUTE, given.vy_m_s * MINUTE), given.thrust_n * NEWTON
    )
