"""The exact question of a request, and its answer in a sentence."""

from __future__ import annotations

from dataclasses import replace

from safestart.errors import InvalidInput, invalid
from safestart.exact.answer import Answer, Verdict
from safestart.exact.question import SPEED_SCALE, Goal, Question
from safestart.exact.space.question import SpaceQuestion
from safestart.processes.go_no_go.spec import GoNoGoInputs
from safestart.processes.wire import DT_S

_WIRE = {"keep_out": "keep_out_m", "hold": "hold_x_m, hold_y_m, hold_z_m", "speed_limit": "speed_limit_m_s"}
_NO_STAY = "a thrust history arrives at rest, but nothing proves that the chaser can stay there"


def question_of(inputs: GoNoGoInputs, dimensions: int) -> Question:
    """The question for planar or spatial starts; raises ``InvalidInput`` under the field's name on the wire."""
    goal, span = None, inputs.horizon_s
    if inputs.question == "synchronize":
        y = inputs.corridor.r_h_m if inputs.hold_y_m is None else inputs.hold_y_m
        hold = (inputs.hold_x_m, y, inputs.hold_z_m)[:dimensions]
        goal, span = Goal(inputs.ball_radius_m, inputs.rest_speed_m_s, hold), inputs.within_s
    steps = round(span / DT_S)
    try:
        return Question(
            inputs.scenario(), DT_S, steps, dimensions, goal, inputs.speed_limit_m_s, inputs.keep_out_m
        )
    except InvalidInput as error:
        field = str(error.field)
        raise invalid(_WIRE.get(field, field), str(error.required), error.received) from None


def with_arrival(question: Question, answers: list[Answer]) -> list[Answer]:
    """GOs of `synchronize` of which nothing proves that the chaser stays after its end become UNDECIDED."""
    if question.goal is None:
        return answers
    return [
        replace(answer, verdict=Verdict.UNDECIDED, reason=_NO_STAY)
        if answer.verdict is Verdict.GO and answer.arrival is None
        else answer
        for answer in answers
    ]


def sentence(question: Question, answer: Answer) -> str:
    """The verdict in words."""
    return told(question, answer) + (
        "; the hold plane implies the keep-out radius" if question.keep_out > 0.0 else ""
    )


def told(question: Question | SpaceQuestion, answer: Answer) -> str:
    """The verdict in words, without the keep-out radius."""
    if answer.verdict is Verdict.UNDECIDED:
        return f"undecided: {answer.reason}; margin between {answer.lower:.3g} and {answer.upper:.3g} m"
    span, spare, short = question.horizon, f"{answer.lower:.2f} m", f"{-answer.upper:.2f} m"
    fast = "" if question.speed_limit is None else f" at no more than {question.speed_limit:g} m/s"
    if question.plain:
        return (
            f"a thrust history keeps {spare} to every face for {span:g} s"
            if answer.verdict is Verdict.GO
            else f"no thrust {held(question)} stays for {span:g} s: each history is at some time at least {short} "
            "outside a face"
        )
    scales = f" (1 m/s of the speed limit counts as {SPEED_SCALE:g} m)" if fast else ""
    if answer.verdict is Verdict.GO and answer.thrust is not None:
        flown = len(answer.thrust) * question.dt
        done = "is at rest in the hold ball after" if question.goal is not None else "stays for"
        told = f"a thrust history{fast} {done} {flown:g} s, with {spare} to spare{scales}"
        if question.goal is None:
            return told
        if answer.arrival is None:
            return f"{told}; that it can stay there is not proved"
        return (
            f"{told}; then it stops in {answer.arrival.stop:.2g} s and stands for ever, at least "
            f"{answer.arrival.margin:.2f} m from every face"
        )
    asked = "is at rest in the hold ball within" if question.goal is not None else "stays for"
    told = f"no thrust {held(question)}{fast} {asked} {span:g} s"
    return f"{told}: each history misses a limit by at least {short}{scales}"


def held(question: Question | SpaceQuestion) -> str:
    """What the exact question varies: a NO_GO says nothing about thrust that changes within a step."""
    return f"held over steps of {question.dt:g} s"
