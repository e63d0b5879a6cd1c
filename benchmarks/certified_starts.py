"""Starts where a false GO of `certified` is likeliest, each GO put to the exact question over up to 600 s.

``python -m benchmarks.certified starts [COUNT] [SEED] [FILE]`` runs it in blocks of about a thousand. FILE gets a line
of JSON for each finished block: stopped and begun again with the same SEED and FILE, it goes on with the first block
that is missing, and COUNT 0 tells what the file holds. A block's draws depend on SEED and its number alone.
"""

from __future__ import annotations

import json
import math
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.peers.manoeuvre_flight import fly
from safestart.closed_form.certified import certify
from safestart.closed_form.manoeuvre import Manoeuvre, manoeuvre_of
from safestart.closed_form.members import Faces
from safestart.dynamics.cwh import input_matrix, transition_matrix
from safestart.exact.answer import Verdict
from safestart.exact.decide import decide
from safestart.exact.question import MAX_STEPS, Question
from safestart.exact.watch import watch_of
from safestart.model.scenario import MAX_RANGE, Chaser, CorridorShape, Floats, Rest, Scenario, Target

HORIZONS = (60.0, 300.0, 600.0)
MOST_TURN = 0.16
"""Radians that the corridor may turn while the exact question holds its thrust: beyond, it asks something else."""

BATCH, BLOCK = 50, 1000
MEAN_MOTIONS = (0.0, 5e-4, 1.1e-3, 1.3e-3)


def question_of(scenario: Scenario, dimensions: int, horizon: float | None = None) -> Question:
    """The `stay` question over ``horizon``, or the longest of 60, 300, 600 s whose grid can follow the corridor."""
    omega = scenario.target.tumble_rate
    if horizon is None:
        horizon = max(t for t in HORIZONS if t == HORIZONS[0] or omega * t / MAX_STEPS <= MOST_TURN)
    steps = min(MAX_STEPS, max(60, math.ceil(horizon * omega / 0.05 / 20.0) * 20))
    return Question(scenario, horizon / steps, steps, dimensions)


def state_of(scenario: Scenario, point: Floats, rest: Rest) -> Floats:
    """LVLH position and velocity (2 d,) of a start at rest."""
    velocity = np.zeros(len(point))
    if rest is Rest.BODY:
        omega = scenario.target.tumble_rate
        velocity[:2] = -omega * point[1], omega * point[0]
    return np.concatenate([point, velocity])


def draw_scenario(rng: np.random.Generator) -> tuple[str, Scenario]:
    """The paper's range, slow tumble or none with weak thrust, strong thrust in any corridor, anything."""
    kind = ("paper", "slow and weak", "any corridor", "anything")[int(rng.integers(4))]
    shape = CorridorShape()
    if kind in ("any corridor", "anything"):
        slopes, sizes = 10.0 ** rng.uniform(-1.0, 0.7, 2), rng.uniform(0.0, 5.0, 2)
        shape = CorridorShape(*slopes.tolist(), *sizes.tolist(), float(rng.uniform(0.0, 3.0)))
    if kind == "paper":
        omega, thrust = rng.uniform(0.5, 5.0), rng.choice([0.01, 0.02, 0.05, 0.1, 0.2])
    elif kind == "slow and weak":
        omega, thrust = rng.choice([0.0, 10.0 ** rng.uniform(-4.0, -0.3)]), 10.0 ** rng.uniform(-6.0, -2.0)
    elif kind == "any corridor":
        omega, thrust = rng.uniform(0.5, 5.0), 10.0 ** rng.uniform(-1.5, 0.0)
    else:
        omega, thrust = rng.choice([0.0, 10.0 ** rng.uniform(-4.0, 1.7)]), 10.0 ** rng.uniform(-6.0, 0.5)
    target = Target(math.radians(float(omega)), float(rng.choice(MEAN_MOTIONS)))
    return kind, Scenario(target, Chaser(float(thrust)), shape)


def draw_starts(
    rng: np.random.Generator, scenario: Scenario, dimensions: int, rest: Rest, count: int = BATCH
) -> Floats:
    """Starts (count, d) up to 10 km away: anywhere, by a face, and half of them at the edge of the certificate."""
    shape, rate = scenario.corridor, scenario.target.tumble_rate + scenario.target.mean_motion
    unit = min(scenario.chaser.max_acceleration / rate**2, 3000.0) if rate > 0.0 else 3000.0
    along = shape.hold_radius + unit * rng.uniform(0.0, 4.0, count)
    sides = rng.uniform(-1.0, 1.0, (2, count))
    hugging = rng.random((2, count)) < 0.25
    sides = np.where(hugging, np.sign(sides) * (1.0 - 10.0 ** rng.uniform(-9.0, -2.0, (2, count))), sides)
    low = rng.random(count) < 0.1
    along = np.where(low, shape.hold_radius + 10.0 ** rng.uniform(-5.0, 0.0, count), along)
    across = sides[0] * (shape.x0 + shape.c_x * (along - shape.hold_radius))
    height = sides[1] * (shape.z0 + shape.c_z * (along - shape.hold_radius))
    points = np.stack([across, along, height], axis=-1)[:, :dimensions]
    # Half of them slide along their ray to the last point that the certificate accepts.
    slide = rng.random(count) < 0.5
    near, far = np.zeros(count), np.full(count, 1.0)
    anchor = np.array([0.0, shape.hold_radius + min(0.2 * unit, shape.hold_radius + 1.0), 0.0])[:dimensions]
    for _ in range(24):
        middle = 0.5 * (near + far)
        go = certify(scenario, anchor + middle[:, None] * (2.0 * points - anchor), rest).go
        near, far = np.where(go, middle, near), np.where(go, far, middle)
    points[slide] = (anchor + near[:, None] * (2.0 * points - anchor))[slide]
    longest = np.sqrt((points**2).sum(axis=-1))
    return points[(longest <= MAX_RANGE) & (longest > 0.0)]


def held_thrusts(question: Question, manoeuvres: list[Manoeuvre], states: Floats) -> Floats:
    """Thrusts (M, N, d) held over the question's intervals that follow the manoeuvres from ``states`` (M, 2 d).

    The mean of the manoeuvre's thrust over each interval, corrected for the place and speed it has come to, within the
    thrust limit. By a face it keeps a little farther inside: holding moves it about its path.
    """
    d, dt, steps, n = question.dimensions, question.dt, question.steps, question.scenario.target.mean_motion
    axes = np.r_[0:d, 3 : 3 + d]
    phi = transition_matrix(n, dt)[np.ix_(axes, axes)].T
    push = input_matrix(n, dt)[axes, :d].T
    nodes = dt * np.arange(steps)
    gauss = dt * (0.5 + 0.5 * math.sqrt(0.6) * np.array([-1.0, 0.0, 1.0]))
    faces = Faces.of(question.scenario.corridor, d)
    swing = question.scenario.target.tumble_rate * question.scenario.chaser.max_acceleration * dt**3
    means, wanted = [], []
    for one in manoeuvres:
        thrust = one.thrust_lvlh((nodes[:, None] + gauss).ravel()).reshape(steps, 3, 3)
        means.append(np.tensordot(thrust, np.array([5.0, 8.0, 5.0]) / 18.0, axes=(1, 0))[:, :d])
        place, velocity, _ = one.motion(nodes)
        near = faces.room(np.stack([one.start, one.start + one.away[-1]], axis=-1)[:d]).min(axis=1) < swing
        place = place + np.pad(-5.0 * swing * faces.normals[near].sum(axis=0), (0, 3 - d))
        c, s = np.cos(one.omega * nodes), np.sin(one.omega * nodes)
        velocity = velocity + np.cross([0.0, 0.0, one.omega], place)
        turned = [
            np.stack([c * v[:, 0] - s * v[:, 1], s * v[:, 0] + c * v[:, 1], v[:, 2]], axis=-1)[:, :d]
            for v in (place, velocity)
        ]
        wanted.append(np.concatenate(turned, axis=-1))
    mean, target = np.array(means), np.array(wanted)
    limit = question.scenario.chaser.max_acceleration * (1.0 - 1e-12)
    state, out = np.array(states), np.empty_like(mean)
    for k in range(steps):
        error = state - target[:, k]
        thrust = mean[:, k] - error[:, :d] * (0.2 / dt**2) - error[:, d:] * (0.7 / dt)
        size = np.sqrt((thrust**2).sum(axis=-1, keepdims=True))
        thrust *= np.minimum(1.0, limit / np.maximum(size, 1e-300))
        out[:, k] = thrust
        state = state @ phi + thrust @ push
    return out


def examine(
    scenario: Scenario, dimensions: int, rest: Rest, points: Floats
) -> tuple[Counter[str], list[dict[str, Any]]]:
    """Every GO among ``points`` put to the exact question; counts, and those that it does not confirm."""
    counts: Counter[str] = Counter(starts=len(points))
    found = certify(scenario, points, rest)
    chosen = points[found.go]
    counts["go"] = len(chosen)
    open_: list[dict[str, Any]] = []
    if not len(chosen):
        return counts, open_
    question = question_of(scenario, dimensions)
    states = np.array([state_of(scenario, point, rest) for point in chosen])
    manoeuvres = [manoeuvre_of(scenario, point, rest) for point in chosen]
    thrusts = held_thrusts(question, [m for m in manoeuvres if m is not None], states)
    watch = watch_of(question)
    for point, state, thrust in zip(chosen, states, thrusts, strict=True):
        counts[f"asked over {question.horizon:g} s"] += 1
        if watch.minima(state, thrust).lowest > 0.0:
            counts["GO by the manoeuvre, held"] += 1
            continue
        answer = decide(question, state, verdict_only=True)
        counts[f"{answer.verdict.value} by the solver"] += 1
        if answer.verdict is Verdict.GO:
            continue
        told = f"{answer.verdict.value} with thrust held, GO by the manoeuvre's own thrust"
        # By a face a manoeuvre may take a tenth of a second, too short for the question's intervals.
        plan = manoeuvre_of(scenario, point, rest)
        assert plan is not None
        flown = fly(scenario, rest, point, plan, question.horizon, 20_000, 1e-12)
        if flown.least > 0.0 and flown.thrust <= 1.0:
            counts[told] += 1
            continue
        open_.append(
            {
                "scenario": repr(scenario),
                "rest": rest.value,
                "point": point.tolist(),
                "flown": [flown.least, flown.thrust],
                "exact": [answer.verdict.value, answer.lower, answer.upper, question.horizon, question.steps],
            }
        )
    return counts, open_


def block(seed: int, number: int) -> dict[str, Any]:
    """Block ``number`` of the study: counts, and the GOs that the exact answer does not confirm."""
    rng = np.random.default_rng([seed, number])
    total: Counter[str] = Counter()
    unconfirmed: list[dict[str, Any]] = []
    begun = time.perf_counter()
    while total["starts"] < BLOCK:
        kind, scenario = draw_scenario(rng)
        dimensions, rest = int(rng.integers(2, 4)), list(Rest)[int(rng.integers(2))]
        points = draw_starts(rng, scenario, dimensions, rest)
        counts, open_ = examine(scenario, dimensions, rest, points)
        total.update(counts)
        total[f"go: {kind}"] += counts["go"]
        total[f"go: {dimensions}-D"] += counts["go"]
        total[f"go: {rest.value}"] += counts["go"]
        unconfirmed += open_
    s = time.perf_counter() - begun
    return {"seed": seed, "block": number, "counts": dict(total), "unconfirmed": unconfirmed, "s": s}


def starts(count: int, seed: int, file: Path | None = None) -> dict[str, Any]:
    """The study over at least ``count`` starts; blocks of the same seed that ``file`` holds count as done."""
    done = {}
    if file is not None and file.exists():
        lines = file.read_text().splitlines(keepends=True)
        # The last line may have been cut short when the run was stopped.
        whole = [line for line in lines if line.endswith("\n")]
        file.write_text("".join(whole))
        done = {one["block"]: one for one in map(json.loads, whole) if one["seed"] == seed}
    total: Counter[str] = Counter()
    unconfirmed: list[dict[str, Any]] = []
    spent, number = 0.0, 0
    while total["starts"] < count or number in done:
        if (one := done.get(number)) is None:
            one = block(seed, number)
            if file is not None:
                with file.open("a") as out:
                    out.write(json.dumps(one) + "\n")
        total.update(one["counts"])
        unconfirmed += one["unconfirmed"]
        spent, number = spent + one["s"], number + 1
        sys.stderr.write(
            f"\r{total['starts']} starts, {total['go']} GO, {len(unconfirmed)} not confirmed, {spent:.0f} s"
        )
        sys.stderr.flush()
    sys.stderr.write("\n")
    return {"seed": seed, "blocks": number, "counts": dict(total), "unconfirmed": unconfirmed, "s": spent}
