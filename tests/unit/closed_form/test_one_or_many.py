"""A start has the same certificate, to the last bit, alone and among others, in NumPy and in plain floats."""

from __future__ import annotations

import math

import numpy as np
import pytest

from safestart.closed_form.paper import Certificate, certify
from safestart.closed_form.paper_point import certify_point, prepare
from safestart.model.scenario import Chaser, CorridorShape, Floats, Rest, Scenario, Target

PAPER = (1.5, 1.5, 2.5, 2.5, 0.5)
FIELDS = ("slack", "slack_rate", "erosion", "face_margin", "range_margin", "margin", "safe")


def drawn(seed: int) -> tuple[Scenario, Rest, Floats, tuple[float, float, tuple[float, ...]]]:
    """A scenario and some starts; half of the starts have round coordinates, where exact zeros come up."""
    rng = np.random.default_rng(seed)
    rate = float(rng.choice([0.0, 3.0, rng.uniform(0.0, 60.0)]))
    thrust = float(rng.choice([0.1, 10.0 ** rng.uniform(-3.0, 1.0)]))
    shape = PAPER if seed % 2 else tuple(rng.uniform(0.01, 5.0, 5).tolist())
    points = rng.uniform(-100.0, 100.0, (int(rng.integers(2, 300)), 2 + seed % 3 % 2))
    if seed % 4 < 2:
        points = np.round(points * 2.0) / 2.0
    scenario = Scenario(Target(math.radians(rate)), Chaser(thrust), CorridorShape(*shape))
    return scenario, list(Rest)[seed // 2 % 2], points, (rate, thrust, shape)


def on_the_boundary(scenario: Scenario, rest: Rest, count: int) -> Floats:
    """Pairs of neighbouring floats across which the verdict changes, found by bisection among others."""
    rng = np.random.default_rng(count)
    go = np.tile([0.0, 20.0], (count, 1))
    no = np.stack([rng.uniform(-200.0, 200.0, count), rng.uniform(-20.0, 200.0, count)], axis=1)
    no = no[~certify(scenario, no, rest).safe]
    go = go[: len(no)]
    for _ in range(80):
        middle = 0.5 * (go + no)
        safe = certify(scenario, middle, rest).safe[:, None]
        go, no = np.where(safe, middle, go), np.where(safe, no, middle)
    return np.concatenate([go, no])


def row(found: Certificate, k: int) -> list[bytes]:
    return [np.ascontiguousarray(getattr(found, name)[k]).tobytes() for name in FIELDS]


@pytest.mark.parametrize("seed", range(24))
def test_alone_as_among_others(seed: int) -> None:
    scenario, rest, points, _ = drawn(seed)
    together = certify(scenario, points, rest)
    for k in range(0, len(points), 5):
        for alone in (points[k], points[k : k + 1], points[k : k + 1, None, :]):
            found = certify(scenario, alone, rest)
            assert row(together, k) == [
                np.ascontiguousarray(getattr(found, name)).tobytes() for name in FIELDS
            ]


@pytest.mark.parametrize("seed", range(24))
def test_in_plain_floats_as_in_arrays(seed: int) -> None:
    scenario, rest, points, (rate, thrust, shape) = drawn(seed)
    together = certify(scenario, points, rest)
    prepared = prepare(rate, thrust, 1.1e-3, shape, rest, points.shape[1])  # type: ignore[arg-type]
    for k, point in enumerate(points.tolist()):
        slack, face_margin, range_margin, margin = certify_point(prepared, tuple(point))
        assert slack == together.slack[k].tolist()
        assert face_margin == together.face_margin[k].tolist()
        assert (range_margin, margin) == (together.range_margin[k], together.margin[k])


@pytest.mark.parametrize("rest", list(Rest))
def test_the_verdict_at_the_boundary(rest: Rest) -> None:
    """Where a last bit decides: a lone row of BLAS, without fused multiply-adds, says otherwise for some of these."""
    scenario = Scenario.of(3.0, 0.1)
    points = on_the_boundary(scenario, rest, 1000)
    safe = certify(scenario, points, rest).safe
    assert len(points) > 1000
    assert safe.any()
    assert not safe.all()
    assert [bool(certify(scenario, point, rest).safe) for point in points] == safe.tolist()
    prepared = prepare(3.0, 0.1, 1.1e-3, PAPER, rest, 2)
    assert [certify_point(prepared, tuple(point)).margin > 0.0 for point in points.tolist()] == safe.tolist()


@pytest.mark.parametrize("count", [2, 3, 4, 5, 7, 8, 15, 16, 17, 33, 100, 1000, 100_000])
def test_however_many_others(count: int) -> None:
    points = np.random.default_rng(count).uniform(-100.0, 100.0, (count, 3))
    scenario = Scenario.of(3.0, 0.1)
    together = certify(scenario, points)
    for k in {0, 1, count // 2, count - 2, count - 1}:
        assert row(together, k) == row(certify(scenario, points[k : k + 1]), 0)
