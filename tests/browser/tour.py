"""Every page of the dashboard once: its address, when it is there, and what is done on it first."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from playwright.sync_api import Page, expect


def _nothing(_: Page) -> None:
    """The page shows all as it opens."""


def _fly(page: Page) -> None:
    expect(page.locator("#verdict .word")).to_be_visible()
    expect(page.locator("#play")).to_be_enabled()


def _answer(page: Page) -> None:
    page.click("text=Run now")
    expect(page.locator(".first .main-svg").first).to_be_visible()


def _start(page: Page) -> None:
    page.click("summary:has(code:text-is('/go-no-go'))")


@dataclass(frozen=True)
class Stop:
    """One page. ``path`` takes the identifiers of the stored runs; ``there`` selects what is there at last."""

    path: str
    there: str
    first: Callable[[Page], None] = _nothing
    allowed: tuple[str, ...] = ()
    """What the browser may say."""


SOFTWARE = ("WebGL", "willReadFrequently")
"""What Chromium says of drawing in space without a graphics card."""
SLIVER = "omega_t_deg_s=2&a_max_m_s2=0.05&x_m=9.364&y_m=81.044"
STOPS: dict[str, Stop] = {
    "explore": Stop(f"/dashboard?{SLIVER}", "#map[data-proved]:not([data-proved=''])", _fly),
    "space": Stop(
        "/dashboard/space",
        "#space[data-digest]:not([data-digest='']):not([data-proved=''])",
        allowed=SOFTWARE,
    ),
    "trade": Stop("/dashboard/trade", "#table tbody tr"),
    "approach": Stop("/dashboard/approach?angle_deg=0", "#burns tbody tr"),
    "submit": Stop("/dashboard/submit?process=benchmark", "#estimate:not(:empty)"),
    "answer": Stop("/dashboard/submit?process=flight", "#in-horizon_s", _answer),
    "jobs": Stop("/dashboard/jobs", ".jobs tbody tr"),
    "job-findings": Stop("/dashboard/jobs/{safety}", ".findings tbody tr"),
    "job-benchmark": Stop("/dashboard/jobs/{fast}", ".masks .main-svg"),
    "job-waiting": Stop("/dashboard/jobs/{waiting}", "#tools button"),
    "compare": Stop("/dashboard/compare?jobs={slow},{fast}", "#compare .main-svg"),
    "api": Stop("/docs", "details", _start),
    "not-found": Stop("/dashboard/nowhere", "h1"),
    "key": Stop("/dashboard/jobs", "#key"),
}
"""Pages by the name of their picture. ``key`` is at a service that requires keys."""
