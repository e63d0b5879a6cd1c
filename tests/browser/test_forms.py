"""Forms made from schemas: the initial contents of each process's form are valid inputs."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Route, expect

from safestart.processes.registry import PROCESS_IDS, process
from safestart.processes.tracking_mpc.targets import TARGETS
from tests.acceptance.running import serving
from tests.browser.conftest import Visit


@pytest.fixture(scope="module")
def url(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    folder: Path = tmp_path_factory.mktemp("forms")
    with serving(f"sqlite:///{folder / 'forms.sqlite3'}") as found:
        yield found


@pytest.mark.parametrize("name", PROCESS_IDS)
def test_a_form_holds_inputs_that_its_process_takes(browser: Browser, url: str, name: str) -> None:
    context = browser.new_context(viewport={"width": 1280, "height": 900})
    visit, sent = Visit(context, url), list[str]()
    visit.allowed.append("ERR_FAILED")

    def keep(route: Route) -> None:
        sent.append(route.request.post_data or "")
        route.abort()

    page = visit.go(f"/dashboard/submit?process={name}")
    page.route("**/execution", keep)
    page.click("#form button[type=submit]")
    expect(page.locator("#state .problem")).to_contain_text("does not answer")
    process(name).parse(json.loads(sent[0])["inputs"])
    context.close()
    assert visit.faults() == []


def test_a_preset_fills_the_form(browser: Browser, url: str) -> None:
    context = browser.new_context(viewport={"width": 1280, "height": 900})
    visit = Visit(context, url)
    page = visit.go("/dashboard/submit?process=tracking-mpc")
    menu = page.get_by_label("Preset")
    names = menu.locator("option").all_text_contents()
    assert names == ["none: as in the fields", *TARGETS]
    menu.select_option("rocket body, 6 deg/s")
    expect(page.get_by_label("Preset")).to_have_value("rocket body, 6 deg/s")
    expect(page.locator("#in-body_rate_deg_s")).to_have_value("6, 0.4, 0.3")
    page.get_by_label("Preset").select_option("Envisat")
    expect(page.locator("#in-body_rate_deg_s")).to_have_value("0, 3.53, 3.53")
    page.goto(f"{url}/dashboard/submit?process=hop-time")
    expect(page.locator("#form")).to_contain_text("Run now")
    expect(page.locator("#preset")).to_have_count(0)
    context.close()
    assert visit.faults() == []
