"""Every page looks as it did: coarse pictures at three sizes, light and dark, beside those in ``baselines/``.

A page that was changed on purpose gets new ones, to be looked at before they are committed:

    BASELINES=write pytest tests/browser/test_baselines.py

The same visits make the screenshots of docs/pages.md (``just screenshots``).
"""

from __future__ import annotations

import io
import os
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from PIL import Image, ImageFilter
from playwright.sync_api import Browser, Page, expect

from safestart.runtime.access import LOCAL, Role
from safestart.store.access.keys import KeyRepository
from safestart.store.database import Database
from tests.acceptance.running import serving
from tests.browser.baseline import (
    Shades,
    coarse,
    difference,
    read_sheet,
    settle,
    sheet,
    small_file,
    wear_one_font,
)
from tests.browser.conftest import SHOTS, Visit
from tests.browser.stored_runs import fill
from tests.browser.tour import STOPS, Stop

BASELINES = Path(__file__).with_name("baselines")
WRITE = os.environ.get("BASELINES") == "write"
_HARM = """(text) => {
  const sheet = new CSSStyleSheet();
  sheet.replaceSync(text);
  document.adoptedStyleSheets = [sheet];
}"""
SIZES = {(1280, 900): 1400, (768, 1024): 1600, (390, 844): 1800}
"""Screens, and the height (px) of their pages that is compared."""


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, dict[str, str]]]:
    """A service on the same runs every time, and their identifiers."""
    address = f"sqlite:///{tmp_path_factory.mktemp('tour') / 'tour.sqlite3'}"
    found = fill(address)
    with serving(address) as url:
        yield url, found


@pytest.fixture(scope="module")
def guarded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """A service that requires a key."""
    address = f"sqlite:///{tmp_path_factory.mktemp('guarded') / 'guarded.sqlite3'}"
    database = Database(address)
    database.migrate()
    KeyRepository(database).create("reader", Role.READ, 1.0, LOCAL)
    database.close()
    with serving(address) as url:
        yield url


def opened(browser: Browser, url: str, path: str, stop: Stop, size: tuple[int, int]) -> Visit:
    context = browser.new_context(
        viewport={"width": size[0], "height": size[1]}, color_scheme="light", bypass_csp=True
    )
    wear_one_font(context)
    visit = Visit(context, url)
    visit.allowed += ["401", "404", *stop.allowed]
    page = visit.go(path)
    page.wait_for_selector(stop.there, state="attached")
    stop.first(page)
    expect(page.locator(".old, .waiting")).to_have_count(0)
    return visit


def taken(page: Page, scheme: str, height: int) -> Shades:
    """The coarse picture of a page's first ``height`` pixels in one colour scheme."""
    page.emulate_media(color_scheme=scheme)  # type: ignore[arg-type]
    settle(page)
    width = page.viewport_size["width"] if page.viewport_size else 0
    whole = page.evaluate("document.documentElement.scrollHeight")
    clip = {"x": 0, "y": 0, "width": width, "height": min(height, whole)}
    return coarse(page.screenshot(full_page=True, clip=clip, animations="disabled"))  # type: ignore[arg-type]


def test_every_page_is_in_the_docs() -> None:
    docs = Path(__file__).parents[2] / "docs"
    page = (docs / "pages.md").read_text()
    for name in STOPS:
        assert f"](screenshots/{name}.png)" in page
        assert (docs / "screenshots" / f"{name}.png").is_file()


@pytest.mark.parametrize(
    ("change", "is_seen"),
    [
        (lambda page: page.filter(ImageFilter.GaussianBlur(0.6)), False),
        (lambda page: page.resize((page.width + 1, page.height)).crop((0, 0, *page.size)), False),
        (lambda page: page.crop((0, 24, page.width, page.height)), True),
    ],
    ids=["letters smoothed in another way", "a pixel wider", "a line higher"],
)
def test_how_a_machine_draws_letters_is_no_difference(
    change: Callable[[Image.Image], Image.Image], is_seen: bool
) -> None:
    page = Image.open(Path(__file__).parents[2] / "docs/screenshots/explore.png").convert("RGB")
    one, two = io.BytesIO(), io.BytesIO()
    page.save(one, "PNG")
    change(page).save(two, "PNG")
    assert difference(coarse(one.getvalue()), coarse(two.getvalue())).seen is is_seen


@pytest.mark.parametrize("name", STOPS)
def test_a_page_looks_as_it_did(
    browser: Browser, runs: tuple[str, dict[str, str]], request: pytest.FixtureRequest, name: str
) -> None:
    stop, (url, found) = STOPS[name], runs
    if name == "key":
        url = request.getfixturevalue("guarded")
    pictures: list[Shades] = []
    for size, height in SIZES.items():
        visit = opened(browser, url, stop.path.format(**found), stop, size)
        pictures += [taken(visit.page, scheme, height) for scheme in ("light", "dark")]
        if size[0] == 1280:
            visit.page.emulate_media(color_scheme="light")
            settle(visit.page)
            SHOTS.mkdir(parents=True, exist_ok=True)
            (SHOTS / f"{name}.png").write_bytes(small_file(visit.page.screenshot(full_page=True)))
        visit.page.context.close()
        assert visit.faults() == []
    kept = BASELINES / f"{name}.png"
    if WRITE:
        BASELINES.mkdir(exist_ok=True)
        kept.write_bytes(sheet(pictures))
    (SHOTS / f"coarse-{name}.png").write_bytes(sheet(pictures))
    asked = [f"{size[0]} px, {scheme}" for size in SIZES for scheme in ("light", "dark")]
    changed = {
        what: found
        for what, before, now in zip(asked, read_sheet(kept), pictures, strict=True)
        if (found := difference(before, now)).seen
    }
    assert changed == {}, f"{kept} beside {SHOTS / f'coarse-{name}.png'}; {__doc__}"


@pytest.mark.parametrize(
    "harm",
    [
        "#verdict { display: none; }",
        "#controls { order: 1; }",
        "h1 { margin-top: 4rem !important; }",
        ".card { background: #888; }",
        ":root { font-size: 115%; }",
        "#map .main-svg { visibility: hidden; }",
        "nav { display: none !important; }",
    ],
)
def test_a_page_that_is_harmed_is_told(browser: Browser, runs: tuple[str, dict[str, str]], harm: str) -> None:
    """What a user would see is a difference; the same page again is none."""
    stop = STOPS["explore"]
    visit = opened(browser, runs[0], stop.path, stop, (1280, 900))
    before = taken(visit.page, "light", 1400)
    assert not difference(before, taken(visit.page, "light", 1400)).seen
    visit.page.evaluate(_HARM, harm)
    assert difference(before, taken(visit.page, "light", 1400)).seen
    visit.page.context.close()
