"""Result pages: findings come first, the job's status is not a verdict, and no answer outlives its inputs."""

from __future__ import annotations

import re
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from safestart.processes.registry import PROCESS_IDS, process
from safestart.processes.tables import tables_of
from safestart.processes.views import Facts
from tests.acceptance.running import Running
from tests.browser.conftest import Visit
from tests.browser.explored import FAULTS, edit
from tests.browser.first_screen import check_first_screen

SWEEP = {"controllers": ["filter"], "cases_per_cell": 3, "omega_t_deg_s": [1, 3], "a_max_m_s2": [0.1]}
SMALL = {
    "omega_t_deg_s": 2,
    "a_max_m_s2": 0.1,
    "grid": {"nx": 21, "ny": 21},
    "engines": ["certified", "exact", "forward"],
}
AVOIDANCE = {
    "encounters": 20,
    "supervised": 0,
    "grid": {"nodes_position": 11, "nodes_speed": 5},
    "capture_horizon_s": 100,
}


@pytest.fixture(scope="module")
def jobs(up: Running) -> dict[str, str]:
    """A finished job of every process, on its example or a quicker one."""
    quick: dict[str, dict[str, Any]] = {
        "go-no-go": process("go-no-go").example | {"method": "paper"},
        "benchmark": SMALL,
        "sweep": SWEEP,
        "collision-avoidance": AVOIDANCE,
        "hopping": process("hopping").example | {"runs": 10},
        "tracking-mpc": {"steps": 25, "region": {"rows": 6}},
        "sweep-in-space": process("sweep-in-space").example | {"cases": 6},
    }
    examples = {name: quick.get(name, process(name).example) for name in PROCESS_IDS}
    headers = {"Prefer": "respond-async"}
    found = {}
    for name, inputs in examples.items():
        answer = up.client.post(f"/processes/{name}/execution", json={"inputs": inputs}, headers=headers)
        found[name] = answer.json()["jobID"]
    for job in found.values():
        up.outcome(job)
    return found


def opened(visit: Visit, job: str) -> Page:
    page = visit.go(f"/dashboard/jobs/{job}")
    expect(page.locator("#results > *").first).to_be_visible()
    return page


def top(page: Page, selector: str) -> float:
    box = page.locator(selector).first.bounding_box()
    assert box is not None
    return box["y"]


def test_an_unsafe_result_says_so_first(visit: Visit, jobs: dict[str, str]) -> None:
    """Seen: a table of one column, ``run_s``, under a green "successful"."""
    page = opened(visit, jobs["passive-safety"])
    expect(page.locator("h1 .badge.verdict")).to_contain_text("UNSAFE (2 of 10)")
    first = page.locator("#results h2").first
    expect(first).to_have_text("Findings")
    rows = page.locator("#results table").first.locator("tbody tr")
    expect(rows).to_have_count(10)
    expect(rows.first).to_contain_text("UNSAFE")
    expect(rows.first).to_contain_text("velocity_disc")
    expect(rows.first).to_contain_text("-875")
    assert top(page, "#results table") < 700, "on the first screen"
    visit.shot("passive-safety")


def test_the_status_of_a_job_is_no_verdict(visit: Visit, jobs: dict[str, str]) -> None:
    page = opened(visit, jobs["passive-safety"])
    colour = "(node) => getComputedStyle(node).color"
    status, verdict = page.locator("h1 .badge.job .status"), page.locator("h1 .badge.verdict .outcome")
    expect(status).to_have_text("successful")
    expect(page.locator("h1 .badge.job")).to_contain_text("job")
    rest = page.evaluate("getComputedStyle(document.documentElement).getPropertyValue('--rest')").strip()
    assert status.evaluate(colour) == _rgb(rest), "neither green nor red"
    assert verdict.evaluate(colour) != status.evaluate(colour)
    page = opened(visit, jobs["coverage"])
    expect(page.locator("h1 .badge.verdict")).to_have_count(0)


def _rgb(colour: str) -> str:
    return f"rgb({', '.join(str(int(colour[k : k + 2], 16)) for k in (1, 3, 5))})"


def test_a_go_without_proof_is_shown_as_a_claim(visit: Visit, jobs: dict[str, str]) -> None:
    page = opened(visit, jobs["go-no-go"])
    expect(page.locator("h1 .badge.verdict .open")).to_have_text("GO, paper, no proof")


def test_a_lost_flight_is_the_controllers(visit: Visit, jobs: dict[str, str]) -> None:
    page = opened(visit, jobs["sweep"])
    words = page.locator("#results").inner_text()
    assert "certified, lost in flight" in words
    assert "exact, flown by filter" in words
    assert not re.search("false GO|true GO", words, re.IGNORECASE)


def test_membership_in_a_set_is_no_verdict(visit: Visit, jobs: dict[str, str]) -> None:
    page = opened(visit, jobs["benchmark"])
    expect(page.locator(".matrix")).to_have_count(2)
    words = page.locator("#results").inner_text()
    assert "certified, in the set" in words
    assert "forward (outer)" in words
    assert not re.search("true (NO_)?GO|false GO", words)


@pytest.mark.parametrize("name", PROCESS_IDS)
def test_every_process_has_a_result_page(visit: Visit, up: Running, jobs: dict[str, str], name: str) -> None:
    """Whatever it offers as a table is there, or named; its views are drawn without a fault."""
    page = opened(visit, jobs[name])
    kinds = {view.kind for view in process(name).views}
    if "findings" in kinds:
        expect(page.locator("h1 .badge.verdict")).to_be_visible()
    check_first_screen(page)
    tables = tables_of(up.get(f"/jobs/{jobs[name]}/results")["outputs"], process(name).tables)
    for view in process(name).views:
        if view.kind in ("rows", "findings") and tables.get(view.table):
            expect(page.locator("#results h2", has_text=view.title).first).to_be_visible()
    visit.shot(f"result-{name}")


def test_an_answer_leaves_with_a_changed_field(visit: Visit) -> None:
    page = visit.go("/dashboard/submit?process=go-no-go")
    page.click("text=Run now")
    expect(page.locator("#state .badge.verdict")).to_contain_text("GO")
    page.fill("#in-omega_t_deg_s", "4")
    expect(page.locator("#state")).to_be_empty()
    page.click("text=Run now")
    expect(page.locator("#state .badge.verdict")).to_be_visible()
    page.select_option("#process", "flight")
    expect(page.locator("#state")).to_be_empty()


def test_the_trade_study_follows_its_fields(visit: Visit) -> None:
    page = visit.go("/dashboard/trade")
    expect(page.locator("#said")).to_contain_text("40 m")
    page.evaluate("document.querySelector('#stand_off_m').value = '80'")
    assert page.locator("#stand_off_m").evaluate(
        """(field) => { field.dispatchEvent(new Event('input', { bubbles: true }));
        return document.querySelector('#shown').classList.contains('old'); }"""
    )
    expect(page.locator("#said")).to_contain_text("80 m")
    page.fill("#stand_off_m", "")
    expect(page.locator("#table")).to_be_hidden()
    expect(page.locator("#state")).to_contain_text("Not shown")


def test_a_list_belongs_to_its_filter(visit: Visit, jobs: dict[str, str]) -> None:
    """The answer to the filter before comes last, and is dropped."""
    visit.page.add_init_script(path=FAULTS)
    page = visit.go("/dashboard/jobs")
    expect(page.locator(".jobs tbody tr").first).to_be_visible()
    page.evaluate("Object.assign(window.faults, { on: true, delay: 1500, deaf: 1, seed: 3 })")
    for name in ("sweep", "atlas", "coverage", "benchmark", "flight"):
        page.select_option("#process", name)
        page.wait_for_timeout(120)
    expect(page.locator(".jobs .run > a")).to_have_text(["flight"])
    page.wait_for_timeout(2500)
    expect(page.locator(".jobs .run > a")).to_have_text(["flight"])


@pytest.mark.parametrize("name", ["go-no-go", "hop-time", "passive-safety"])
def test_any_two_runs_of_a_process_are_compared(
    visit: Visit, up: Running, jobs: dict[str, str], name: str
) -> None:
    page = visit.go(f"/dashboard/compare?jobs={jobs[name]},{jobs[name]}")
    table = page.locator("#compare table").first
    expect(table.locator("thead th")).to_have_count(3)
    expect(table).to_contain_text("run [s]")
    spec = process(name)
    if any(view.kind == "findings" for view in spec.views):
        expect(table).to_contain_text("verdict")
    for view in spec.views:
        if isinstance(view, Facts):
            expect(table).to_contain_text(view.columns[0].title)


def test_runs_of_different_processes_are_not_compared(visit: Visit, jobs: dict[str, str]) -> None:
    page = visit.go(f"/dashboard/compare?jobs={jobs['benchmark']},{jobs['sweep']}")
    expect(page.locator("#state")).to_contain_text("benchmark and sweep, which cannot be compared")


def test_stored_sets_are_shown_for_their_own_operating_point_alone(
    visit: Visit, jobs: dict[str, str]
) -> None:
    page = visit.go("/dashboard?x_m=-60&y_m=80")
    page.locator("summary", has_text="Stored").click()
    page.select_option("#stored", jobs["benchmark"])
    sets = page.locator("#map .legendtext", has_text="stored")
    expect(sets).to_have_count(2)
    assert page.input_value("#omega_t_deg_s") == "2"
    edit(page, omega_t_deg_s="4")
    expect(sets).to_have_count(0)
    expect(page.locator("#stored-note")).to_contain_text("Not shown: these sets are about 2 deg/s")
    edit(page, omega_t_deg_s="2")
    expect(sets).to_have_count(2)
