"""What an answer at once may cost."""

from __future__ import annotations

from safestart_service.errors import AnswerTimeout

SMALL_BYTES = 65_536
"""A larger body is parsed in a helper process: parsing megabytes would hold up everybody else."""
LARGE_S = 2.0
"""Expected cost of a larger body, before anything is known of it: it takes no slot of the quick answers."""


def too_long(limit_s: float, cost_s: float | None = None) -> AnswerTimeout:
    """The refusal of an answer that takes longer than ``limit_s``, or will take about ``cost_s``."""
    why = "it was not there by then" if cost_s is None else f"it would take about {cost_s:.0f} s"
    required = f"a question answered within {limit_s:g} s, or a job"
    return AnswerTimeout(
        f"required {required}; {why}. POST /processes/PROCESS/execution with the header Prefer: respond-async "
        "makes a job, which may take as long as it needs",
        required=required,
        received=None if cost_s is None else round(cost_s),
    )
