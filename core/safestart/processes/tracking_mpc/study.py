"""The Monte Carlo study of tracking-mpc: outcomes, requirements, shards. Light: the service shows partial results."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from safestart.campaign.combined import Each
from safestart.campaign.design import Repeated
from safestart.campaign.kept import Kept
from safestart.campaign.rates import Share
from safestart.campaign.spread import Spread
from safestart.campaign.study import Study
from safestart.campaign.table import Column, Kind
from safestart.processes.tracking_mpc.spec import TrackingMpcInputs

REQUIREMENTS = ("inside", "within_input", "always_planned", "arrived")
FIGURES = ("least_slack_m", "impulse_m_s", "last_range_m")
WORST = 20


def study_of(inputs: TrackingMpcInputs) -> Study:
    """Requirements, each a flag; what a run cost and where it ended; how often the rows had no plan.

    ``inside``: within the corridor at every node; ``within_input``: no commanded input above the limit;
    ``always_planned``: no step without a plan that keeps every row; ``arrived``: within half a metre at the end.
    """
    study = inputs.study
    columns = [Column(name, Kind.FLAG) for name in REQUIREMENTS]
    columns += [Column(name, Kind.NUMBER) for name in FIGURES]
    columns += [Column("unplanned_steps", Kind.INTEGER)]
    tally = Each(
        {
            "requirements": Each({name: Share(name) for name in REQUIREMENTS}),
            "spreads": Each({name: Spread(name) for name in FIGURES}),
            "worst": Kept(WORST, ("least_slack_m",)),
        }
    )
    runs = 0 if study is None else study.runs
    per_shard = 1 if study is None else study.per_shard
    return Study(Repeated(runs), columns, tally, per_shard, inputs.seed, records=runs)


def split(inputs: TrackingMpcInputs) -> list[dict[str, Any]]:
    """Shards of ``per_shard`` runs; one empty shard without a study."""
    dumped = inputs.model_dump(mode="json")
    if inputs.study is None:
        return [{"inputs": dumped, "first": 0, "count": 0}]
    return study_of(inputs).parts(dumped)


def summary(inputs: TrackingMpcInputs, documents: Iterable[dict[str, Any]]) -> dict[str, Any]:
    """The study so far; null where none was asked for."""
    found = list(documents)
    if inputs.study is None:
        return {"study": None, "shards_done": len(found)}
    total = study_of(inputs).total(found)
    runs = total.said["requirements"]["inside"]["cases"]
    said = {"runs": runs, "variant": inputs.study.variant, **total.said}
    return {"study": said, "shards_done": total.shards}
