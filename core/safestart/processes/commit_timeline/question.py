"""The question of a timeline from its files: what no model can have is refused here, before a job waits for it."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from safestart.attitude.spin import Spin
from safestart.errors import invalid, named
from safestart.exact.space.question import Face, five_faces
from safestart.interchange.attitude_course import AttitudeCourse
from safestart.interchange.covariance import Sense
from safestart.interchange.ephemeris import Ephemeris
from safestart.interchange.epochs import SECOND, Nanoseconds, epochs_of, text_of
from safestart.interchange.read import attitude_from, ephemeris_from
from safestart.processes.commit_timeline.spec import MOST_STEPS, CommitTimelineInputs
from safestart.timeline.encounter import Encounter


def require_possible(inputs: CommitTimelineInputs) -> None:
    """Raise ``InvalidInput`` for files that say nothing, corridors that are none, spans without instants."""
    faces_of(inputs)
    encounter_of(inputs)


def faces_of(inputs: CommitTimelineInputs) -> list[tuple[str, tuple[Face, ...]]]:
    """Corridors by their names; raises ``InvalidInput`` for names that come twice."""
    names = [one.name for one in inputs.corridors]
    if len(set(names)) != len(names):
        raise invalid("corridors", "names that differ", names)
    return [
        (
            one.name,
            named(f"corridors.{k}.axis", five_faces, one.shape(), (one.axis[0], one.axis[1], one.axis[2])),
        )
        for k, one in enumerate(inputs.corridors)
    ]


def encounter_of(inputs: CommitTimelineInputs) -> tuple[Encounter, Nanoseconds]:
    """The courses, and the instants step_s apart; raises ``InvalidInput`` under the field's name."""
    if (inputs.attitude is None) == (inputs.spin is None):
        raise invalid("attitude", "an attitude or a spin, and not both", "both" if inputs.spin else "neither")
    chaser = named("chaser", _ephemeris, inputs.chaser, inputs.sense)
    target = named("target", _ephemeris, inputs.target, inputs.sense)
    begin, end = max(chaser.epochs[0], target.epochs[0]), min(chaser.epochs[-1], target.epochs[-1])
    if inputs.start is not None:
        begin = named("start", epochs_of, [inputs.start], "UTC")[0]
    if inputs.stop is not None:
        end = named("stop", epochs_of, [inputs.stop], "UTC")[0]
    if end < begin:
        span = " .. ".join(text_of(np.array([begin, end]), "UTC"))
        raise invalid("stop", "a span in which both courses have states, its end after its begin", span)
    step = round(inputs.step_s * SECOND)
    count = int(end - begin) // step + 1
    if count > MOST_STEPS:
        raise invalid("step_s", f"at most {MOST_STEPS} instants", count)
    attitude: AttitudeCourse | Spin
    if inputs.attitude is not None:
        attitude = named("attitude", _attitude, inputs.attitude)
    else:
        assert inputs.spin is not None
        x, y, z = inputs.spin.axis
        rate, phase = math.radians(inputs.spin.rate_deg_s), math.radians(inputs.spin.phase_deg)
        attitude = named("spin.axis", Spin, rate, (x, y, z), phase)
    encounter = Encounter(chaser, target, attitude, int(begin), inputs.horizon_s, inputs.confidence)
    return encounter, begin + step * np.arange(count, dtype=np.int64)


@lru_cache(maxsize=4)
def _ephemeris(text: str, sense: Sense | None) -> Ephemeris:
    return ephemeris_from(text.encode(), "", sense)


@lru_cache(maxsize=2)
def _attitude(text: str) -> AttitudeCourse:
    return attitude_from(text.encode())
