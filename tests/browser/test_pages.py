"""Each page's main path, in Chromium, against a real worker and database."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Browser, Page, expect

from safestart.proofs.single import check
from safestart.runtime.access import LOCAL, Role
from safestart.store.access.keys import KeyRepository
from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from tests.acceptance.running import Running, serving
from tests.browser.conftest import SHOTS, Visit
from tests.waiting import until

SLIVER = "omega_t_deg_s=2&a_max_m_s2=0.05&x_m=9.364&y_m=81.044"
"""Certified by the paper's conditions; no thrust held over steps of 2 s stays."""
SMALL = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "grid": {"nx": 21, "ny": 21, "y_max_m": 150}}
QUICK = ["analytical", "exact", "backward", "monte_carlo"]
SLOW = SMALL | {
    "horizon_s": 600,
    "engines": ["hamilton_jacobi"],
    "hamilton_jacobi": {"frame": "body", "accuracy": "very_high"},
}
"""Half a minute on a quiet machine: long enough to be looked at and killed in the middle."""
LONG = {
    "omega_t_deg_s": [0.1 * i for i in range(1, 51)],
    "a_max_m_s2": [0.01 * i for i in range(1, 11)],
    "grid": {"nx": 1000, "ny": 1000, "y_max_m": 150},
}
"""A coverage of half a minute in small steps: to be cancelled."""
_AT_PRINTING = """() => {
  // Chromium asks the media again once the page has its width on paper, just before it is painted.
  matchMedia("print").addEventListener("change", ({ matches }) => {
    if (!matches) return;
    const size = (one) => { const { width, height } = one.getBoundingClientRect(); return [width, height]; };
    const charts = [...document.querySelectorAll(".chart")];
    window.printed = charts.map((place) => [place, place.querySelector(".main-svg")].map(size));
  });
}"""


@pytest.fixture(scope="module")
def benchmarks(up: Running) -> list[str]:
    """Two finished benchmarks."""
    jobs = [up.submit(SMALL | {"engines": QUICK, "omega_t_deg_s": rate}) for rate in (1, 3)]
    for job in jobs:
        up.outcome(job)
    return jobs


def holds(page: Page, true: str) -> None:
    """Wait for an expression to hold; asked from here, as the pages' policy forbids Playwright's own eval."""
    until(lambda: page.evaluate(true), true)


def explore(visit: Visit, query: str = "") -> Page:
    page = visit.go(f"/dashboard{'?' if query else ''}{query}")
    page.wait_for_selector("#map[data-proved]", state="attached")
    return page


def test_a_new_user_flies_a_start(visit: Visit) -> None:
    page = explore(visit)
    box = page.locator("#map .nsewdrag").first.bounding_box()
    assert box is not None
    page.mouse.click(box["x"] + 0.5 * box["width"], box["y"] + 0.72 * box["height"])
    expect(page.locator(".answer .word").first).to_have_text(re.compile("GO"))
    expect(page.locator("#play")).to_be_enabled()
    page.click("#play")
    expect(page.locator("#play")).to_have_text("Pause")
    holds(page, "Number(document.getElementById('clock').value) > 5")
    page.click("#play")
    expect(page).to_have_url(re.compile("x_m="))
    address = page.url
    page.reload()
    expect(page.locator(".answer .word").first).to_have_text(re.compile("GO"))
    assert page.url == address, "the address holds the state"
    page.select_option("#frame", "lvlh")
    expect(page.locator("#map .xtitle")).to_contain_text("LVLH")
    visit.shot("explore-lvlh")


def test_explore_shows_where_the_paper_is_wrong(visit: Visit, tmp_path: Path) -> None:
    page = explore(visit, SLIVER)
    words = page.locator(".answer .word")
    expect(words.nth(0)).to_have_text("NO GO")
    expect(page.locator(".closed-word")).to_have_text("GO")
    with page.expect_download() as download:
        page.click("text=Download the proof")
    proof = tmp_path / "proof.json"
    download.value.save_as(proof)
    assert check(json.loads(proof.read_text())).verdict == "NO_GO"
    visit.shot("explore")


def test_a_slider_redraws(visit: Visit) -> None:
    page = explore(visit)
    for rate in (2.0, 2.5, 3.5, 4.0, 5.0, 3.0, 2.0):
        page.evaluate("delete document.getElementById('map').dataset.drawnMs")
        page.locator('input[data-for="omega_t_deg_s"]').evaluate(
            "(field, rate) => { field.value = rate; field.dispatchEvent(new Event('input', {bubbles: true})); }",
            rate,
        )
        holds(page, "document.getElementById('map').dataset.drawnMs")
        assert float(page.input_value("#omega_t_deg_s")) == rate
    page.locator("#omega_t_deg_s").fill("2.2")
    expect(page).to_have_url(re.compile("omega_t_deg_s=2.2"))
    page.locator("#omega_t_deg_s").fill("99")
    expect(page.locator("#map-state .problem")).to_contain_text("60")
    visit.allowed.append("422")


def test_uncertainty_and_the_hold_point(visit: Visit) -> None:
    page = explore(visit, "x_m=2&y_m=30")
    expect(page.locator(".answer .word").first).to_have_text("GO")
    page.locator("summary", has_text="Uncertainty").click()
    page.fill("#position_half_width_m", "0.5")
    expect(page.locator(".answer h2").first).to_contain_text("proved for all within the ranges")
    page.fill("#position_half_width_m", "60")
    expect(page.locator(".answer .word").first).to_have_text("UNDECIDED")
    page.fill("#position_half_width_m", "0")
    page.select_option("#question", "synchronize")
    expect(page.locator("#within_s")).to_be_visible()
    expect(page.locator(".answer .why")).to_contain_text("at rest in the hold ball")
    expect(page).to_have_url(re.compile("question=synchronize"))


def test_hover_tells_margins(visit: Visit) -> None:
    page = explore(visit)
    box = page.locator("#map .nsewdrag").first.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.6 * box["height"])
    expect(page.locator("#cursor")).to_contain_text("hold plane")


def test_trade_study_leads_to_explore(visit: Visit) -> None:
    page = visit.go("/dashboard/trade")
    expect(page.locator("#table tbody tr")).to_have_count(20)
    with page.expect_download() as download:
        page.click("text=CSV")
    assert Path(download.value.path()).read_text().startswith("omega_t_deg_s,required_a_max_m_s2")
    visit.shot("trade")
    page.locator("#table a").nth(3).click()
    expect(page.locator(".closed-word")).to_have_text("GO")


def test_a_benchmark_from_form_to_result(visit: Visit) -> None:
    page = visit.go("/dashboard/submit?process=benchmark")
    expect(page.locator("#in-omega_t_deg_s")).to_be_visible()
    page.fill("#in-omega_t_deg_s", "99")
    page.click("button[type=submit]")
    expect(page.locator("#state .problem")).to_contain_text("omega_t_deg_s")
    expect(page.locator("#in-omega_t_deg_s")).to_have_attribute("aria-invalid", "true")
    visit.allowed.append("422")
    page.fill("#in-omega_t_deg_s", "3")
    for name in ("nx", "ny"):
        page.locator(f'[id="in-grid.{name}"]').fill("21")
    page.locator(".rare").evaluate_all("(all) => all.forEach((one) => { one.open = true; })")
    page.select_option('[id="in-hamilton_jacobi.accuracy"]', "low")
    page.locator('[data-path="engines"] label', has_text="forward").locator("input").uncheck()
    page.click("button[type=submit]")
    page.wait_for_url(re.compile("/dashboard/jobs/[0-9a-f-]{36}"))
    page.reload()
    expect(page.locator("h1 .status")).to_have_text("successful")
    expect(page.locator(".matrix")).to_have_count(4)
    expect(page.locator(".masks .nsewdrag").first).to_be_visible()
    expect(page.locator(".agreement")).to_contain_text("cells")
    expect(page.locator(".masks .legendtext")).to_have_count(4)
    expect(page.locator("text=paper: IoU with HJ")).to_be_visible()
    with page.expect_download() as download:
        page.click("a[download='maps.npz']")
    assert Path(download.value.path()).read_bytes()[:2] == b"PK"
    visit.shot("benchmark")
    page.evaluate(_AT_PRINTING)
    report = page.pdf(format="A4")
    assert len(re.findall(rb"/Type\s*/Page\b", report)) == 1, "a report of one page"
    (SHOTS / "report.pdf").write_bytes(report)
    for place, picture in page.evaluate("window.printed"):
        assert picture == pytest.approx(place, abs=1), "pictures have the size of their places on paper"
    wide = "[...document.querySelectorAll('.masks .main-svg')].every((e) => e.clientWidth > 600)"
    until(lambda: page.evaluate(wide), "pictures that fill the screen again")
    job = page.url.rpartition("/")[2]
    explored = explore(visit)
    explored.locator("summary", has_text="Stored benchmark").click()
    explored.select_option("#stored", job)
    expect(explored.locator("#stored-note")).to_contain_text("40 s")
    expect(explored.locator("#map .legendtext", has_text="Hamilton-Jacobi")).to_have_count(1)


def test_a_sweep_and_its_worst_cases(visit: Visit, up: Running) -> None:
    inputs = {
        "controllers": ["filter"],
        "cases_per_cell": 2,
        "omega_t_deg_s": [2, 3],
        "a_max_m_s2": [0.05, 0.1],
    }
    job = up.client.post("/processes/sweep/execution", json={"inputs": inputs}).json()["jobID"]
    page = visit.go(f"/dashboard/jobs/{job}")
    expect(page.locator("h1 .status")).to_have_text("successful")
    expect(page.locator(".matrix")).to_have_count(3)
    expect(page.locator(".replay .nsewdrag").first).to_be_visible()
    visit.shot("sweep")
    page.locator("#results a", has_text="explore").first.click()
    expect(page.locator(".answer .word").first).to_have_text(re.compile("GO"))


def test_cancel_then_try_again(visit: Visit, up: Running) -> None:
    job = up.submit(LONG, "coverage")
    page = visit.go(f"/dashboard/jobs/{job}")
    page.click("text=Cancel")
    expect(page.locator("h1 .status")).to_have_text("cancelled")
    expect(page.locator("#course .log p").first).to_be_visible()
    page.reload()
    expect(page.locator("#course .log")).to_contain_text("cancelled")
    page.click("text=Try again")
    page.wait_for_url(lambda url: not url.endswith(job))
    page.click("text=Cancel")
    expect(page.locator("h1 .status")).to_have_text("cancelled")


def test_a_worker_killed_in_mid_job(visit: Visit, up: Running) -> None:
    job = up.submit(SLOW)
    page = visit.go(f"/dashboard/jobs/{job}")
    up.until(lambda: up.under_way(job), "under way")
    up.busiest("spawn_main").kill()
    expect(page.locator("h1 .status")).to_have_text("successful")


def test_the_service_killed_in_mid_job(visit: Visit, up: Running) -> None:
    job = up.submit(SLOW)
    page = visit.go(f"/dashboard/jobs/{job}")
    expect(page.locator("progress")).to_be_visible()
    for process in up.processes("serve"):
        process.kill()
    expect(page.locator("h1 .status")).to_have_text("successful")
    visit.allowed += ["ERR_", "Failed to load resource"]


def test_a_failed_job_says_why(visit: Visit, up: Running) -> None:
    jobs = JobRepository(Database(up.database_url))
    job = jobs.submit("benchmark", {}, instant=None, timeout_s=60.0).id
    page = visit.go(f"/dashboard/jobs/{job}")
    expect(page.locator("h1 .status")).to_have_text("failed")
    expect(page.locator("#state .problem")).not_to_be_empty()
    expect(page.locator("text=Try again")).to_be_visible()


def test_a_service_with_keys_asks_for_one(browser: Browser, tmp_path: Path) -> None:
    """A page is given to anyone, its content to who has a key."""
    database = Database(f"sqlite:///{tmp_path / 'keys.sqlite3'}")
    database.migrate()
    key = KeyRepository(database).create("reader", Role.READ, 1.0, LOCAL)[1]
    with serving(f"sqlite:///{tmp_path / 'keys.sqlite3'}") as url:
        context = browser.new_context()
        visit = Visit(context, url)
        visit.allowed.append("401")
        page = visit.go("/dashboard/jobs")
        page.fill("#key", "wrong")
        page.click("text=Use this key")
        expect(page.locator("label[for=key]").first).to_contain_text("not accepted")
        page.locator("#key").first.fill(key)
        page.locator("text=Use this key").first.click()
        expect(page.locator(".empty")).to_contain_text("No jobs here yet")
        explore(visit, "x_m=5&y_m=40")
        expect(page.locator(".answer .word").first).to_have_text("GO")
        context.close()
        assert visit.faults() == []


def test_jobs_list_and_comparison(visit: Visit, benchmarks: list[str]) -> None:
    page = visit.go("/dashboard/jobs?process=benchmark&status=successful")
    for job in benchmarks:
        page.locator(f'input[aria-label="choose benchmark {job[:8]}"]').check()
    page.click("#compare")
    expect(page.locator("#state")).to_contain_text("Tumble rate [deg/s]")
    expect(page.locator("#compare table")).to_have_count(5)
    visit.shot("compare")


def test_light_processes_answer_on_the_page(visit: Visit) -> None:
    page = visit.go("/dashboard/submit?process=flight")
    page.click("text=Run now")
    expect(page.locator("#state pre")).to_contain_text('"verdict": "GO"')


def test_states_without_content_and_without_service(visit: Visit) -> None:
    page = visit.go("/dashboard/compare")
    expect(page.locator(".empty")).to_contain_text("two or more")
    page = visit.go("/dashboard/jobs/00000000-0000-0000-0000-000000000000")
    expect(page.locator(".problem")).to_contain_text("no job")
    page = visit.go("/dashboard/jobs?status=failed&process=atlas")
    expect(page.locator(".empty")).to_contain_text("No job is like that")
    page = explore(visit)
    page.context.set_offline(True)
    page.fill("#x_m", "5")
    page.fill("#y_m", "40")
    page.click("text=Check this start")
    expect(page.locator("#verdict .problem")).to_contain_text("does not answer")
    page.context.set_offline(False)
    page.click("#verdict >> text=Try again")
    expect(page.locator(".answer .word").first).to_have_text("GO")
    visit.allowed += ["404", "ERR_INTERNET_DISCONNECTED"]


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [1280, 390])
def test_no_finding_of_axe(
    browser: Browser, up: Running, benchmarks: list[str], scheme: str, width: int
) -> None:
    context = browser.new_context(viewport={"width": width, "height": 900}, color_scheme=scheme)  # type: ignore[arg-type]
    visit = Visit(context, up.url)
    ready = {
        f"/dashboard?{SLIVER}": ".answer",
        "/dashboard/trade": "#table tbody tr",
        "/dashboard/approach?angle_deg=0": "#burns tbody tr",
        "/dashboard/submit?process=benchmark": "#in-omega_t_deg_s",
        "/dashboard/jobs": ".jobs tbody tr",
        f"/dashboard/jobs/{benchmarks[0]}": ".matrix",
        f"/dashboard/compare?jobs={','.join(benchmarks)}": "table",
        "/docs": "details",
    }
    for path, there in ready.items():
        page = visit.go(path)
        page.wait_for_selector(there)
        found = Axe().run(page).response["violations"]
        assert [(path, one["id"], one["nodes"][0]["html"][:200]) for one in found] == []
        assert page.evaluate("document.documentElement.scrollWidth") <= width, f"{path} scrolls sideways"
    context.close()
    assert visit.faults() == []


def test_by_keyboard_alone(visit: Visit) -> None:
    page = explore(visit)
    page.focus("#x_m")
    page.keyboard.type("5")
    page.keyboard.press("Tab")
    page.keyboard.type("40")
    page.keyboard.press("Enter")
    expect(page.locator(".answer .word").first).to_have_text("GO")
    expect(page.locator("#play")).to_be_enabled()
    page.focus("#play")
    page.keyboard.press("Enter")
    expect(page.locator("#play")).to_have_text("Pause")
