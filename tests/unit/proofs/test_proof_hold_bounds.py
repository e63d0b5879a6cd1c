"""The hold's bounds against flights: distances, speed and thrust from its boundary, between and at the instants."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from flint import arb, arb_mat, fmpq

from safestart.exact.answer import Held
from safestart.exact.decide import decide
from safestart.exact.hold_after import held_after, with_hold
from safestart.model.scenario import Chaser, Scenario, Target
from safestart.proofs.balls import Motion
from safestart.proofs.hold.check import Hold, _At, _require_positive
from safestart.proofs.single import Witness
from safestart.proofs.statement import read
from safestart.proofs.strict import ProofRejected
from tests.unit.proofs.forgery import Document, changed
from tests.unit.proofs.holding import QUESTION, SHAPE, START, loop_of, made, steps, turned


@pytest.fixture(scope="module")
def document() -> Document:
    return made(QUESTION, START)


@pytest.mark.parametrize("seed", range(4))
def test_a_thousand_flights_from_the_boundary_stay(seed: int) -> None:
    """250 flights each, by matrix exponentials, from the boundary at any angle of the body, worst directions among
    them; each step watched at 20 instants until the error is a hundredth."""
    question = replace(QUESTION, speed_limit=(None, 0.4, None, 1.5)[seed])
    rate = (0.05, 0.05, 0.0, 0.02)[seed]
    question = replace(question, scenario=Scenario(Target(rate, 1.1e-3), Chaser(0.02), SHAPE))
    end = np.r_[0.1, 1.5, 0.002, -0.003] + np.r_[0.0, 0.0, -rate * 1.5, rate * 0.1]
    held = held_after(question, end, 0.0)
    assert held is not None
    state_at, thrust_at = loop_of(question, held)
    assert (end - state_at(0.0)) @ held.cost @ (end - state_at(0.0)) <= held.level
    n, dt = question.scenario.target.mean_motion, question.dt
    parts = [steps(n, dt * j / 20) for j in range(21)]
    rng = np.random.default_rng(seed)
    root = math.sqrt(held.level) * np.linalg.inv(np.linalg.cholesky(held.cost)).T
    shell = rng.normal(size=(250, 4))
    # Half of them go farthest in some direction at some instant of the first step.
    for k in range(125):
        phi, b = parts[int(rng.integers(21))]
        shell[k] = root.T @ (phi + b @ held.gain)[:2].T @ rng.normal(size=2)
    errors = (shell / np.linalg.norm(shell, axis=1)[:, None]) @ root.T
    angle = rng.uniform(0.0, 2.0 * math.pi, 250)
    states = np.array([state_at(t) for t in angle]) + errors
    least, most, fast = math.inf, 0.0, 0.0
    for _ in range(60):
        wanted, given = (np.array([f(t) for t in angle]) for f in (state_at, thrust_at))
        given = given + (states - wanted) @ held.gain.T
        most = max(most, float(np.linalg.norm(given, axis=1).max()))
        for j, (phi, b) in enumerate(parts):
            seen = states @ phi.T + given @ b.T
            fast = max(fast, float(np.linalg.norm(seen[:, 2:], axis=1).max()))
            body = np.array(
                [turned(p, -(t + rate * dt * j / 20)) for p, t in zip(seen[:, :2], angle, strict=True)]
            )
            sides = 3.0 + 1.2 * (body[:, 1] - 0.75) - np.abs(body[:, 0])
            least = min(least, float((body[:, 1] - 0.75).min()), float(sides.min()) / math.hypot(1.0, 1.2))
        states, angle = seen, angle + rate * dt
    assert least >= held.margin
    assert most <= question.scenario.chaser.max_acceleration
    assert question.speed_limit is None or fast <= question.speed_limit
    # The set is no smaller than it need be: some flight comes near the margin, or a limit.
    near = least < held.margin + 0.1 * (held.point[1] - 0.75)
    assert near or most > 0.9 * 0.02 or fast > 0.9 * (question.speed_limit or math.inf)
    assert float(np.linalg.norm(states - np.array([state_at(t) for t in angle]), axis=1).max()) < 1e-3


def loop(document: Document, **change: Any) -> Hold:
    """The checker's own loop of a document, at its precision."""
    stated = read(document)
    assert stated.held is not None
    faces = Witness(stated).faces
    return Hold(
        replace(stated.held, **change), Motion(stated), arb(stated.dt), faces, arb(stated.a_max), arb("1.5")
    )


def test_the_bounds_are_those_of_the_ellipsoid(document: Document) -> None:
    """Distances, distance from the target and speed at instants of a step, against thousands of errors and angles."""
    question = replace(QUESTION, scenario=replace(QUESTION.scenario, target=Target(0.2, 1.3e-3)))
    claim = document["hold_after"]
    held = Held(np.array([0.6, 1.9]), np.array(claim["gain"]), np.array(claim["cost"]), 1.2, 0.1)
    turning = changed(document, "question.tumble_rate_rad_s", 0.2)
    turning = changed(turning, "question.mean_motion_rad_s", 1.3e-3)
    hold = loop(turning, point=[fmpq(3, 5), fmpq(19, 10)], level=fmpq(6, 5))
    state_at, thrust_at = loop_of(question, held)
    root = math.sqrt(held.level) * np.linalg.inv(np.linalg.cholesky(held.cost)).T
    angles = np.linspace(0.0, 2.0 * math.pi, 90, endpoint=False)
    wanted, given = (np.array([f(t) for t in angles]) for f in (state_at, thrust_at))
    for share in (0.0, 0.3, 0.5, 1.0):
        phi, b = steps(1.3e-3, 2.0 * share)
        image = (phi + b @ held.gain) @ root
        seen = wanted @ phi.T + given @ b.T
        place, fast = (np.linalg.svd(image[k : k + 2], compute_uv=False)[0] for k in (0, 2))
        body = np.array([turned(p, -(t + 0.4 * share)) for p, t in zip(seen[:, :2], angles, strict=True)])
        found = hold._bounds(arb(2.0 * share))
        for name, normal, offset in (
            ("hold_plane", [0.0, -1.0], -0.75),
            ("right", [1.0, -1.2], 3.0 - 1.2 * 0.75),
            ("left", [-1.0, -1.2], 3.0 - 1.2 * 0.75),
        ):
            length = math.hypot(*normal)
            least = float(((offset - body @ normal) / length).min()) - place
            assert float(found.left[name]) == pytest.approx(least, abs=2e-8)
        farthest = float(np.linalg.norm(seen[:, :2], axis=1).max()) + place
        assert farthest - 1e-9 <= float(found.far) <= farthest + 1e-2
        assert float(found.fast) == pytest.approx(
            float(np.linalg.norm(seen[:, 2:], axis=1).max()) + fast, abs=1e-4
        )
        over = hold._bounds(arb(2.0 * share) + arb(1, 1) / 100)
        assert float(over.far.abs_upper()) >= float(found.far)
        assert float(over.fast.abs_upper()) >= float(found.fast)


@pytest.mark.parametrize("more", [-1e-9, 1e-9])
def test_between_two_instants_it_may_fall_by_so_much(document: Document, more: float) -> None:
    """h^2 / 8 of a_max + 3 n^2 r + 2 n v + 2 w v + w^2 r; the speed rises by h / 2 of the first three."""
    hold = loop(document)
    n, w, far, fast, h = 1.1e-3, 0.05, 900.0, 40.0, 0.5
    push = 0.02 + 3.0 * n * n * far + 2.0 * n * fast
    sag = h * h / 8.0 * (push + 2.0 * w * fast + w * w * far)
    calm = _At(dict.fromkeys(hold.faces, arb(1)), arb(0), arb(0))
    over = _At(calm.left, arb(far), arb(fast))
    hold.margin, hold.speed = arb(1.0 - sag + more), None
    for before, after in ((calm, replace(calm, left=calm.left | {"left": arb(2)})),):
        for pair in ((before, after), (after, before)):
            if more > 0.0:
                with pytest.raises(ProofRejected, match="the distance to"):
                    hold._require(*pair, over, arb(h))
            else:
                hold._require(*pair, over, arb(h))
    hold.margin = arb("0.1")
    for pair in ((calm, replace(calm, fast=arb(3))), (replace(calm, fast=arb(3)), calm)):
        hold.speed = arb(3.0 + h / 2.0 * push - more)
        if more > 0.0:
            with pytest.raises(ProofRejected, match="the speed"):
                hold._require(*pair, over, arb(h))
        else:
            hold._require(*pair, over, arb(h))


def test_pivots_tell_a_positive_matrix() -> None:
    rng = np.random.default_rng(4)
    for _ in range(20):
        half = rng.normal(size=(4, 4))
        _require_positive(arb_mat((half @ half.T + 0.01 * np.eye(4)).tolist()), "")
    for i in range(4):
        for j in range(i):
            # Its diagonal is positive, its least eigenvalue -0.1.
            bent = np.eye(4)
            bent[i, j] = bent[j, i] = 1.1
            with pytest.raises(ProofRejected, match="bent"):
                _require_positive(arb_mat(bent.tolist()), "bent")


def test_its_pieces_tile_the_step(document: Document, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each span between two neighbouring instants is enclosed whole, from the first to the last of the step."""
    hold, whole, asked = loop(document), Hold._bounds, []

    def noted(self: Hold, s: arb) -> _At:
        asked.append((float(s.mid() - s.rad()), float(s.mid() + s.rad())))
        return whole(self, s)

    monkeypatch.setattr(Hold, "_bounds", noted)
    answer = with_hold(QUESTION, START, decide(QUESTION, START))
    assert answer.thrust is not None
    phi, held = Motion(read(document)).over(arb(2))
    state = phi * arb_mat(4, 1, START.tolist()) + held * arb_mat(2, 1, answer.thrust[0].tolist())
    hold.check(state, arb(2))
    instants = sorted(low for low, high in asked if high - low < 1e-6)
    spans = sorted((low, high) for low, high in asked if high - low > 1e-6)
    assert (instants[0], instants[-1]) == (0.0, 2.0)
    assert len(spans) == len(instants) - 1 >= 8
    for (low, high), before, after in zip(spans, instants, instants[1:], strict=False):
        assert low <= before + 1e-9
        assert high >= after - 1e-9
        assert high - low < 1.01 * (after - before)
