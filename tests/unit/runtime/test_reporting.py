"""What a person reads while work waits and runs: why it waits, and how long the run still takes."""

from __future__ import annotations

import io
import time

import pytest
from rich.console import Console

from safestart.runtime.reporting import reporting_on

STARTING = "next in the queue; 1 worker connected, still starting"


class Clock:
    """A time that a test moves."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now = 1000.0
        monkeypatch.setattr(time, "monotonic", lambda: self.now)


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    return Clock(monkeypatch)


def test_a_wait_is_explained_again_and_again(clock: Clock) -> None:
    out = io.StringIO()
    with reporting_on(Console(file=out), "benchmark") as context:
        for _ in range(13):
            context.waits(STARTING)
            clock.now += 1.0
    assert out.getvalue().splitlines()[:-1] == [
        f"benchmark waits: {STARTING} ({seconds} s)" for seconds in (0, 5, 10)
    ]


def test_the_estimate_counts_from_the_run_not_from_the_wait(clock: Clock) -> None:
    out = io.StringIO()
    with reporting_on(Console(file=out), "benchmark") as context:
        context.waits(STARTING)
        clock.now += 120.0
        context.step(0, 100, "starting")
        clock.now += 10.0
        context.step(20, 100, "backward")
    assert out.getvalue().splitlines()[1:] == [
        "benchmark:   0 % starting (0 s)",
        "benchmark:  20 % backward (10 s, 40 s left)",
        "benchmark: done in 130.0 s",
    ]


def test_the_estimate_counts_the_work_from_where_it_was_first_seen(clock: Clock) -> None:
    """Loading precedes the first step of work in this process, and half of a job may be done when one asks."""
    out = io.StringIO()
    with reporting_on(Console(file=out), "benchmark") as context:
        clock.now += 60.0
        context.step(50, 100, "forward")
        clock.now += 10.0
        context.step(75, 100, "forward")
    assert "75 % forward (70 s, 10 s left)" in out.getvalue()


def test_a_run_that_waits_again_begins_anew(clock: Clock) -> None:
    """Its worker was lost."""
    out = io.StringIO()
    with reporting_on(Console(file=out), "benchmark") as context:
        context.step(80, 100, "forward")
        context.waits("no worker is connected")
        clock.now += 1.0
        context.step(0, 100, "starting, attempt 2")
    assert "waits: no worker is connected" in out.getvalue()
    assert "0 % starting, attempt 2 (0 s)" in out.getvalue()


def test_on_a_terminal_a_reason_stands_above_the_bar_once() -> None:
    out = io.StringIO()
    console = Console(file=out, force_terminal=True, width=120, color_system=None)
    with reporting_on(console, "benchmark") as context:
        context.waits(STARTING)
        context.waits(STARTING)
        context.step(1, 2, "forward")
    assert out.getvalue().count(f"benchmark waits: {STARTING}") == 1
    assert "100%" in out.getvalue()
