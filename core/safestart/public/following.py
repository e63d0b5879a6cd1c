"""Follow a job to its end, with a progress bar."""

from __future__ import annotations

import time
from contextlib import AbstractContextManager, nullcontext
from typing import Any

from safestart.errors import JobFailed, Unavailable
from safestart.public.wire import Wire
from safestart.runtime.reporting import Reporting, reporting_on

_WAIT_S = 10
_LEAST_S = 0.2


def followed(wire: Wire, place: str, *, progress: bool, limit_s: float | None) -> str:
    """Wait for the job at ``place`` to succeed; returns its process id.

    Raises ``JobFailed`` if it failed or was dismissed, ``Unavailable`` after ``limit_s`` seconds.
    """
    start = time.monotonic()
    status = wire.get(place)
    with _shown(status["processID"], progress=progress) as context:
        while status["status"] not in ("successful", "failed", "dismissed"):
            tell(context, status)
            left = float("inf") if limit_s is None else limit_s - (time.monotonic() - start)
            if left <= 0.0:
                raise Unavailable(
                    f"{place}: required the end of the job within {limit_s:g} s: {_said(status)}"
                )
            time.sleep(min(_LEAST_S, left))
            most = 1 if progress else _WAIT_S
            status = wire.get(f"{place}?wait={most if left > most else 0}")
    if status["status"] != "successful":
        problem = status.get("problem") or {}
        raise JobFailed(f"{place} {status['status']}: {problem.get('detail') or status.get('message')}")
    return str(status["processID"])


def tell(context: Reporting, status: dict[str, Any]) -> None:
    """Report a job's status document: its progress, or why it waits."""
    if status["status"] == "accepted":
        context.waits(_said(status))
    else:
        context.step(status.get("progress") or 0, 100, _said(status))


def _said(status: dict[str, Any]) -> str:
    return str(status.get("reason") or status.get("message") or status["status"])


def _shown(title: str, *, progress: bool) -> AbstractContextManager[Reporting]:
    if not progress:
        return nullcontext(Reporting())
    from rich.console import Console

    return reporting_on(Console(stderr=True, highlight=False), title)
