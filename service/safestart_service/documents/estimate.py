"""How long a run would take, before it is submitted, and what that is known from."""

from __future__ import annotations

from statistics import median
from typing import TYPE_CHECKING, Any, Literal

from pydantic import BaseModel, Field

if TYPE_CHECKING:
    from safestart.processes.base import ProcessSpec, WireModel
    from safestart.store.jobs.durations import Durations

Basis = Literal["same inputs", "process", "other inputs"]


class Estimate(BaseModel):
    """How long a run would take once it starts; it waits in the queue besides."""

    basis: Basis | None = Field(
        description="same inputs: measured, earlier runs with the same inputs; process: the process's own estimate "
        "from the inputs; other inputs: measured, earlier runs with other inputs; null: nothing is known."
    )
    seconds: float | None = Field(description="The estimate: the median where it is measured.")
    least_s: float | None = Field(description="The shortest of these runs.")
    most_s: float | None = Field(description="The longest of these runs.")
    runs: int = Field(ge=0, description="Runs that were measured.")


def estimate(spec: ProcessSpec, inputs: WireModel, past: Durations) -> dict[str, Any]:
    """The document: what was measured with the same inputs before what is calculated, and that before the rest."""
    if past.same:
        return _measured("same inputs", past.same)
    cost = spec.cost(inputs)
    if cost > 0.0:
        return {"basis": "process", "seconds": cost, "least_s": None, "most_s": None, "runs": 0}
    if past.other:
        return _measured("other inputs", past.other)
    return {"basis": None, "seconds": None, "least_s": None, "most_s": None, "runs": 0}


def _measured(basis: Basis, times: tuple[float, ...]) -> dict[str, Any]:
    ends = {"least_s": min(times), "most_s": max(times)}
    return {"basis": basis, "seconds": median(times), **ends, "runs": len(times)}
