"""A real browser (the system's Chromium) on a real ``safestart up``: database, service, worker."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from playwright.sync_api import Browser, BrowserContext, Page, expect, sync_playwright

from tests.acceptance.running import Running, serving
from tests.waiting import PATIENCE_S

CHROMIUM = os.environ.get("SAFESTART_CHROMIUM") or shutil.which("chromium") or shutil.which("google-chrome")
SHOTS = Path(os.environ.get("SAFESTART_SCREENSHOTS", "test-artifacts"))

expect.set_options(timeout=1000 * PATIENCE_S)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Without a browser these tests say so and are skipped."""
    if CHROMIUM is None:
        for item in items:
            if Path(__file__).parent in item.path.parents:
                item.add_marker(
                    pytest.mark.skip(reason="no Chromium: install it, or name it in SAFESTART_CHROMIUM")
                )


@pytest.fixture(scope="session")
def up(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Running]:
    running = Running(tmp_path_factory.mktemp("browser"))
    yield running
    running.stop()


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """For one module: while it lives its event loop runs in this thread, which other tests need for their own."""
    with sync_playwright() as playwright:
        found = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield found
        found.close()


class Visit:
    """A page that records its errors; ``allowed`` are words of console errors that a test expects."""

    def __init__(self, context: BrowserContext, url: str) -> None:
        self.url, self.wrong, self.allowed = url, list[str](), list[str]()
        self.page: Page = context.new_page()
        self.page.set_default_timeout(1000 * PATIENCE_S)
        self.page.on("console", lambda message: self._note(message.type, message.text))
        self.page.on("pageerror", lambda error: self._note("error", str(error)))

    def _note(self, kind: str, text: str) -> None:
        if kind in ("error", "warning"):
            self.wrong.append(text)

    def go(self, path: str) -> Page:
        self.page.goto(self.url + path)
        return self.page

    def faults(self) -> list[str]:
        return [text for text in self.wrong if not any(word in text for word in self.allowed)]

    def shot(self, name: str) -> None:
        SHOTS.mkdir(parents=True, exist_ok=True)
        self.page.screenshot(path=SHOTS / f"{name}.png", full_page=True)


@contextmanager
def visiting(browser: Browser, url: str) -> Iterator[Visit]:
    """A fresh visit at 1280 px; ends with no console error, no exception, no breach of the content policy."""
    context = browser.new_context(viewport={"width": 1280, "height": 900}, accept_downloads=True)
    found = Visit(context, url)
    yield found
    context.close()
    assert found.faults() == []


@pytest.fixture
def visit(browser: Browser, up: Running) -> Iterator[Visit]:
    """A visit of the service with its worker."""
    with visiting(browser, up.url) as found:
        yield found


@pytest.fixture(scope="module")
def url(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """A service for one module, with an empty store and no worker."""
    with serving(f"sqlite:///{tmp_path_factory.mktemp('alone') / 'alone.sqlite3'}") as found:
        yield found
