"""Forms made from schemas: a new form asks the example of its process, one of a job what that job was asked."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import httpx
import pytest
from playwright.sync_api import Browser, Route, expect

from safestart.processes.registry import PROCESS_IDS, process
from safestart.processes.tracking_mpc.targets import TARGETS
from tests.browser.conftest import Visit


@pytest.mark.parametrize("name", PROCESS_IDS)
def test_a_new_form_asks_the_example(browser: Browser, url: str, name: str) -> None:
    spec = process(name)
    assert spec.parse(sent_from(browser, f"{url}/dashboard/submit?process={name}")) == spec.parse(
        spec.example
    )


SHORT = {
    "approach-trade": {"angles_deg": [0, 90]},
    "sweep": {},
    "passive-abort": process("passive-abort").example | {"keep_out_m": 40.0},
    "tracking-mpc": {"n_c": 2},
}
"""Questions without what the examples ask in addition."""


@pytest.mark.parametrize("name", SHORT)
def test_a_form_of_a_job_holds_what_that_job_was_asked(browser: Browser, url: str, name: str) -> None:
    """Seen: a demand of the example stood in the form of a job that had none."""
    spec = process(name)
    answer = httpx.post(
        f"{url}/processes/{name}/execution", json={"inputs": SHORT[name]}, headers={"Prefer": "respond-async"}
    )
    asked = f"{url}/dashboard/submit?process={name}&from={answer.json()['jobID']}"
    assert spec.parse(sent_from(browser, asked)) == spec.parse(SHORT[name])


def test_the_text_of_a_file_comes_from_a_file(browser: Browser, url: str, tmp_path: Path) -> None:
    """Seen: an ephemeris in a field of one line lost its line breaks."""
    course = tmp_path / "chaser.oem"
    course.write_text("CCSDS_OEM_VERS = 3.0\nORIGINATOR = ME\n")
    context = browser.new_context(viewport={"width": 1280, "height": 900})
    visit = Visit(context, url)
    page = visit.go("/dashboard/submit?process=commit-timeline")
    page.get_by_label("Chaser, from a file").set_input_files(course)
    expect(page.locator("#in-chaser")).to_have_value(course.read_text())
    visit.shot("form-of-files")
    context.close()
    assert visit.faults() == []


def sent_from(browser: Browser, address: str) -> dict[str, Any]:
    """The inputs that a form would send, as it opens."""
    context = browser.new_context(viewport={"width": 1280, "height": 900})
    visit, sent = Visit(context, address), list[str]()
    visit.allowed.append("ERR_FAILED")

    def keep(route: Route) -> None:
        sent.append(route.request.post_data or "")
        route.abort()

    page = visit.go("")
    page.route("**/execution", keep)
    page.click("#form button[type=submit]")
    expect(page.locator("#state .problem")).to_contain_text("does not answer")
    context.close()
    assert visit.faults() == []
    found: dict[str, Any] = json.loads(sent[0])["inputs"]
    return found


def test_a_preset_fills_the_form(browser: Browser, url: str) -> None:
    context = browser.new_context(viewport={"width": 1280, "height": 900})
    visit = Visit(context, url)
    page = visit.go("/dashboard/submit?process=tracking-mpc")
    menu = page.get_by_label("Preset")
    expect(menu.locator("option")).to_have_text(["none: as in the fields", *TARGETS])
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
