"""Ellipsoids, boxes and spheres to keep out of, ellipsoids of errors: distances, bounds, documents, refusals."""

import json
import math

import numpy as np
import pytest
from scipy.optimize import minimize

from safestart.errors import InvalidInput
from safestart.missed_burn.document import document_of
from safestart.missed_burn.plan import Burn, Errors, Plan, Question
from safestart.missed_burn.prove import Verdict, greatest_scale, prove
from safestart.missed_burn.zone import POINT, Zone
from safestart.processes.passive_abort.question import ellipsoid_of, zone_of
from safestart.processes.passive_abort.wire import ZoneInput
from safestart.proofs.checker import check
from safestart.proofs.statement import digest_of
from safestart.proofs.strict import ProofRejected
from tests.unit.missed_burn.flights import EVERYTHING, ORBIT, STUDY, N, distances, plan_of

TURN = [math.cos(0.3), 0.0, 0.0, math.sin(0.3)]


def _zone(kind: str, half, centre=(0.0, 0.0, 0.0)) -> Zone:
    return zone_of(
        ZoneInput.model_validate(
            {"kind": kind, "half_m": list(half), "centre_m": list(centre), "attitude_wxyz": TURN}
        )
    )


@pytest.mark.parametrize("kind", ["ellipsoid", "box"])
def test_distances_are_those_of_a_general_optimiser(kind: str) -> None:
    zone, rng = _zone(kind, (40.0, 12.0, 5.0), (3.0, -7.0, 2.0)), np.random.default_rng(2)
    axes = np.array(zone.axes)
    for _ in range(15):
        point = np.array(zone.centre) + rng.normal(0.0, 40.0, 3)
        inside = {"type": "ineq", "fun": lambda b: 1.0 - b @ b}
        nearest = minimize(
            lambda b, p=point: ((np.array(zone.centre) + b @ axes - p) ** 2).sum(),
            np.zeros(3),
            constraints=[inside] if kind == "ellipsoid" else (),
            bounds=None if kind == "ellipsoid" else [(-1.0, 1.0)] * 3,
            method="SLSQP",
            options={"ftol": 1e-14, "maxiter": 500},
        )
        assert zone.distance(point) == pytest.approx(math.sqrt(nearest.fun), abs=2e-4)


def test_a_sphere_around_the_target_is_the_keep_out_radius() -> None:
    plain = prove(Question(plan_of(40.0), 50.0, 2.0 * ORBIT, STUDY, EVERYTHING))
    ball = prove(Question(plan_of(40.0), 20.0, 2.0 * ORBIT, STUDY, EVERYTHING, zones=(Zone.sphere(30.0),)))
    assert ball.verdict is plain.verdict
    assert ball.least == pytest.approx(plain.least - 30.0, abs=0.05)


@pytest.mark.parametrize("kind", ["ellipsoid", "box"])
def test_flights_keep_the_proved_distance_from_the_body(kind: str) -> None:
    zone, plan = _zone(kind, (60.0, 25.0, 10.0)), plan_of(90.0)
    proof = prove(Question(plan, 5.0, 2.0 * ORBIT, STUDY, zones=(zone, POINT)))
    assert proof.verdict is Verdict.PROVED
    last = next(f for f in proof.findings if f.case.kind == "made" and f.case.burn == 4 and f.zone == 0)
    rng, near, n = np.random.default_rng(4), math.inf, N
    for _ in range(60):
        state, begin = last.case.centre.copy(), 0
        for end in last.case.ends.tolist():
            b = rng.standard_normal(end - begin)
            state += (b / np.linalg.norm(b)) @ last.case.columns[begin:end]
            begin = end
        for t in np.linspace(0.0, 0.3 * ORBIT, 150):
            s, c = math.sin(n * t), math.cos(n * t)
            x, y, z, u, v, w = state
            at = [
                (4 - 3 * c) * x + s / n * u + 2 * (1 - c) / n * v,
                6 * (s - n * t) * x + y - 2 * (1 - c) / n * u + (4 * s - 3 * n * t) / n * v,
                c * z + s / n * w,
            ]
            near = min(near, zone.distance(np.array(at)))
    assert last.least <= near <= last.least + 6.0
    assert last.nearest == pytest.approx(last.least, abs=0.2)


def _document(zone: Zone, errors: Errors = STUDY):
    proof = prove(Question(plan_of(90.0, 3), 5.0, ORBIT, errors, EVERYTHING, zones=(zone,)), sharp=False)
    assert proof.verdict is Verdict.PROVED
    return json.loads(json.dumps(document_of(proof)))


def _sealed(document):
    document["digest"] = digest_of({k: v for k, v in document.items() if k != "digest"})
    return document


def test_documents_of_zones_are_checked_and_a_larger_zone_is_refused() -> None:
    document = _document(_zone("box", (60.0, 25.0, 10.0)))
    assert any("the box of" in line for line in check(document).statement)
    # As an ellipsoid with the same axes it is smaller: its claim holds, too.
    document["question"]["zones"][0]["kind"] = "ellipsoid"
    assert check(_sealed(document)).verdict == "PROVED"
    document["question"]["zones"][0]["axes_m"][0] = [160.0, 0.0, 0.0]
    with pytest.raises(ProofRejected, match="short by"):
        check(_sealed(document))
    document["question"]["zones"].append(document["question"]["zones"][0])
    with pytest.raises(ProofRejected, match="zone 1"):
        check(_sealed(document))


def test_an_ellipsoid_of_errors_lies_in_its_box_and_its_document_is_checked() -> None:
    covariance = np.diag([0.5**2] * 3 + [1e-3**2] * 3)
    columns = ellipsoid_of(covariance.tolist(), 1.0)
    assert np.array(columns).T @ np.array(columns) == pytest.approx(covariance, abs=1e-15)
    still = (0.0, 0.0, 0.0)
    inner = Errors(still, still, 0.01, math.radians(0.5), ellipsoid=columns)
    ball = prove(Question(plan_of(40.0), 50.0, 2.0 * ORBIT, inner))
    box = prove(Question(plan_of(40.0), 50.0, 2.0 * ORBIT, STUDY))
    assert ball.least > box.least
    document = json.loads(json.dumps(document_of(ball)))
    assert any("off by L b" in line for line in check(document).statement)
    document["question"]["errors"]["ellipsoid"][0] = [3.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    with pytest.raises(ProofRejected, match="short by"):
        check(_sealed(document))


def test_members_of_the_ellipsoid_come_near_its_bound_and_violations_replay() -> None:
    """Correlated errors, drawn from the covariance itself."""
    mix = np.random.default_rng(8).standard_normal((6, 6)) * np.repeat([0.4, 8e-4], 3)[:, None]
    columns = ellipsoid_of((mix @ mix.T).tolist(), 2.0)
    still = (0.0, 0.0, 0.0)
    errors = Errors(still, still, 0.0, 0.0, ellipsoid=columns)
    plan = Plan(N, (0.0, 100.0, 0.0, 0.0, 0.0, 0.0), (Burn(0.0, (0.02, 0.0, 0.0)),))
    proof = prove(Question(plan, 1.0, 2.0 * ORBIT, errors))
    rng, near = np.random.default_rng(1), math.inf
    made = next(f for f in proof.findings if f.case.kind == "made")
    for _ in range(400):
        b = rng.standard_normal(6)
        off = 2.0 * mix @ (b / np.linalg.norm(b))
        near = min(near, distances(N, made.case.centre + off, np.linspace(0.0, 2.0 * ORBIT, 500)).min())
    assert made.least <= near <= made.least + 12.0
    level = greatest_scale(Question(plan, 50.0, 2.0 * ORBIT, errors))
    beyond = prove(Question(plan, 50.0, 2.0 * ORBIT, errors.scaled(1.02 * level)))
    assert beyond.verdict is Verdict.VIOLATED
    assert beyond.counter_example is not None
    assert beyond.counter_example.distance() < 50.0


def test_bad_zones_and_covariances_are_named() -> None:
    with pytest.raises(InvalidInput, match="perpendicular"):
        Zone("box", (0.0, 0.0, 0.0), ((1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 0.0, 1.0)))
    with pytest.raises(InvalidInput, match="radius three times, 0 or more"):
        _zone("sphere", (1.0, 2.0, 3.0))
    with pytest.raises(InvalidInput, match="lengths above 0"):
        _zone("box", (1.0, 0.0, 3.0))
    bad = np.diag([1.0, 1.0, 1.0, 1e-6, 1e-6, -1e-6])
    with pytest.raises(InvalidInput, match="positive semi-definite"):
        ellipsoid_of(bad.tolist(), 3.0)
    bent = np.eye(6)
    bent[0, 1] = bent[1, 0] = 1.1
    with pytest.raises(InvalidInput, match="positive semi-definite"):
        ellipsoid_of(bent.tolist(), 3.0)
    with pytest.raises(InvalidInput, match="6 rows"):
        ellipsoid_of([[1.0]] * 6, 3.0)


@pytest.mark.parametrize(
    "axes", [[[9.0, 0, 0], [0, 8.0, 0], [0, 0, 9.0]], [[9.0, 1, 0], [0, 9.0, 0], [0, 0, 9.0]]]
)
def test_what_a_document_calls_a_sphere_is_one(axes) -> None:
    """Its print gives a radius: a body of other axes may not have that name."""
    made = document_of(
        prove(Question(plan_of(40.0, 2), 20.0, 500.0, zones=(Zone.sphere(9.0, (1.0, 2.0, 3.0)),)))
    )
    assert any("the sphere of 9.0 m about [1.0, 2.0, 3.0] m" in line for line in check(made).statement)
    made["question"]["zones"][0]["axes_m"] = axes
    made["digest"] = digest_of({k: v for k, v in made.items() if k != "digest"})
    with pytest.raises(ProofRejected, match="sphere's radius"):
        check(made)
