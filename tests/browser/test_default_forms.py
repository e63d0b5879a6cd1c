"""From the form as it opens to a result whose first screen says everything; real jobs, nothing typed.

In CI the quick processes; by hand all of them, some of which take minutes:

    ALL_FORMS=1 pytest tests/browser/test_default_forms.py

Each result page is kept as a picture to look at (SAFESTART_SCREENSHOTS, else test-artifacts).
"""

from __future__ import annotations

import os

import pytest
from playwright.sync_api import expect

from safestart.processes.registry import PROCESS_IDS, process
from tests.browser.conftest import Visit
from tests.browser.first_screen import check_first_screen

QUICK = [name for name in PROCESS_IDS if process(name).light] + ["hold-region", "passive-abort"]
NAMES = list(PROCESS_IDS) if os.environ.get("ALL_FORMS") else QUICK


@pytest.mark.parametrize("name", NAMES)
def test_a_form_as_it_opens_leads_to_a_result(visit: Visit, name: str) -> None:
    page = visit.go(f"/dashboard/submit?process={name}")
    page.click("#form button[type=submit]")
    if not process(name).light:
        page.wait_for_url("**/dashboard/jobs/*")
    expect(page.locator(".first")).to_be_visible()
    check_first_screen(page)
    if not process(name).light:
        expect(page.locator("h1 .status")).to_have_text("successful")
    visit.shot(f"result-{name}")
