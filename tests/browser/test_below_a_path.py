"""The pages behind a real nginx with TLS below a path: no request, no link and no script leaves it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect

from tests.browser.conftest import Visit
from tests.contract.server.nginx import NGINX, fronts

pytestmark = pytest.mark.skipif(NGINX is None, reason="no nginx: apt-get install nginx")


def test_pages_below_a_path(browser: Browser, tmp_path: Path) -> None:
    with fronts(tmp_path, ("as printed",)) as found:
        base = found["as printed"].local(found["as printed"].base)
        context = browser.new_context(ignore_https_errors=True)
        visit, asked = Visit(context, base), list[str]()
        visit.page.on("request", lambda request: asked.append(request.url))
        page = visit.go("/dashboard?omega_t_deg_s=3&a_max_m_s2=0.1&x_m=5&y_m=40")
        expect(page.locator("#verdict")).to_contain_text("GO")
        visit.shot("below-a-path")
        page.get_by_role("link", name="Submit", exact=True).click()
        page.select_option("#process", "benchmark")
        page.get_by_role("button", name="Submit").click()
        expect(page).to_have_url(re.compile(r"/safestart/dashboard/jobs/[0-9a-f-]{36}$"))
        expect(page.locator("#state")).to_contain_text("no worker is connected")
        page.get_by_role("link", name="Jobs", exact=True).click()
        page.locator("#list").get_by_role("link", name="benchmark").click()
        expect(page).to_have_url(re.compile(r"/safestart/dashboard/jobs/[0-9a-f-]{36}$"))
        assert len(asked) > 20
        assert [url for url in asked if not url.startswith(f"{base}/")] == []
        assert visit.faults() == []
        context.close()
