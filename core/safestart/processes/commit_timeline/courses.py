"""The courses, instants and corridors of a timeline, from its inputs; what no files can have is refused here.

Light to import: the service refuses by it what it can see before a job waits.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from typing import Any, TypeVar

import numpy as np

from safestart.attitude.spin import Spin
from safestart.constraints.thrust_limit import ThrustLimit
from safestart.errors import InvalidInput, Unavailable, invalid
from safestart.exact.space.question import five_faces
from safestart.interchange.attitude_course import AttitudeCourse
from safestart.interchange.covariance import Sense
from safestart.interchange.ephemeris import Ephemeris
from safestart.interchange.epochs import SECOND, Nanoseconds, epochs_of, text_of
from safestart.interchange.read import attitude_from, ephemeris_from
from safestart.processes.commit_timeline.spec import MOST_STEPS, CommitTimelineInputs
from safestart.timeline.encounter import Encounter
from safestart.timeline.verdicts import Corridor, Judge

_Read = TypeVar("_Read")


def require_possible(inputs: CommitTimelineInputs) -> None:
    """Raise ``InvalidInput`` for files, spans and corridors that no timeline can have.

    Where the packages that read files are missing, the worker looks.
    """
    try:
        judges_of(inputs, encounter_of(inputs)[0])
    except Unavailable:
        return


def judges_of(inputs: CommitTimelineInputs, encounter: Encounter) -> list[Judge]:
    """One for each corridor; raises ``InvalidInput`` for names that come twice."""
    names = [one.name for one in inputs.corridors]
    if len(set(names)) != len(names):
        raise invalid("corridors", "names that differ", names)
    thrust = ThrustLimit("ball", (inputs.a_max_m_s2,))
    corridors = [
        Corridor(
            one.name,
            _named(f"corridors.{k}.axis", five_faces, one.shape(), (one.axis[0], one.axis[1], one.axis[2])),
        )
        for k, one in enumerate(inputs.corridors)
    ]
    return [Judge(encounter, corridor, thrust) for corridor in corridors]


def encounter_of(inputs: CommitTimelineInputs) -> tuple[Encounter, Nanoseconds]:
    """The courses, and the instants step_s apart; raises ``InvalidInput`` under the field's name."""
    if (inputs.attitude is None) == (inputs.spin is None):
        raise invalid("attitude", "an attitude or a spin, and not both", "both" if inputs.spin else "neither")
    chaser = _named("chaser", _ephemeris, inputs.chaser, inputs.sense)
    target = _named("target", _ephemeris, inputs.target, inputs.sense)
    begin, end = max(chaser.epochs[0], target.epochs[0]), min(chaser.epochs[-1], target.epochs[-1])
    if inputs.start is not None:
        begin = _named("start", epochs_of, [inputs.start], "UTC")[0]
    if inputs.stop is not None:
        end = _named("stop", epochs_of, [inputs.stop], "UTC")[0]
    if end < begin:
        span = " .. ".join(text_of(np.array([begin, end]), "UTC"))
        raise invalid("stop", "a span in which both courses have states, its end after its begin", span)
    step = round(inputs.step_s * SECOND)
    count = int(end - begin) // step + 1
    if count > MOST_STEPS:
        raise invalid("step_s", f"at most {MOST_STEPS} instants", count)
    attitude: AttitudeCourse | Spin
    if inputs.attitude is not None:
        attitude = _named(
            "attitude", _of_the_target, _named("attitude", _attitude, inputs.attitude), chaser, target
        )
    else:
        assert inputs.spin is not None
        x, y, z = inputs.spin.axis
        rate, phase = math.radians(inputs.spin.rate_deg_s), math.radians(inputs.spin.phase_deg)
        attitude = _named("spin", Spin, rate, (x, y, z), phase)
    try:
        encounter = Encounter(chaser, target, attitude, int(begin), inputs.horizon_s, inputs.confidence)
    except InvalidInput as error:
        # The files' own words, at the input that they concern.
        field = error.field if error.field in CommitTimelineInputs.model_fields else "target"
        raise InvalidInput(
            error.detail, field=field, required=error.required, received=error.received
        ) from None
    return encounter, begin + step * np.arange(count, dtype=np.int64)


def _named(field: str, read: Callable[..., _Read], *arguments: Any) -> _Read:
    """What ``read`` returns; its errors are about ``field``."""
    try:
        return read(*arguments)
    except InvalidInput as error:
        raise InvalidInput(
            f"{field}: {error.detail}", field=field, required=error.required, received=error.received
        ) from None


def _of_the_target(attitude: AttitudeCourse, chaser: Ephemeris, target: Ephemeris) -> AttitudeCourse:
    """The attitude, unless its file is about the chaser and not about the target."""

    def is_of(course: Ephemeris) -> bool:
        pairs = ((attitude.name, course.name), (attitude.object_id, course.object_id))
        return any(one.casefold() == other.casefold() for one, other in pairs)

    if is_of(chaser) and not is_of(target):
        raise invalid(
            "OBJECT_NAME", f"the target's attitude ({target.name}, {target.object_id})", attitude.name
        )
    return attitude


@lru_cache(maxsize=4)
def _ephemeris(text: str, sense: Sense | None) -> Ephemeris:
    return ephemeris_from(text.encode(), "", sense)


@lru_cache(maxsize=2)
def _attitude(text: str) -> AttitudeCourse:
    return attitude_from(text.encode())
