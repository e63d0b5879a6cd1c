"""A toy campaign: a point drifts along a line, pushed at random, and must stay within a limit for a while."""

from __future__ import annotations

from typing import Any

from safestart.campaign.case import Case
from safestart.campaign.combined import Each, Grouped
from safestart.campaign.design import Design, Drawn
from safestart.campaign.kept import Kept
from safestart.campaign.rates import Confusion, Share
from safestart.campaign.spread import Spread
from safestart.campaign.study import Study
from safestart.campaign.table import Column, Kind
from safestart.campaign.tally import Known, Rows, Total, Values
from safestart.runtime.progress import Context

STEPS = 30
SEED = 11
OUTCOME = (
    Column("speed", Kind.NUMBER),
    Column("limit", Kind.NUMBER),
    Column("promised", Kind.FLAG),
    Column("stayed", Kind.FLAG),
    Column("margin", Kind.NUMBER),
    Column("left_at", Kind.SMALL),
    Column("push", Kind.NUMBER),
    Column("failure", Kind.TEXT),
    Column("decade", Kind.INTEGER, recorded=False),
)
TALLY = Each(
    {
        "cases": Rows(),
        "stayed": Share("stayed"),
        "promise": Confusion("promised", "stayed"),
        "push": Spread("push", "stayed"),
        "left": Known("left_at"),
        "steps": Total("left_at"),
        "failures": Values("failure"),
        "by_decade": Grouped("decade", Each({"cases": Rows(), "stayed": Share("stayed")})),
        "worst": Kept(4, ("stayed", "margin"), "promised"),
    }
)


def study(
    count: int = 400, per_shard: int = 64, records: int = 10_000, design: Design | None = None
) -> Study:
    """Speeds and limits drawn evenly; every seventh walk breaks down, every fifth is promised nothing."""
    drawn = Drawn({"speed": (-0.1, 0.1), "limit": (1.0, 4.0)}, count, SEED, block=50)
    return Study(design or drawn, OUTCOME, TALLY, per_shard, SEED, records)


def walk(case: Case, context: Context) -> dict[str, Any]:
    """One walk, in plain Python."""
    context.step(1, 1, "walks")
    speed, limit = case.parameters["speed"], case.parameters["limit"]
    promised = None if case.index % 5 == 0 else abs(speed) * STEPS < limit
    outcome = {"speed": speed, "limit": limit, "promised": promised, "decade": case.index // 10}
    if case.index % 7 == 0:
        lost = {"stayed": False, "margin": float("nan"), "left_at": None, "push": float("inf")}
        return outcome | lost | {"failure": "diverged"}
    at, margin, push, left_at = 0.0, limit, 0.0, None
    for step, noise in enumerate(case.generator().normal(0.0, 0.2, STEPS).tolist()):
        at += speed + noise
        push += abs(noise)
        margin = min(margin, limit - abs(at))
        if margin < 0.0 and left_at is None:
            left_at = step
    stayed = left_at is None
    return outcome | {"stayed": stayed, "margin": margin, "left_at": left_at, "push": push, "failure": None}
