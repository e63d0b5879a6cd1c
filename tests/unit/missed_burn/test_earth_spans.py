"""Proofs about the true Earth whose drifts are short, or do not pass the perigee, or are too long for their parts."""

import json
import math

import numpy as np
import pytest
from flint import arb, fmpq

from safestart.missed_burn.document import document_of
from safestart.missed_burn.earth.motion import Earth, moved
from safestart.missed_burn.plan import Errors, Failures, Plan, Question
from safestart.missed_burn.prove import Proof, Verdict, prove
from safestart.missed_burn.zone import POINT, Zone
from safestart.proofs.abort.earth.course import Course
from safestart.proofs.checker import check
from safestart.proofs.statement import digest_of
from safestart.proofs.strict import ProofRejected
from safestart.runtime.precision import precise
from tests.unit.missed_burn.flights import STUDY, N, plan_of

TINY = Errors((1e-6,) * 3, (1e-9,) * 3)
SHORT = Failures(30.0, True, 4.0, 0.002, math.radians(5.0))


def _one(
    a: float,
    e: float,
    anomaly: float,
    horizon: float,
    errors: Errors = STUDY,
    failures: Failures = Failures(),  # noqa: B008
    zones: tuple[Zone, ...] = (POINT,),
) -> Proof:
    """A plan of one burn."""
    plan = plan_of(40.0, 1, 1200.0)
    plan = Plan(N, plan.start, plan.burns[:1])
    earth = Earth.of(plan, a, e, 1.0, 0.4, anomaly)
    return prove(Question(plan, 100.0, horizon, errors, failures, earth=earth, zones=zones))


def _document(proof: Proof):
    assert proof.verdict is Verdict.PROVED
    return json.loads(json.dumps(document_of(proof)))


@pytest.mark.parametrize(
    ("horizon", "zones"), [(200.0, (POINT,)), (200.0, (Zone.sphere(30.0),)), (2000.0, (POINT,))]
)
def test_a_drift_far_from_the_perigee_is_checked_with_the_bounds_of_its_own_time(horizon, zones) -> None:
    """The first burn is at the perigee, the last drift far above it: the trial radii are for that drift's gravity."""
    plan = plan_of(40.0)
    earth = Earth.of(plan, 8.1e6, 0.01, 1.0, 0.4, 0.3, before=plan.before())
    proof = prove(Question(plan, 50.0, horizon, STUDY, earth=earth, zones=zones))
    assert check(_document(proof)).margin_m == proof.least


@pytest.mark.parametrize(
    ("a", "e", "anomaly", "horizon", "more"),
    [
        # Shorter than a step of the checker, which goes on towards the perigee.
        (8.1e6, 0.01, 2.0, 0.5, {}),
        (40e6, 0.8, 5.0, 20.0, {}),
        (40e6, 0.8, 4.0, 2000.0, {}),
        (8.1e6, 0.2, 2.0, 20.0, {"errors": TINY}),
        (8.1e6, 0.2, 2.0, 0.5, {"errors": Errors()}),
        (8.1e6, 0.2, 4.5, 20.0, {"failures": SHORT, "zones": (Zone.sphere(30.0),)}),
    ],
)
def test_documents_of_short_drifts_are_verified(a, e, anomaly, horizon, more) -> None:
    proof = _one(a, e, anomaly, horizon, **more)
    assert check(_document(proof)).margin_m == proof.least


@pytest.mark.parametrize(("e", "anomaly"), [(0.8, 4.5), (0.3, 0.0), (0.3, 2.0)])
@pytest.mark.parametrize(("begin", "end"), [(0, 20), (300, 900), (100, 3000)])
def test_the_least_radius_of_a_span_is_that_of_its_own_times(e, anomaly, begin, end) -> None:
    target = Earth.of(plan_of(0.0), 40e6, e, 1.0, 0.4, anomaly).target
    radii = [np.linalg.norm(moved(np.array(target), t)[0][:3]) for t in np.linspace(begin, end, 30)]
    with precise(128):
        exact = [arb(fmpq(*x.as_integer_ratio())) for x in target]
        mu, j2, radius = (fmpq(*x.as_integer_ratio()) for x in (3.986004418e14, 1.08262668e-3, 6378137.0))
        course = Course(mu, j2, radius, exact, fmpq(3000))
        low = float(course.least(arb(begin), arb(end)))
        assert float(course.lowest) <= low
        # Provers leave half a percent for the checker's balls of time.
        assert 0.996 * min(radii) < low <= min(radii)
        with pytest.raises(ProofRejected, match="outside"):
            course.least(arb(begin), arb(course.end / arb(course.rate)) + 1)


@pytest.mark.parametrize("which", [0, 1])
def test_cells_outside_the_drift_are_refused(which: int) -> None:
    """Bounds on the courses are for the times of the drift: no cell may lean on what comes after or before it."""
    document = _document(_one(8.1e6, 0.2, 2.0, 200.0))
    cells = sorted(document["cases"][0]["cells"])
    document["cases"][0]["cells"] = cells
    if which:
        cells[-1][1] += 5.0
    else:
        cells[0][0] -= 1e-3
    document["digest"] = digest_of({k: v for k, v in document.items() if k != "digest"})
    with pytest.raises(ProofRejected, match="outside"):
        check(document)


def test_parts_that_are_too_long_prove_nothing() -> None:
    """Between nodes so far apart the motion has no bound from them: a sum of sizes over 1 - K h^2/8 < 0 is none."""
    proof = _one(8.1e6, 0.01, 0.0, 2.5e5, errors=Errors((1e-3,) * 3, (1e-7,) * 3))
    assert proof.verdict is Verdict.UNKNOWN
    assert proof.least == 0.0
