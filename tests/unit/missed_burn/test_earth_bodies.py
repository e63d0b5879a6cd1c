"""Zones and burns that last about the true Earth: no flight with J2 comes nearer, bent documents are refused."""

import json
import math

import numpy as np
import pytest
from flint import arb

from safestart.dynamics.two_body_kernel import STAGES, WEIGHTS, drifted, placed, pushed, seen
from safestart.missed_burn import pushed as prover_pushes
from safestart.missed_burn.document import document_of
from safestart.missed_burn.earth import motion as earth
from safestart.missed_burn.earth.frame import Turning
from safestart.missed_burn.earth.motion import Earth, drift_after, target_before
from safestart.missed_burn.plan import Burn, Errors, Failures, Plan, Question
from safestart.missed_burn.prove import Proof, Verdict, prove
from safestart.missed_burn.pushed import EarthPushed
from safestart.missed_burn.zone import POINT, Zone
from safestart.proofs.abort.earth import sets as checked
from safestart.proofs.abort.earth.pushes import LastingPushes
from safestart.proofs.abort.finite import Rates
from safestart.proofs.checker import check
from safestart.proofs.statement import digest_of
from safestart.proofs.strict import ProofRejected
from tests.unit.missed_burn.flights import ORBIT, STUDY, N, turned

A = 8.1e6
FAILURES = Failures(40.0, True, 4.0, 0.002, math.radians(5.0))
TURN = math.cos(0.5), math.sin(0.5)
BOX = Zone(
    "box",
    (4.0, -20.0, 3.0),
    ((0.0, 0.0, 8.0), (30 * TURN[0], 30 * TURN[1], 0.0), (-5 * TURN[1], 5 * TURN[0], 0.0)),
)
BALL = Zone("ellipsoid", (0.0, 0.0, 0.0), ((12.0, 0.0, 0.0), (0.0, 40.0, 0.0), (0.0, 0.0, 6.0)))
LOOKS, PULSES = 20.0, 24


def _asked(
    lasts: float, zones=(POINT,), failures=FAILURES, horizon=0.6 * ORBIT, errors=STUDY, e=0.1
) -> Question:
    plan = Plan(
        N,
        (0.0, 260.0, 0.0, 0.0, 0.0, 0.0),
        (Burn(0.0, (0.05, 0.0, 0.01), lasts), Burn(3000.0, (0.0, 0.06, 0.0), lasts)),
    )
    return Question(
        plan, 10.0, horizon, errors, failures, earth=Earth.of(plan, A, e, 1.0, 0.4, 0.3), zones=zones
    )


def _nearest(question: Question, zone: int, kind: str, burn: int, rng) -> float:
    """Least distance from a zone that is seen, every few s and in the middle of every pulse, of a random flight in the
    true motion with one failure within the limits, from the burn's planned time on."""
    errors, failures, k = question.errors, question.failures, max(burn, 0)
    body = question.zones[zone]
    box = np.array([*errors.position, *errors.velocity])
    flight = placed(target_before(question, k), question.before()[k] + box * rng.choice([-1.0, 1.0], 6))
    near = math.inf

    def wait(seconds: float, every: float = LOOKS) -> None:
        nonlocal flight, near
        count = max(math.ceil(seconds / every), 1)
        for _ in range(count):
            flight, _ = drifted(flight, seconds / count, STAGES, WEIGHTS)
            near = min(near, body.distance(seen(flight)[:3]))

    def burn_for(seconds: float, thrusts) -> None:
        for j in range(PULSES):
            wait(0.5 * seconds / PULSES)
            pushed(flight, thrusts[j * len(thrusts) // PULSES] * seconds / PULSES)
            wait(0.5 * seconds / PULSES)

    if kind == "start":
        wait(question.horizon)
        return near
    made = question.plan.burns[k]
    base = np.array(made.impulse) * (rng.random() if kind == "partial" else 1.0)
    if kind == "misdirected":
        base = turned(base, failures.misdirected, rng, 1.0)
    off = [
        turned((1.0 + errors.thrust_share * rng.choice([-1, 1])) * base, errors.thrust_angle, rng, 1.0)
        for _ in range(3)
    ]
    if kind == "late":
        wait(failures.late * rng.random())
    on = made.duration * (rng.random() if kind == "cut" else 1.0)
    over = failures.stuck * rng.random() if kind == "stuck" else 0.0
    if made.duration:
        burn_for(on + over, [thrust / made.duration for thrust in off])
    else:
        pushed(flight, off[0])
        if over:
            burn_for(over, [failures.acceleration / made.size * off[0]])
    wait(question.horizon)
    return near


@pytest.fixture(scope="module", params=[0.0, 90.0])
def proof(request) -> Proof:
    return prove(_asked(request.param, (BOX, BALL)))


def test_no_flight_with_j2_comes_nearer_to_a_zone(proof: Proof) -> None:
    question = proof.question
    assert proof.verdict is Verdict.PROVED
    least: dict[tuple[int, str, int], float] = {}
    for finding in proof.findings:
        key = finding.zone, finding.case.kind, finding.case.burn
        least[key] = min(least.get(key, math.inf), finding.least)
    lasting = question.plan.burns[0].duration > 0.0
    assert {kind for _, kind, _ in least} == {
        *("start", "made", "partial", "late", "stuck", "misdirected"),
        *(("cut",) if lasting else ()),
    }
    rng, close = np.random.default_rng(3), math.inf
    for (zone, kind, burn), kept in least.items():
        if lasting and kind in ("made", "stuck"):
            # Those begin at the end of the burn: its path is that of burns that end early.
            kept = min(kept, least[zone, "cut", burn])
        for _ in range(4):
            near = _nearest(question, zone, kind, burn, rng)
            assert near >= kept, (zone, kind, burn)
            close = min(close, near - kept)
    assert close < 8.0


def test_the_nearest_member_is_as_near_as_the_finding_says(proof: Proof) -> None:
    # Looked up at a node whose zone had not been turned yet, it was what memory held.
    question = proof.question
    for finding in proof.findings:
        case = finding.case
        drift = drift_after(question, case.burn, case.share)
        node = round(finding.when / drift.step)
        off = case.centre - drift.reference + finding.member @ case.columns
        place = drift.frames[node] @ (drift.path[node] + drift.tables[node, :3] @ off)
        near = question.zones[finding.zone].distance(place)
        assert near == pytest.approx(finding.nearest, abs=1e-3)


def test_about_a_circle_zones_are_those_of_cwh() -> None:
    plan = _asked(60.0).plan
    sure = Errors((0.1,) * 3, (1e-4,) * 3, 0.001, 1e-3)
    for zones in ((BOX,), (BALL,)):
        linear = prove(Question(plan, 10.0, 0.5 * ORBIT, sure, Failures(20.0, True, 2.0), zones=zones))
        true = prove(
            Question(
                plan,
                10.0,
                0.5 * ORBIT,
                sure,
                Failures(20.0, True, 2.0),
                zones=zones,
                earth=Earth.of(plan, A, 0.0, 0.0, before=plan.before()),
            )
        )
        assert true.least == pytest.approx(linear.least, abs=2.5)


def test_a_violation_is_flown_with_its_burn_and_enters_its_zone() -> None:
    plan = Plan(N, (0.0, 150.0, 0.0, 0.0, 0.0, 0.0), (Burn(0.0, (-0.054, 0.0, 0.0), 60.0),))
    question = Question(
        plan, 5.0, ORBIT, STUDY, FAILURES, earth=Earth.of(plan, A, 0.02, 1.0, 0.4, 0.3), zones=(BALL,)
    )
    found = prove(question, sharp=False)
    assert found.verdict is Verdict.VIOLATED
    flown = found.counter_example
    assert flown is not None
    assert flown.distance(None, BALL) < 5.0
    assert flown.durations.max(initial=0.0) <= 60.0 + FAILURES.stuck


@pytest.fixture(scope="module")
def kept():
    """Documents of one burn, at once and lasting."""
    out = {}
    for lasts in (0.0, 60.0):
        whole = _asked(lasts, (BOX,))
        plan = Plan(N, whole.plan.start, whole.plan.burns[:1])
        question = Question(
            plan,
            10.0,
            0.2 * ORBIT,
            STUDY,
            Failures(10.0, False, 2.0, 0.002),
            earth=Earth.of(plan, A, 0.1, 1.0, 0.4, 0.3),
            zones=(BOX,),
        )
        proved = prove(question, sharp=False)
        assert proved.verdict is Verdict.PROVED
        out[lasts] = json.dumps(document_of(proved)), proved.least
    return out


@pytest.mark.parametrize("lasts", [0.0, 60.0])
def test_documents_are_checked_along_an_enclosed_course(kept, lasts: float) -> None:
    text, least = kept[lasts]
    verified = check(json.loads(text))
    assert verified.margin_m == least
    assert any("the box of" in line for line in verified.statement)


def _sealed(document):
    document["digest"] = digest_of({k: v for k, v in document.items() if k != "digest"})
    return document


def _larger(document):
    document["question"]["zones"][0]["axes_m"][1][0] *= 9.0


def _nearer(document):
    document["question"]["zones"][0]["centre_m"][1] += 260.0


def _another(document):
    document["question"]["zones"].append(document["question"]["zones"][0])


def _no_cut(document):
    document["cases"] = [case for case in document["cases"] if case["kind"] != "cut"]


def _a_cut_less(document):
    document["cases"].remove([case for case in document["cases"] if case["kind"] == "cut"][-1])


def _longer(document):
    document["question"]["burns"][0]["duration_s"] *= 1.01


def _beyond(document):
    document["cases"][1]["reference"] = 1.5


def _near_another(document):
    """Trial radii hold near their own reference only."""
    for case in document["cases"]:
        case["reference"] = 0.0


@pytest.mark.parametrize(
    "bent", [_larger, _nearer, _another, _no_cut, _a_cut_less, _longer, _beyond, _near_another]
)
def test_what_is_bent_is_refused(kept, bent) -> None:
    document = json.loads(kept[60.0][0])
    bent(document)
    with pytest.raises(ProofRejected):
        check(_sealed(document))


def _one_burn(lasts: float, errors: Errors, zones) -> Question:
    plan = Plan(N, (0.0, 400.0, 0.0, 0.0, 0.0, 0.0), (Burn(0.0, (0.0, 0.05, 0.0), lasts),))
    return Question(plan, 1.0, 0.1 * ORBIT, errors, earth=Earth.of(plan, A, 0.1, 1.0, 0.4, 0.0), zones=zones)


def test_the_turning_of_lvlh_between_samples_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    """A zone of a kilometre, seen at nodes only, comes nearer between them than at them."""
    zone = Zone("box", (0.0, -900.0, 0.0), ((5.0, 0.0, 0.0), (0.0, 1000.0, 0.0), (0.0, 0.0, 5.0)))
    monkeypatch.setattr(earth, "turning_of", lambda *_: Turning(0.0, 0.0))
    earth.drift_of.cache_clear()
    document = document_of(prove(_one_burn(0.0, Errors(), (zone,)), sharp=True))
    monkeypatch.undo()
    earth.drift_of.cache_clear()
    with pytest.raises(ProofRejected, match="short by"):
        check(document)
    still = checked.turning

    def without(*course):
        found = still(*course)
        return type(found)(found.spin, arb(0))

    monkeypatch.setattr(checked, "turning", without)
    assert check(document).verdict == "PROVED"


def test_the_bend_of_a_lasting_burn_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    """A document whose errors vary while it burns is refused where the prover takes them as steady."""
    question = _one_burn(300.0, Errors((0.0,) * 3, (0.0,) * 3, 0.2, 0.2), (POINT,))
    steady = prover_pushes.EarthPushed.rates
    monkeypatch.setattr(
        prover_pushes.EarthPushed, "rates", lambda self, longest: (np.zeros(6), steady(self, longest)[1])
    )
    document = document_of(prove(question))
    monkeypatch.undo()
    with pytest.raises(ProofRejected, match=r"short by|radii_m"):
        check(document)
    true = LastingPushes.rates
    monkeypatch.setattr(
        LastingPushes, "rates", lambda self, longest: Rates([arb(0)] * 6, true(self, longest).second)
    )
    assert check(document).verdict == "PROVED"


def test_pushes_are_those_of_the_motion_and_their_rates_bound_them() -> None:
    question = _asked(200.0, e=0.2, horizon=1000.0)
    found = EarthPushed(drift_after(question, 0, 1.0), 250.0)
    times = np.linspace(0.0, 250.0, 26)
    values = np.array([found.at(float(t)) for t in times])
    first, second = found.rates(250.0)
    step = times[1] - times[0]
    assert (np.linalg.norm(np.diff(values, axis=0) / step, axis=2) <= first).all()
    assert (np.linalg.norm(np.diff(values, n=2, axis=0) / step**2, axis=2) <= second).all()
    assert (np.linalg.norm(np.diff(values, n=2, axis=0) / step**2, axis=2).max(axis=0) >= 0.05 * second).any()
    # The integral, by Simpson's rule over the same values.
    weights = np.array([1.0, *[4.0, 2.0] * 11, 4.0, 1.0])
    simpson = step / 3.0 * (weights[:, None, None] * values[:25]).sum(axis=0)
    assert found.total(float(times[24])) == pytest.approx(simpson, abs=2e-4)
    # At the planned time it is a change of velocity in LVLH.
    assert found.at(0.0)[3:] == pytest.approx(drift_after(question, 0, 1.0).lift[3:, 3:], abs=1e-9)
    assert found.at(0.0)[:3] == pytest.approx(np.zeros((3, 3)), abs=1e-6)
