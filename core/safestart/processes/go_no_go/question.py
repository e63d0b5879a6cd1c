"""The exact question of a request, and its answer in a sentence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from safestart.errors import InvalidInput, invalid
from safestart.exact.answer import Answer, Held, Verdict
from safestart.exact.question import SPEED_SCALE, Goal, Question
from safestart.exact.space.question import SpaceQuestion
from safestart.model.scenario import Floats
from safestart.processes.go_no_go.question_fields import AfterArrival
from safestart.processes.go_no_go.spec import GoNoGoInputs
from safestart.processes.wire import DT_S

_WIRE = {"keep_out": "keep_out_m", "hold": "hold_x_m, hold_y_m, hold_z_m", "speed_limit": "speed_limit_m_s"}
_NO_STAY = "a thrust history arrives at rest, but nothing proves that the chaser can stay there"
_NO_HOLD = "a thrust history arrives at rest, but no ellipsoid that the LQR keeps holds its end"


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


def with_arrival(
    after: AfterArrival, question: Question, starts: Sequence[Floats] | Floats, answers: list[Answer]
) -> list[Answer]:
    """GOs of `synchronize` become UNDECIDED without the proof that is asked of the time ``after`` their end."""
    if question.goal is None or after == "any":
        return answers
    if after == "hold":
        answers = [with_hold_after(question, *each) for each in zip(starts, answers, strict=True)]
    return [
        replace(answer, verdict=Verdict.UNDECIDED, reason=_NO_HOLD if after == "hold" else _NO_STAY)
        if answer.verdict is Verdict.GO and not stays(after, answer)
        else answer
        for answer in answers
    ]


def stays(after: AfterArrival, answer: Answer) -> bool:
    """Whether a GO of `synchronize` has the proof of what comes after its end that was asked for."""
    if after == "any":
        return True
    return (answer.held if after == "hold" else answer.arrival) is not None


def with_hold_after(question: Question, start: Floats, answer: Answer) -> Answer:
    """A GO of `synchronize` with the LQR's set that holds its end, if one does; raises ``InvalidInput`` in space."""
    if question.dimensions != 2:
        raise invalid("after_arrival", "stay or any for starts in space: the LQR's sets are planar", "hold")
    # Imported here, because only this needs a Riccati equation.
    from safestart.exact.hold_after import with_hold

    return with_hold(question, start, answer)


def hold_after(
    inputs: GoNoGoInputs, question: Question, answers: list[Answer]
) -> list[dict[str, Any] | None] | None:
    """``HoldAfter`` of each answer, None for NO_GO; None where it is not asked."""
    if question.goal is None or inputs.after_arrival != "hold":
        return None
    return [None if answer.verdict is Verdict.NO_GO else told_of_hold(answer.held) for answer in answers]


def told_of_hold(found: Held | None) -> dict[str, Any]:
    """``HoldAfter``."""
    if found is None:
        return {"code": "not_proved"} | dict.fromkeys(("point_m", "gain", "cost", "level", "margin_m"))
    return {
        "code": "proved",
        "point_m": found.point.tolist(),
        "gain": found.gain.tolist(),
        "cost": found.cost.tolist(),
        "level": found.level,
        "margin_m": found.margin,
    }


def sentence(question: Question, answer: Answer) -> str:
    """The verdict in words."""
    return told(question, answer) + (
        "; the hold plane implies the keep-out radius" if question.keep_out > 0.0 else ""
    )


def told(question: Question | SpaceQuestion, answer: Answer, beside: str = "") -> str:
    """The verdict in words, without the keep-out radius; ``beside`` names what a NO_GO may break, too."""
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
        if answer.held is not None:
            x, y = answer.held.point.tolist()
            return (
                f"{told}; then the LQR about ({x:.3g}, {y:.3g}) m keeps it for ever, thrust {held(question)}, at "
                f"least {answer.held.margin:.2f} m from every face"
            )
        if answer.arrival is None:
            return f"{told}; that it can stay there is not proved"
        return (
            f"{told}; then it stops in {answer.arrival.stop:.2g} s and stands for ever, at least "
            f"{answer.arrival.margin:.2f} m from every face"
        )
    asked = "is at rest in the hold ball within" if question.goal is not None else "stays for"
    told = f"no thrust {held(question)}{fast} {asked} {span:g} s"
    return (
        f"{told}: each history misses a limit{f' or {beside}' if beside else ''} by at least {short}{scales}"
    )


def held(question: Question | SpaceQuestion) -> str:
    """What the exact question varies: a NO_GO says nothing about thrust that changes within a step."""
    return f"held over steps of {question.dt:g} s"
