"""Why a job waits, in words."""

from __future__ import annotations

import pytest

from safestart.store.records import Crew, Wait
from safestart_service.documents.jobs_view import waiting_reason


@pytest.mark.parametrize(
    ("wait", "crew", "said"),
    [
        (
            Wait(1, None, None),
            Crew(0, 0, 0),
            "no worker is connected; `safestart worker` starts one; next in the queue",
        ),
        (Wait(1, None, None), Crew(1, 0, 0), "next in the queue; 1 worker connected, still starting"),
        (Wait(2, None, None), Crew(2, 4, 4), "1 job ahead; 2 workers connected, 4 of 4 places taken"),
        (Wait(1, None, None), Crew(1, 2, 1), "next in the queue; 1 worker connected"),
        (
            Wait(6, None, None, 2, 1),
            Crew(1, 1, 1),
            "5 jobs ahead, 2 of higher priority, 1 that came later, as submitters take turns; 1 worker connected, "
            "1 of 1 place taken",
        ),
    ],
)
def test_the_reason_names_what_the_job_waits_for(wait: Wait, crew: Crew, said: str) -> None:
    assert waiting_reason(wait, crew) == said


def test_a_job_that_does_not_wait_has_none() -> None:
    assert waiting_reason(None, Crew(0, 0, 0)) is None
