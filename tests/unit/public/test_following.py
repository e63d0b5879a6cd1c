"""A job that is followed: while it waits its reason is told, while it runs its progress."""

from __future__ import annotations

from safestart.public.following import tell
from safestart.runtime.reporting import Reporting


def test_a_status_document_is_told_as_a_wait_or_as_a_step() -> None:
    told: list[tuple[object, ...]] = []
    context = Reporting(lambda *step: told.append(step), waits=lambda reason: told.append((reason,)))
    tell(
        context,
        {
            "status": "accepted",
            "progress": 0,
            "reason": "1 job ahead; 1 worker connected",
            "message": "queued",
        },
    )
    tell(context, {"status": "running", "progress": 40, "reason": None, "message": "backward"})
    assert told == [("1 job ahead; 1 worker connected",), (40, 100, "backward")]


def test_the_demo_tells_why_its_job_waits() -> None:
    import httpx

    from safestart.cli.showcase import _follow

    answers = iter([{"status": "accepted", "reason": "next in the queue"}, {"status": "successful"}])
    transport = httpx.MockTransport(lambda _: httpx.Response(200, json=next(answers)))
    told: list[str] = []
    with httpx.Client(base_url="http://demo", transport=transport) as client:
        _follow(client, "1", Reporting(waits=told.append))
    assert told == ["next in the queue"]
