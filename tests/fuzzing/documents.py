"""One small document of every kind of proof, and what happens to its mutants."""

from __future__ import annotations

import contextlib
import json
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from random import Random
from typing import Any

import numpy as np

from safestart.disturbance.prove import proof_against
from safestart.disturbance.tube import Disturbance, decide_disturbed, tube_of
from safestart.exact.decide import decide
from safestart.exact.hold_after import with_hold
from safestart.exact.prove import proof_of
from safestart.exact.question import Goal, Question
from safestart.families.decide import decide_for_all
from safestart.families.members import Family
from safestart.families.prove import proof_for_all
from safestart.model.scenario import Chaser, CorridorShape, Scenario, Target
from safestart.proofs.checker import check
from safestart.proofs.single import Verified
from safestart.proofs.statement import digest_of
from safestart.proofs.strict import ProofRejected
from safestart.proofs.wording import question_shown
from safestart.runtime.plain_json import loads
from tests.fuzzing.abort.decided import truth_of_drifts
from tests.fuzzing.abort.made import MADE as OF_BURNS
from tests.fuzzing.abort.printed import printed as printed_drifts
from tests.fuzzing.mutants import known_fields, mutants, paths
from tests.fuzzing.plane.arrived import truth_after
from tests.fuzzing.plane.decided import Truth, truth
from tests.fuzzing.plane.disturbed import truth_against
from tests.fuzzing.plane.held import truth_held
from tests.fuzzing.plane.printed import Printed, printed
from tests.fuzzing.remembered import remembered
from tests.fuzzing.space.decided import truth_in_space
from tests.fuzzing.space.made import MADE as IN_SPACE
from tests.fuzzing.space.printed import printed as printed_in_space

Document = dict[str, Any]
Claim = tuple[str, tuple[str, ...]]
SHAPE = CorridorShape(1.2, 0.7, 3.0, 2.0, 0.75)
GOAL = Goal(0.5, 0.05, (0.0, 1.5))


def _scenario(rate: float, a_max: float) -> Scenario:
    return Scenario(Target(rate, 1.1e-3), Chaser(a_max), SHAPE)


def _one(question: Question, *start: float) -> Document:
    state = np.array(start)
    return proof_of(question, state, decide(question, state))


def _held(question: Question, *start: float) -> Document:
    state = np.array(start)
    return proof_of(question, state, with_hold(question, state, decide(question, state)))


def _all(verdict_start: tuple[float, ...], rate: float, **change: Any) -> Document:
    question = Question(_scenario(rate, 0.1), 2.0, 2, 2, None, None, 0.5)
    family = Family(question, 2e-3, 5e-3, 1e-5, (0.0, 0.2, 0.01, 0.0))
    state = np.array(verdict_start)
    return proof_for_all(family, state, decide_for_all(family, state, **change))


def _against(question: Question, disturbance: Disturbance, *start: float) -> Document:
    state = np.array(start)
    answer = decide_disturbed(question, state, disturbance)
    return proof_against(question, disturbance, tube_of(question, disturbance), state, answer)


# One step, too short to come to rest: the stop afterwards takes time.
MOVING = Question(_scenario(0.05, 0.02), 2.0, 1, 2, Goal(0.5, 0.05, (0.0, 1.5)), 1.5, 0.5)
MAKERS: dict[str, Callable[[], Document]] = {
    "stay-go": lambda: _one(Question(_scenario(0.05, 0.1), 2.0, 4), 2.0, 6.0, 0.1, -0.2),
    "stay-no-go": lambda: _one(Question(_scenario(0.1, 0.05), 2.0, 4), 8.0, 6.0, 0.2, 0.0),
    "stay-go-space": lambda: _one(
        Question(_scenario(0.05, 0.1), 2.0, 3, 3, None, 0.8, 0.5), 2.0, 6.0, 1.0, 0.1, -0.2, 0.05
    ),
    "stay-no-go-space": lambda: _one(
        Question(_scenario(0.05, 0.05), 2.0, 3, 3, None, 0.5, 0.5), 1.0, 1.2, 0.5, 0.3, -0.35, 0.1
    ),
    "synchronize-go": lambda: _one(
        Question(_scenario(0.05, 0.3), 2.0, 4, 2, GOAL, 1.5, 0.5), 0.3, 2.0, 0.0, -0.1
    ),
    "synchronize-go-moving": lambda: _one(MOVING, 0.1, 1.5, -0.075, 0.065),
    "synchronize-go-held": lambda: _held(MOVING, 0.1, 1.5, -0.075, 0.065),
    "synchronize-no-go": lambda: _one(
        Question(_scenario(0.05, 0.05), 2.0, 4, 2, GOAL, 1.5, 0.5), 0.5, 3.0, 0.3, 0.0
    ),
    "family-go": lambda: _all((1.0, 6.0, 0.0, 0.0), 0.05),
    "family-go-per-corner": lambda: _all((1.0, 6.0, 0.0, 0.0), 0.05, witness="per_corner"),
    "disturbed-go": lambda: _against(
        Question(_scenario(0.05, 0.1), 0.5, 8, 2, None, None, 0.5),
        Disturbance(0.01, 0.02, 0.01),
        1.0,
        6.0,
        0.1,
        -0.2,
    ),
    "disturbed-go-space": lambda: _against(
        Question(_scenario(0.05, 0.1), 0.5, 2, 3), Disturbance(0.01), 1.0, 6.0, 0.5, 0.1, -0.2, 0.05
    ),
    "family-no-go": lambda: _all((7.0, 6.0, 0.5, 0.0), 0.1),
    **IN_SPACE,
    **OF_BURNS,
}
KINDS = tuple(MAKERS)


@cache
def original(kind: str) -> str:
    """The document as text, small enough for a mutant to be checked in milliseconds."""
    made = MAKERS[kind]()
    wanted = "PROVED" if kind in OF_BURNS else "NO_GO" if "no-go" in kind else "GO"
    assert made["verdict"] == wanted, kind
    return json.dumps(made)


@dataclass
class Run:
    """What became of the mutants; ``false`` lists those accepted that print a false statement or hold an unread field,
    ``open`` those accepted that could not be decided."""

    outcomes: Counter[str]
    false: list[tuple[str, Document]]
    open: list[tuple[str, Document]]


def run(
    kind: str,
    number: int,
    seed: int,
    *,
    remembering: bool = False,
    watched: Callable[[Iterable[Any]], Iterable[Any]] = iter,
) -> Run:
    """Check mutants of one kind; each accepted one is printed, read back and decided anew.

    ``remembering``: equal parts of documents are checked once, where most of a long run's time would go. ``watched``
    passes the mutants on, and may tell how many.
    """
    with remembered() if remembering else contextlib.nullcontext():
        return _run(kind, number, seed, watched)


def _run(kind: str, number: int, seed: int, watched: Callable[[Iterable[Any]], Iterable[Any]]) -> Run:
    rng = Random(f"{kind} {seed}")
    document = json.loads(original(kind))
    fields = known_fields(*(json.loads(original(other)) for other in KINDS))
    first = check(document)
    known = {(first.verdict, first.statement): first.margin_m}
    told = {(first.verdict, first.statement): _question(document)}
    made = _sealed(mutants(document, fields, rng, number), rng)
    seen: dict[str, str] = {}
    return tally((done, mutant, _once(mutant, seen, known, told, rng)) for done, mutant in watched(made))


def tally(outcomes: Iterable[tuple[str, Any, str]]) -> Run:
    """Outcomes counted, with the mutants that should not have been accepted."""
    out = Run(Counter(), [], [])
    for done, mutant, outcome in outcomes:
        out.outcomes[outcome] += 1
        if outcome in ("accepted: false", "accepted: unread"):
            out.false.append((done, mutant))
        if outcome == "accepted: open":
            out.open.append((done, mutant))
    return out


def names(document: Any) -> set[tuple[str, ...]]:
    """Which fields it holds where, whatever the place in a list."""
    return {tuple(key if isinstance(key, str) else "*" for key in path) for path in paths(document)}


@cache
def _known_names() -> set[tuple[str, ...]]:
    return set().union(*(names(json.loads(original(kind))) for kind in KINDS))


def _sealed(made: Iterator[tuple[str, Any]], rng: Random) -> Iterator[tuple[str, Any]]:
    """A forger writes the digest, too; now and then one does not."""
    for done, mutant in made:
        if isinstance(mutant, dict) and "digest" not in done and rng.random() < 0.98:
            with contextlib.suppress(TypeError, ValueError):
                mutant["digest"] = digest_of(mutant)
        yield done, mutant


def _once(
    mutant: Any, seen: dict[str, str], known: dict[Claim, float], told: dict[Claim, str], rng: Random
) -> str:
    """The outcome, looked up where the same document was made before: many changes change nothing."""
    try:
        text = json.dumps(mutant, sort_keys=True)
    except (TypeError, ValueError):
        return "no JSON"
    if text not in seen:
        outcome = _outcome(text, known, told, rng)
        if not outcome.startswith("accepted"):
            return outcome
        seen[text] = outcome
    return seen[text]


def decided(found: Verified, document: Document, rng: Random) -> str:
    """Whether what the checker says of a document is true, by solvers of another kind."""
    if document["schema"] == "safestart-proof/2":
        return truth_in_space(printed_in_space(found.verdict, found.margin_m, found.statement), document, rng)
    if found.verdict == "PROVED":
        said = printed_drifts(found.statement)
        return "false" if said.least != found.margin_m else truth_of_drifts(said, rng)
    claim = printed(found.verdict, found.margin_m, found.statement)
    answer = truth_against(claim, document, rng) if claim.who == "against" else _until_the_end(claim, rng)
    if claim.stop is not None and answer != "false":
        answer = "false" if truth_after(claim, document) == "false" else answer
    if claim.held is not None and answer != "false":
        answer = "false" if truth_held(claim, claim.held, document) == "false" else answer
    return answer


_UNTIL: dict[Printed, Truth] = {}


def _until_the_end(claim: Printed, rng: Random) -> Truth:
    """The truth of what is claimed up to the end, looked up where only claims about the time after it changed."""
    alone = replace(claim, stop=None, after=0.0, held=None)
    if alone not in _UNTIL:
        _UNTIL[alone] = truth(alone, rng)
    return _UNTIL[alone]


def _question(document: Document) -> str:
    """Question and start as they are shown, numbers that are equal alike.

    The feedback and the tube are found by the prover, as a thrust history is: they are evidence.
    """
    shown = {key: value for key, value in question_shown(document).items() if key not in ("feedback", "tube")}
    table = shown["question"].get("attitude", {}).get("times_s")
    if table is not None:
        # Entries beyond the horizon say nothing.
        horizon = shown["question"]["dt_s"] * shown["question"]["steps"]
        first = max(k for k, t in enumerate(table) if t <= 0)
        last = min(k for k, t in enumerate(table) if t >= horizon)
        used = {
            key: shown["question"]["attitude"][key][first : last + 1] for key in ("times_s", "attitude_wxyz")
        }
        attitude = shown["question"]["attitude"] | used
        shown = shown | {"question": shown["question"] | {"attitude": attitude}}
    return json.dumps(_floats(shown), sort_keys=True)


def _floats(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _floats(inside) for key, inside in value.items()}
    if isinstance(value, list):
        return [_floats(inside) for inside in value]
    whole = isinstance(value, int | float) and not isinstance(value, bool)
    return float(value) + 0.0 if whole else value


def _outcome(text: str, known: dict[Claim, float], told: dict[Claim, str], rng: Random) -> str:
    try:
        # As a file would give it, where it can be one.
        mutant = loads(text)
    except (TypeError, ValueError):
        return "no JSON"
    try:
        found = check(mutant)
    except ProofRejected:
        return "rejected"
    if not names(mutant) <= _known_names():
        return "accepted: unread"
    key = found.verdict, found.statement
    if key in told and told[key] != _question(mutant):
        # Two questions that read alike: what tells them apart is not printed.
        return "accepted: unread"
    told[key] = _question(mutant)
    if key in known:
        implied = found.margin_m >= known[key] if found.verdict == "NO_GO" else found.margin_m <= known[key]
        if implied:
            return (
                "accepted: the same statement" if found.margin_m == known[key] else "accepted: a weaker claim"
            )
    answer = decided(found, mutant, rng)
    if answer == "true" and key not in known:
        known[key] = found.margin_m
    return f"accepted: {answer}"
