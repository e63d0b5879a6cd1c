"""The proof atlas: building it, one answer with its proof, and 100 000 starts. No peer answers this; absolute times."""

from __future__ import annotations

import numpy as np

from benchmarks.timing import median_seconds
from safestart.atlas.survey import build
from safestart.exact.question import Question
from safestart.model.scenario import Scenario

RATE_DEG_S, THRUST = 3.0, 0.1
STARTS, SINGLE = 100_000, 200


def measure() -> dict[str, dict[str, float]]:
    """Medians at 3 deg/s, 0.10 m/s^2, 60 s, gap 0.5 %, cut at 150 m."""
    question = Question(Scenario.of(RATE_DEG_S, THRUST))
    atlas = build(question)
    starts = np.random.default_rng(0).uniform([-226.0, 0.5], [226.0, 150.0], (STARTS, 2))

    def singly() -> None:
        for start in starts[:SINGLE]:
            atlas.answer(start)

    return {
        "ratios": {},
        "times": {
            "atlas_build_s": median_seconds(lambda: build(question), 5),
            "atlas_answer_s": median_seconds(singly, 5) / SINGLE,
            "atlas_100k_starts_s": median_seconds(lambda: atlas.bounds(starts), 9),
        },
    }
