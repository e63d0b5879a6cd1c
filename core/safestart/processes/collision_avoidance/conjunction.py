"""An encounter from a Conjunction Data Message, as a state that the game is asked about."""

from __future__ import annotations

from typing import Any

import numpy as np

from safestart.errors import InvalidInput, Unavailable, invalid
from safestart.interchange.ccsds.cdm import Encounter, encounter_of
from safestart.interchange.ccsds.message import message_of
from safestart.interchange.ephemeris import Ephemeris
from safestart.interchange.epochs import shortened, text_of
from safestart.interchange.frames import to_gcrf, turns_with_the_earth
from safestart.interchange.relative import Relative, covariance_in_lvlh, in_lvlh, lvlh_axes
from safestart.model.orbit import MU
from safestart.model.scenario import Floats
from safestart.processes.collision_avoidance.spec import CollisionAvoidanceInputs, ConjunctionInput

FURTHEST_M = 1e5
"""Beyond it the linear model of the game says nothing."""
LARGEST_ECCENTRICITY = 0.01
"""The game's orbit is circular: an ellipse turns LVLH ahead by at most 2 e n t."""
_AXES = [1, 0, 2, 4, 3, 5]
"""Tangential, radial, normal, as in the inputs' states."""


def require_possible(inputs: CollisionAvoidanceInputs) -> None:
    """Raise ``InvalidInput`` for a message that holds no encounter of the game.

    Where the packages that read XML and leap seconds are missing, the worker looks.
    """
    if inputs.conjunction is not None:
        try:
            seen(inputs.conjunction)
        except Unavailable:
            return


def asked(inputs: CollisionAvoidanceInputs) -> tuple[CollisionAvoidanceInputs, dict[str, Any] | None]:
    """The inputs with the encounter as their last state, in the other object's orbit, and what the message says."""
    if inputs.conjunction is None:
        return inputs, None
    found = seen(inputs.conjunction)
    more = {"states": [*inputs.states, found["state"]], "mean_motion_rad_s": found["mean_motion_rad_s"]}
    return inputs.model_copy(update=more), found


def seen(given: ConjunctionInput) -> dict[str, Any]:
    """The chaser's state ``before_s`` ahead of the closest approach, in the other object's LVLH, both coasting.

    Both fly back as two bodies. Raises ``InvalidInput``, also for an other object whose orbit is too eccentric for the
    game, and for objects that are then too far apart for it.
    """
    try:
        encounter = _read(given.cdm)
    except InvalidInput as error:
        raise InvalidInput(
            f"conjunction.cdm: {error.detail}",
            field="conjunction.cdm",
            required=error.required,
            received=error.received,
        ) from None
    pair = (encounter.first, encounter.second)
    chaser, other = pair if given.chaser == "OBJECT1" else pair[::-1]
    at_closest = [to_gcrf(one.frame, one.epochs, one.states)[0] for one in (chaser, other)]
    own, target = (_coasted(state, -given.before_s) for state in at_closest)
    axes, rates = lvlh_axes(target[None])
    state = in_lvlh(own[None], target[None], axes, rates)
    relative = Relative(other.epochs, state, axes, rates, target[None], np.ones(1, dtype=bool))
    eccentricity = float(relative.eccentricities()[0])
    if not eccentricity <= LARGEST_ECCENTRICITY:
        raise invalid(
            "conjunction.cdm",
            f"an orbit of {other.name} with an eccentricity of at most {LARGEST_ECCENTRICITY}",
            f"{eccentricity:.4g}",
        )
    if float(np.linalg.norm(state[0, :3])) > FURTHEST_M:
        raise invalid(
            "conjunction.before_s",
            f"objects at most {FURTHEST_M / 1e3:g} km apart then",
            f"{float(np.linalg.norm(state[0, :3])) / 1e3:.4g} km",
        )
    return {
        "chaser": chaser.name,
        "other": other.name,
        "closest_approach": shortened(text_of(chaser.epochs, "UTC")[0]),
        "miss_distance_m": encounter.miss_distance,
        "sigma_m": _sigmas((chaser, other), (at_closest[0], at_closest[1])),
        "mean_motion_rad_s": float(relative.mean_motions()[0]),
        "state": state[0, _AXES].tolist(),
    }


def _read(text: str) -> Encounter:
    message = message_of(text.encode())
    if message.kind != "CDM":
        raise invalid("file", "CDM", message.kind)
    # Only positions' variances are used, and those are the same in either sense.
    found = encounter_of(message, "inertial")
    if turns_with_the_earth(found.first.frame):
        raise invalid("REF_FRAME", "an inertial frame for states that are flown back", "ITRF")
    return found


def _sigmas(pair: tuple[Ephemeris, Ephemeris], states: tuple[Floats, Floats]) -> list[float]:
    """Standard deviations (3,) of the relative position at the closest approach, independent errors, m."""
    total = np.zeros((6, 6))
    for one, state in zip(pair, states, strict=True):
        total += covariance_in_lvlh(one.covariances[0], state, states[1], "inertial")
    found: list[float] = np.sqrt(np.diagonal(total))[_AXES[:3]].tolist()
    return found


def _coasted(state: Floats, seconds: float) -> Floats:
    """A state (6,), inertial, after ``seconds`` of two-body motion."""
    from scipy.integrate import solve_ivp

    def rates(_: float, now: Floats) -> Floats:
        pull: Floats = -MU * now[:3] / np.linalg.norm(now[:3]) ** 3
        return np.concatenate([now[3:], pull])

    flown = solve_ivp(rates, (0.0, seconds), state, method="DOP853", rtol=1e-13, atol=1e-9)
    out: Floats = flown.y[:, -1]
    return out
