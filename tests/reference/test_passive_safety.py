"""The competition's rows (paper 003 and its followers): verdicts at 300 min, and where they turn."""

import math
import re
from pathlib import Path

import numpy as np
import pytest

from safestart.passive_safety.cases import CASES, HALF_WIDTHS, HORIZON
from safestart.passive_safety.critical import critical_abort
from safestart.passive_safety.flights.independent_flight import replay
from safestart.passive_safety.model import PUBLISHED, Dynamics, System
from safestart.passive_safety.question import Question, Verdict
from safestart.passive_safety.verify import verify


@pytest.mark.parametrize("dynamics", list(Dynamics))
@pytest.mark.parametrize("half_width", HALF_WIDTHS)
@pytest.mark.parametrize("case", CASES)
def test_verdicts(case: str, half_width: float, dynamics: Dynamics) -> None:
    """The same verdicts for both dynamics; nobody published any for a failure with the nonlinear ones."""
    system = System(dynamics)
    question = Question(horizon=HORIZON, window=CASES[case], box=half_width, system=system)
    findings = verify(question).findings
    for name in ("thrust", "los", "velocity"):
        assert findings[name].verdict is Verdict.SAFE
        assert findings[name].margin is not None
        assert findings[name].margin > 0.0
    separation = findings["separation"]
    if case.startswith("SRU") and half_width == 0.2:
        assert separation.verdict is Verdict.UNSAFE
        example = separation.counter_example
        assert example is not None
        window = question.window
        assert window is not None
        assert window[0] <= example["abort_min"] <= window[1]
        state = replay(system, np.array(example["start"]), example["abort_min"], example["contact_min"])
        assert np.abs(state[:2]).max() < half_width
        assert (np.abs(np.array(example["start"]) - question.centre) <= question.half).all()
    else:
        assert separation.verdict is Verdict.SAFE


def test_the_page_gives_the_distances_that_are_proved() -> None:
    """docs/theory/passive-safety.md, rounded down: SRA07 stood there with 0.414 m long after it had become 1.016."""
    page = Path(__file__).parents[2] / "docs/theory/passive-safety.md"
    rows = re.findall(r"^\| (S[^|]+?) \|[^|]*\|[^|]*\|[^|]*\|([^|]*)\|$", page.read_text(), re.MULTILINE)
    stated = {}
    for names, distance in rows:
        first, *others = names.split(", ")
        for name in (first, *(first[: len(first) - len(other)] + other for other in others)):
            stated[name] = (distance.split() or [""])[0]
    assert set(stated) == set(CASES)
    for case, text in stated.items():
        if not text:
            assert CASES[case] is None
            continue
        digits = len(text.partition(".")[2])
        bound = verify(Question(horizon=HORIZON, window=CASES[case], box=0.1)).findings["separation"].bound
        assert bound is not None
        assert math.floor(bound * 10**digits) == round(float(text) * 10**digits), case


def test_speed_as_a_true_disc_is_violated_after_the_octagon_guard() -> None:
    """5.15 to 5.24 cm/s where 5 are allowed; the octagon of the competition holds."""
    finding = verify(Question()).findings["velocity_disc"]
    assert finding.verdict is Verdict.UNSAFE
    assert finding.counter_example is not None
    assert 5.15 <= finding.counter_example["value"] / 0.6 <= 5.25


@pytest.mark.parametrize(("half_width", "minutes"), [(0.1, 274.4), (0.2, 251.3)])
def test_critical_abort_time(half_width: float, minutes: float) -> None:
    """Proof below, counter-example above, and the published time between or next to them."""
    question = Question(horizon=360.0, box=half_width)
    found = critical_abort(question, 0.0, 300.0)
    assert found.proved_until is not None
    assert found.example is not None
    assert found.proved_until < found.example.abort
    assert found.example.abort - found.proved_until < 0.5
    assert found.proved_until == pytest.approx(minutes, abs=0.5)
    assert found.example.abort == pytest.approx(minutes, abs=0.5)
    state = replay(PUBLISHED, np.array(found.example.start), found.example.abort, found.example.time)
    assert np.abs(state[:2]).max() < half_width


def test_no_abort_is_critical_for_contacts_after_the_horizon() -> None:
    assert critical_abort(Question(horizon=300.0, box=0.1), 0.0, 300.0).proved_until == 300.0
