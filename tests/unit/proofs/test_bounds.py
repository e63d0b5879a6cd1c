"""Bounds that the checker takes from formulas hold, and would not with a smaller factor: against plain numbers."""

from __future__ import annotations

import itertools
import json
import math
from types import SimpleNamespace

import numpy as np
import pytest
from flint import arb, arb_mat, arb_poly, fmpq

from safestart.exact.decide import decide
from safestart.exact.prove import proof_of
from safestart.exact.question import Question
from safestart.model.scenario import Scenario
from safestart.proofs.abort.earth.pushes import Pushes
from safestart.proofs.abort.earth.taylor import Field
from safestart.proofs.abort.sets import Reached, column
from safestart.proofs.family import _reach
from safestart.proofs.single import Witness
from safestart.proofs.space.series import folded, rest
from safestart.proofs.statement import read
from safestart.proofs.strict import ProofRejected


def gravity(field: Field, r: np.ndarray) -> np.ndarray:
    """Point mass and J2 about z, also for complex r (3,): minus the gradient of the potential."""
    mu, bulge = float(field.mu), float(field.bulge)
    square, along = r @ r, np.array([0.0, 0.0, 1.0])
    return -mu * r / square**1.5 - bulge / square**2.5 * (
        (1.0 - 5.0 * r[2] ** 2 / square) * r + 2.0 * r[2] * along
    )


def slopes(field: Field, r: np.ndarray, h: float = 1e-6) -> np.ndarray:
    """dg/dr by central differences, (3, 3)."""
    columns = [(gravity(field, r + h * e) - gravity(field, r - h * e)) / (2.0 * h) for e in np.eye(3)]
    return np.stack(columns, axis=1)


@pytest.mark.parametrize(("mu", "bulge"), [(1.0, 0.0), (0.0, 1.0), (1.0, 0.1)])
def test_gravity_and_its_slope_stay_below_their_bounds_and_come_near(mu: float, bulge: float) -> None:
    """Largest on the real polar axis, and by the term z^2 r r' where r . r is small against |r|^2."""
    field = Field(arb(mu), arb(bulge))
    rng = np.random.default_rng(5)
    points = list(rng.normal(size=(200, 3)) + 1j * rng.normal(size=(200, 3)) * rng.uniform(size=(200, 1)))
    points += [np.array([0.0, 0.0, 1.0 + 0j]), *(np.array([1j * s, 0.0, 1.0]) for s in (0.5, 0.9, 0.97))]
    nearest = [0.0, 0.0]
    for r in points:
        size, square = arb(float(np.linalg.norm(r))), arb(float(abs(r @ r)))
        found = (float(np.linalg.norm(gravity(field, r))), float(np.linalg.norm(slopes(field, r), 2)))
        bounds = (float(field.pull(size, square).upper()), float(field.slope(size, square).upper()))
        for k, (value, bound) in enumerate(zip(found, bounds, strict=True)):
            assert value <= bound * (1.0 + 1e-6)
            nearest[k] = max(nearest[k], value / bound)
    assert min(nearest) > 0.3


def test_each_term_of_the_bounds_is_needed() -> None:
    """At r = (i s, 0, 1) the slope of the bulge's pull is beyond what any smaller power of |r|^2 / |r . r| allows."""
    field, r = Field(arb(0), arb(1)), np.array([0.97j, 0.0, 1.0])
    q = float(np.linalg.norm(r) ** 2 / abs(r @ r))
    unit = abs(r @ r) ** -2.5
    assert np.linalg.norm(slopes(field, r), 2) > unit * (3.0 + 30.0 * q + 35.0)
    assert np.linalg.norm(gravity(field, r)) > unit * np.linalg.norm(r) * (3.0 + 5.0)


@pytest.mark.parametrize(("ratio", "order"), [*itertools.product((0.1, 0.4, 0.499), (3, 8))])
def test_the_rest_of_a_series_is_in_its_ball(ratio: float, order: int) -> None:
    tail = 7.0 * ratio ** (order + 1) / (1.0 - ratio)
    ball = rest(arb(7.0), arb(ratio), order)
    assert ball.contains(arb(tail))
    assert ball.contains(arb(-tail))
    if ratio > 0.49:
        assert not ball.contains(arb(1.01 * tail))


@pytest.mark.parametrize("order", [0, 1, 3, 5, 6])
def test_a_folded_series_holds_every_value(order: int) -> None:
    for series in (arb_poly([1.0, -2.0, 3.0, 5.0, -7.0, 11.0]), arb_poly([0.0] * (order + 1) + [4.0])):
        found = folded(series, order)
        assert found.degree() <= order
        for x in (0.0, 0.3, 1.0):
            assert found(arb(x)).contains(series(arb(x)))


def test_a_step_that_is_too_long_has_no_rest() -> None:
    with pytest.raises(ProofRejected, match="too long"):
        rest(arb(1.0), arb(0.5), 5)


ALONG = np.array([3.0, -2.0, 6.0]) / 7.0
RATES = np.array([0.0, 1.0, 2.0, 0.0, 1.0, 2.0]) / 50.0


class Known(Pushes):
    """Pushes along ALONG whose effect on component i turns away with a rate of RATES: f_ij(t) = ALONG_j cos(r_i t)."""

    def __init__(self) -> None:
        self.k = arb(1e-3)

    def at(self, time: fmpq) -> arb_mat:
        return arb_mat([[(arb(time) * r).cos() * a for a in ALONG] for r in RATES.tolist()])

    def _slope(self, first: fmpq, last: fmpq) -> arb_mat:
        t = arb((first + last) / 2) + arb(0, 1) * arb((last - first) / 2)
        return arb_mat([[-r * (t * r).sin() * a for a in ALONG] for r in RATES.tolist()])


def effect(kind: str, push: np.ndarray, time: float) -> np.ndarray:
    """Of a push at ``time``, or held until then: (6,)."""
    if kind == "late":
        return (ALONG @ push) * np.cos(RATES * time)
    return (ALONG @ push) * time * np.sinc(RATES * time / math.pi)


@pytest.mark.parametrize(("first", "last"), [(0, 3), (20, 23), (21, 22)])
def test_a_stuck_thruster_adds_the_integral_of_its_pushes(first: int, last: int) -> None:
    """Up to the middle of the piece; the rest of the piece is a tangent."""
    zero = Reached(column([arb(0)] * 6))
    nothing, push = (arb(0), arb(0)), [arb(e) for e in ALONG.tolist()]
    found = Known().stuck(zero, push, arb(0.5), nothing, fmpq(first), fmpq(last))
    exact = effect("stuck", 0.5 * ALONG, (first + last) / 2.0)
    for i in range(6):
        assert found.centre[i, 0].overlaps(arb(float(exact[i]), 1e-9))
        assert float(found.centre[i, 0].rad()) < 0.6


@pytest.mark.parametrize(("share", "angle"), [(0.3, 0.0), (0.0, 0.4), (0.2, 0.7)])
@pytest.mark.parametrize("kind", ["late", "stuck"])
def test_pushes_that_are_off_stay_in_the_set(kind: str, share: float, angle: float) -> None:
    """Random sizes, directions and times within the limits, integrated in closed form."""
    first, last, size = 20, 23, 0.5
    limits, zero = (arb(share), arb(angle)), Reached(column([arb(0)] * 6))
    impulse, begin, end = [arb(e) for e in (size * ALONG).tolist()], fmpq(first), fmpq(last)
    if kind == "late":
        found = Known().late(zero, impulse, limits, begin, end)
    else:
        found = Known().stuck(zero, impulse, arb(size), limits, begin, end)
    # A block is a ball in its columns: along an axis it reaches as far as their entries' norm.
    reach = [
        sum(math.hypot(*(float(m[i, 0].abs_upper()) for m in block)) for block in found.blocks)
        for i in range(6)
    ]
    rng, most = np.random.default_rng(3), np.zeros(6)
    for _ in range(400):
        across = np.cross(ALONG, rng.normal(size=3))
        across /= np.linalg.norm(across)
        turn = angle * rng.choice([1.0, rng.random()])
        push = size * (1.0 + share * rng.choice([-1.0, 1.0]))
        push = push * (math.cos(turn) * ALONG + math.sin(turn) * across)
        t = rng.choice([first, last, rng.uniform(first, last)])
        value = effect(kind, push, t)
        for i in range(6):
            off = abs(value[i] - float(found.centre[i, 0].mid()))
            assert off <= reach[i] + float(found.centre[i, 0].rad()) + 1e-9
            most[i] = max(most[i], off / reach[i])
    assert most.max() > 0.3 or angle, "the pushes' effect is along one direction"


def test_a_family_reaches_no_less_than_its_farthest_start() -> None:
    """At t = 0 the bound is the start's distance and the box's; one second of thrust later a flight is within it."""
    start, half = [fmpq(90), fmpq(2), fmpq(1), fmpq(0)], [fmpq(3), fmpq(4), fmpq(0), fmpq(0)]
    case = SimpleNamespace(d=2, dt=fmpq(2), steps=30, start=start, a_max=fmpq(1, 10))
    reach = _reach(SimpleNamespace(motions=[fmpq(11, 10_000)], half=half), case)  # type: ignore[arg-type]
    assert float(reach.far) == pytest.approx(math.hypot(90, 2) + 5.0, rel=1e-12)
    assert float(reach.fast) == pytest.approx(1.0, rel=1e-12)
    assert float(reach.within(arb(1)).upper()) > math.hypot(93, 6) + 1.0 + 0.05


def test_the_pieces_of_an_interval_leave_no_gap() -> None:
    """Pieces down to a 64th of the interval where they are refused at first: they tile it."""
    question, state = Question(Scenario.of(3.0, 0.1)), np.array([5.0, 40.0, 0.0, 0.0])
    made = json.loads(json.dumps(proof_of(question, state, decide(question, state))))
    witness = Witness(read(made))
    taken: list[tuple[fmpq, fmpq]] = []

    def piece(_: object, __: object, k: int, centre: fmpq, half: fmpq) -> bool:
        if half > witness.dt / 64 and centre < witness.dt / 2:
            return False
        if k == 0:
            taken.append((centre - half, centre + half))
        return True

    witness._piece = piece  # type: ignore[method-assign,assignment]
    witness.check()
    taken.sort(key=lambda one: float(arb(one[0])))
    assert taken[0][0] == 0
    assert taken[-1][1] == witness.dt
    assert all(before[1] == after[0] for before, after in itertools.pairwise(taken))
