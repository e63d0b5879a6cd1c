"""What grows: each curve's work for a given size, prepared apart from its measurement."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np

Work = Callable[[], Any]


@dataclass(frozen=True)
class Curve:
    """Work over its size, for each parameter of ``prepare``; ``amount`` counts what the axis shows for a parameter."""

    title: str
    axis: str
    parameters: tuple[int, ...]
    prepare: Callable[[int], Work]
    amount: Callable[[int], int] = int


def _starts(size: int) -> Any:
    return np.random.default_rng(0).uniform([-226.0, 0.5], [226.0, 150.0], (size, 2))


def _certified(size: int) -> Work:
    from safestart.closed_form.certified import certify
    from safestart.model.scenario import Scenario

    return partial(certify, Scenario.of(3.0, 0.1), _starts(size))


def _atlas(size: int) -> Work:
    from safestart.atlas.survey import build
    from safestart.exact.question import Question
    from safestart.model.scenario import Scenario

    return partial(build(Question(Scenario.of(3.0, 0.1))).bounds, _starts(size))


def _exact(size: int) -> Work:
    from safestart.exact.decide import decide
    from safestart.exact.question import Question
    from safestart.model.scenario import Scenario

    question = Question(Scenario.of(3.0, 0.1))
    states = [np.array([*start, 0.0, 0.0]) for start in _starts(size)]

    def work() -> None:
        for state in states:
            decide(question, state)

    return work


def _horizon(size: int) -> Work:
    from safestart.exact.decide import decide
    from safestart.exact.prove import proof_of
    from safestart.exact.question import Question
    from safestart.model.scenario import Scenario

    question = Question(Scenario.of(1.0, 0.1), steps=size // 2)

    def work() -> None:
        for start in ((-20.0, 40.0), (0.0, 60.0), (5.0, 100.0)):
            state = np.array([*start, 0.0, 0.0])
            proof_of(question, state, decide(question, state))

    return work


def _atlas_horizon(size: int) -> Work:
    from safestart.atlas.survey import build
    from safestart.exact.question import Question
    from safestart.model.scenario import Scenario

    return partial(build, Question(Scenario.of(1.0, 0.1), steps=size // 2))


def _in_space(size: int) -> Work:
    from safestart.processes.execute import execute

    inputs: dict[str, Any] = {
        "starts": [{"position_m": [2, 25, 1], "velocity_m_s": [0, 0, 0], "frame": "body"}],
        "attitude": {
            "kind": "torque_free",
            "inertia_kg_m2": [[17023, 0, 0], [0, 124826, 0], [0, 0, 129112]],
            "attitude_wxyz": [1, 0, 0, 0],
            "body_rate_deg_s": [0.1, 0.1, 0.0],
            "reference": "inertial",
        },
        "orbit": {"mean_motion_rad_s": 0.0011},
        "corridor": {"axis": [0, 1, 0]},
        "thrust": {"kind": "ball", "a_max_m_s2": 0.1},
        "horizon_s": size,
    }
    rates = count()

    def work() -> None:
        # Another tumble each time, as its tables are kept.
        inputs["attitude"]["body_rate_deg_s"][2] = -0.5 - 1e-3 * next(rates)
        execute("start-in-space", inputs)

    return work


def _level_set(size: int) -> Work:
    from safestart.engines.base import Problem
    from safestart.engines.hj.domain import count_steps, size_domain
    from safestart.engines.hj.fused import FusedSolver
    from safestart.engines.hj.options import HamiltonJacobiInput
    from safestart.engines.hj.settings import Settings
    from safestart.engines.hj.target import TargetValues
    from safestart.model.scenario import Scenario, SetKind

    options = HamiltonJacobiInput.model_validate(
        {"accuracy": "low", "frame": "body", "nodes_xy": size, "nodes_v": _velocities(size)}
    )
    problem = Problem(Scenario.of(3.0, 0.1), horizon=4.0, kind=SetKind.TUBE)
    settings = Settings.of(problem, options)
    domain = size_domain(problem, settings.frame)
    steps, courant = count_steps(problem, domain, settings)
    solver = FusedSolver(
        problem, domain, settings, TargetValues.of(problem, domain, settings).terminal, courant
    )
    return partial(solver.advance, 8 * 4.0 / steps)


def _velocities(size: int) -> int:
    """Nodes of a velocity axis: the share that they have of 41 x 41 x 15 x 15."""
    return max(7, round(size * 15 / 41))


def _nodes(size: int) -> int:
    return size**2 * _velocities(size) ** 2


def _square(size: int) -> int:
    return size**2


def _engine(name: str, size: int) -> Work:
    from safestart.engines.backward import Backward
    from safestart.engines.base import Problem
    from safestart.engines.exact import Exact
    from safestart.model.scenario import Grid, Scenario, SetKind
    from safestart.runtime.progress import Context

    engine: Any = {"exact": Exact, "backward": Backward}[name]()
    kind = SetKind.TUBE if name == "exact" else SetKind.FIXED
    problem = Problem(Scenario.of(3.0, 0.1), grid=Grid(size, size, 150.0), kind=kind)
    return partial(engine.solve, problem, Context())


def _sweep(size: int) -> Work:
    from benchmarks.sweep import CELLS, FILTER, shards_s

    return partial(shards_s, {**FILTER, "cases_per_cell": max(size // CELLS, 1), "records": 0})


def _jobs(size: int) -> Work:
    from safestart.processes.execute import execute
    from safestart.store.jobs.repository import JobRepository

    jobs = JobRepository(_database())
    inputs = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "grid": {"nx": 3, "ny": 3, "y_max_m": 150}}

    def work() -> None:
        for number in range(size):
            jobs.submit("certificate", inputs | {"omega_t_deg_s": 1 + number / size}, timeout_s=60.0)
        while claim := jobs.claim("curves", 60.0):
            jobs.succeed(claim, execute(claim.process_id, claim.inputs).document, (), {})

    return work


def _database() -> Any:
    from safestart.store.database import Database

    database = Database(f"sqlite:///{Path(tempfile.mkdtemp()) / 'curves.sqlite3'}")
    database.migrate()
    return database


def _stored(size: int) -> Work:
    from benchmarks.job_list import fill
    from safestart.store.jobs.listing import Listing

    database = _database()
    fill(database, size)
    return partial(Listing(database).list, limit=50)


def _searched(size: int) -> Work:
    from benchmarks.job_list import fill
    from safestart.store.jobs.filters import JobFilter
    from safestart.store.jobs.listing import Listing

    database = _database()
    fill(database, size)
    return partial(Listing(database).list, JobFilter(words=("envisat", "7")), limit=50)


def _tracked(size: int) -> Work:
    from safestart.processes.execute import execute

    return partial(execute, "tracking-mpc", {"study": {"runs": size}})


_TENS = (1_000, 3_000, 10_000, 30_000, 100_000, 300_000, 1_000_000)
_GRIDS = (31, 61, 121, 241, 401)
_HORIZONS = (20, 40, 80, 160, 320, 600)

CURVES: dict[str, Curve] = {
    "certified": Curve("certificate in closed form", "starts", _TENS, _certified),
    "atlas": Curve("verdicts by an atlas", "starts", _TENS, _atlas),
    "exact": Curve("exact answers", "starts", (30, 100, 300, 1_000, 3_000), _exact),
    "exact-horizon": Curve("exact answers with proofs, 3 starts", "s horizon", _HORIZONS, _horizon),
    "atlas-horizon": Curve("an atlas", "s horizon", _HORIZONS, _atlas_horizon),
    "space-horizon": Curve("an answer in space with its proof", "s horizon", _HORIZONS, _in_space),
    "level-set": Curve("level set, 8 steps", "nodes", (11, 21, 31, 41, 51, 61), _level_set, _nodes),
    "exact-cells": Curve("exact tube", "cells", _GRIDS, partial(_engine, "exact"), _square),
    "backward-cells": Curve("backward set", "cells", _GRIDS, partial(_engine, "backward"), _square),
    "sweep": Curve("sweep", "flights", (6_000, 12_000, 30_000, 60_000, 120_000, 300_000), _sweep),
    "tracking": Curve("tracking flights with errors", "flights", (30, 100, 300, 1_000), _tracked),
    "jobs": Curve("jobs through the queue, one after another", "jobs", (30, 100, 300, 1_000), _jobs),
    "list": Curve("a page of the list", "stored jobs", _TENS[:-1], _stored),
    "search": Curve("a search of the list", "stored jobs", _TENS[:-1], _searched),
}
"""The curves, by name."""
