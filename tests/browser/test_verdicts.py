"""No verdict on Explore is ever old or foreign: each answers the question of the fields, or is removed."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.browser.conftest import Visit
from tests.browser.explored import FAULTS, Served, Truth, edit, faults_in, seen, settled
from tests.waiting import until

GO = "omega_t_deg_s=3&x_m=-60&y_m=80"
"""GO for 60 s with 33.23 m; at 4 deg/s NO GO."""
SHOWN = "#verdict .answer:not(.old) .word"


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    found = Served(tmp_path_factory.mktemp("served"))
    yield found
    found.kill()


@pytest.fixture
def disturbed(browser: Browser, served: Served) -> Iterator[Visit]:
    """A visit whose requests a test can make late, failing, or deaf to being given up."""
    context = browser.new_context(viewport={"width": 1280, "height": 900})
    context.add_init_script(path=FAULTS)
    found = Visit(context, served.url)
    found.allowed += ["422", "503", "ERR_", "Failed to load"]
    yield found
    context.close()
    assert found.faults() == []


@pytest.fixture
def truth(served: Served) -> Truth:
    return Truth(served.url)


def start(visit: Visit, query: str = GO) -> Page:
    page = visit.go(f"/dashboard?{query}")
    expect(page.locator(SHOWN)).to_have_text(re.compile("GO|UNDECIDED"))
    expect(page.locator("#flown")).not_to_be_empty()
    return page


def disturb(page: Page, **settings: Any) -> None:
    page.evaluate("(settings) => Object.assign(window.faults, settings)", {"on": True, **settings})


def test_a_changed_input_greys_the_verdict_at_once(disturbed: Visit, truth: Truth) -> None:
    page = start(disturbed)
    disturb(page, delay=800)
    now = edit(page, omega_t_deg_s="4")
    assert now["word"] is None, "within the same event the old verdict is no verdict any more"
    expect(page.locator("#verdict .old .word").first).to_have_text("GO")
    assert now["region"] is None
    assert now["certified"] is None
    expect(page.locator(SHOWN)).to_have_text("NO GO")
    assert faults_in(settled(page), truth) == []


def test_no_verdict_outlives_the_service(disturbed: Visit, served: Served, truth: Truth) -> None:
    page = start(disturbed)
    served.kill()
    edit(page, omega_t_deg_s="4")
    expect(page.locator("#verdict .problem")).to_contain_text("does not answer")
    assert seen(page)["word"] is None
    assert seen(page)["region"] is None
    served.start()
    page.locator("#verdict >> text=Try again").click()
    expect(page.locator(SHOWN)).to_have_text("NO GO")
    assert faults_in(settled(page), truth) == []


def test_a_late_answer_is_dropped(disturbed: Visit, truth: Truth) -> None:
    """Seen: "Stay for" 590, then 62 within 0.7 s, left the verdict of 590 s."""
    page = start(disturbed, "x_m=0&y_m=20&velocity_half_width_m_s=0.01")
    disturb(page, delay=4000, deaf=1.0)
    edit(page, horizon_s="590")
    page.wait_for_timeout(400)
    disturb(page, delay=0)
    edit(page, horizon_s="62")
    until(lambda: "62 s" in (seen(page)["why"] or ""), "the verdict for 62 s")
    for _ in range(20):
        page.wait_for_timeout(150)
        assert faults_in(seen(page), truth) == []
    assert page.evaluate("window.faults.abandoned") > 0, "what nobody waits for is given up"


def test_answers_out_of_order(disturbed: Visit, truth: Truth) -> None:
    """Every answer is late by another time, and comes although it was given up."""
    page = start(disturbed)
    disturb(page, delay=1200, deaf=1.0, seed=5)
    for rate in ("1", "2", "4", "1.5", "3.5", "2.5"):
        assert faults_in(edit(page, omega_t_deg_s=rate), truth) == []
        page.wait_for_timeout(250)
        assert faults_in(seen(page), truth) == []
    last = settled(page)
    assert last["word"] == "GO"
    assert faults_in(last, truth) == []


@pytest.mark.parametrize(
    ("field", "text"),
    [
        ("omega_t_deg_s", "-5"),
        ("omega_t_deg_s", ""),
        ("position_half_width_m", "-30"),
        ("position_half_width_m", ""),
        ("horizon_s", "61"),
        ("within_s", ""),
        ("c_x", "-1"),
        ("x_m", ""),
        ("y_max_m", ""),
    ],
)
def test_what_is_invalid_or_cleared_has_no_verdict(disturbed: Visit, field: str, text: str) -> None:
    page = start(disturbed, f"{GO}&position_half_width_m=0.1")
    assert edit(page, **{field: text})["word"] is None
    page.wait_for_timeout(700)
    found = settled(page)
    assert found["word"] is None
    assert found["closed"] is None
    assert found["problem"], "the page says why"


@pytest.mark.parametrize(
    "query", ["omega_t_deg_s=abc", "omega_t_deg_s=0x3", "question=fly", "mean_motion_rad_s="]
)
def test_an_address_that_cannot_be_read_has_no_verdict(disturbed: Visit, query: str) -> None:
    page = disturbed.go(f"/dashboard?x_m=-60&y_m=80&{query}")
    expect(page.locator("#verdict .problem")).to_contain_text("required")
    assert settled(page)["word"] is None


def test_an_address_with_settings_that_are_none_says_so(disturbed: Visit) -> None:
    page = disturbed.go("/dashboard?x_m=-60&y_m=80&omega=4")
    expect(page.locator("#address")).to_contain_text("omega")


def test_a_start_that_is_typed_has_no_old_verdict(disturbed: Visit, truth: Truth) -> None:
    page = start(disturbed)
    assert edit(page, y_m="20")["word"] is None
    assert faults_in(settled(page), truth) == []
    assert edit(page, x_m="60", y_m="20")["word"] is None
    last = settled(page)
    assert last["word"] == "NO GO"
    assert faults_in(last, truth) == []


SETTINGS = {
    "omega_t_deg_s": "4",
    "a_max_m_s2": "0.05",
    "horizon_s": "80",
    "question": "synchronize",
    "rest": "body",
    "c_x": "1",
    "position_half_width_m": "0.5",
    "y_m": "30",
}


def test_all_pairs_of_settings_changed_quickly(disturbed: Visit, truth: Truth) -> None:
    page = start(disturbed)
    first = seen(page)["fields"]
    disturb(page, delay=250, deaf=0.5, seed=11)
    for pair in itertools.combinations(SETTINGS, 2):
        for name in pair:
            assert faults_in(edit(page, **{name: SETTINGS[name]}), truth) == []
        page.wait_for_timeout(100)
        assert faults_in(seen(page), truth) == [], pair
        assert faults_in(edit(page, **{name: first[name] for name in pair}), truth) == []
        page.wait_for_timeout(230)
        assert faults_in(seen(page), truth) == [], pair
    last = settled(page)
    assert last["word"] == "GO"
    assert faults_in(last, truth) == []


def test_the_map_says_what_it_does_not_ask(disturbed: Visit) -> None:
    page = start(disturbed, f"{GO}&horizon_s=80")
    expect(page.locator("#map .gtitle")).to_contain_text("Map: stay 80 s, nominal")
    expect(page.locator("#map-lacks")).to_be_empty()
    edit(page, question="synchronize")
    expect(page.locator("#map-lacks")).to_contain_text("come to rest at the hold point within 200 s")
    edit(page, question="stay", position_half_width_m="0.5", disturbance_m_s2="0.001")
    expect(page.locator("#map-lacks")).to_contain_text("start position ± 0.5 m")
    expect(page.locator("#map-lacks")).to_contain_text("disturbance up to 0.001 m/s²")
    edit(page, position_half_width_m="0", disturbance_m_s2="0", rest="body")
    expect(page.locator("#map .gtitle")).to_contain_text("Map: certified for ever, nominal")
    expect(page.locator("#map-lacks")).to_contain_text("the exact answer")


def test_an_undecided_verdict_claims_no_proof(disturbed: Visit) -> None:
    page = start(disturbed, "x_m=2&y_m=30&position_half_width_m=0.5")
    expect(page.locator("#verdict .answer h2")).to_contain_text("proved for all within the ranges")
    edit(page, position_half_width_m="60")
    expect(page.locator(SHOWN)).to_have_text("UNDECIDED")
    expect(page.locator("#verdict .answer h2")).to_contain_text("neither proved nor refuted")


def test_the_verdict_that_counts_is_the_big_one(disturbed: Visit) -> None:
    page = start(disturbed, "omega_t_deg_s=2&a_max_m_s2=0.05&x_m=9.364&y_m=81.044")
    size = "(node) => parseFloat(getComputedStyle(node).fontSize)"
    big, small = page.locator(SHOWN), page.locator("#verdict .closed-word")
    expect(big).to_have_text("NO GO")
    expect(small).to_have_text("GO")
    expect(page.locator("#verdict .aside h3")).to_contain_text("not sound")
    assert big.evaluate(size) > 2 * small.evaluate(size)


def test_the_flight_says_what_is_flown(disturbed: Visit, truth: Truth) -> None:
    page = start(disturbed, f"{GO}&omega_t_deg_s=4".replace("omega_t_deg_s=3&", ""))
    expect(page.locator("#flown")).to_contain_text("the best attempt to stay 60 s")
    number = re.search(r"outside|beyond", page.locator("#flown").inner_text())
    assert number, "it leaves the corridor"
    assert "12.94 m" in page.locator("#flown").inner_text()
    assert "12.94 m" in page.locator("#verdict .why").inner_text(), "one flight, one number"
    edit(page, question="synchronize")
    expect(page.locator("#flown")).to_contain_text("as none is known to come to rest")
    edit(page, x_m="5", y_m="40", omega_t_deg_s="3", position_half_width_m="0.1", question="stay")
    expect(page.locator("#flown")).to_contain_text("at the nominal values, undisturbed")


def test_nothing_is_flown_from_outside_the_corridor(disturbed: Visit) -> None:
    """Seen: "the best ends 46.18 m outside" beside a flight that ended 83.9 m outside."""
    page = start(disturbed, "omega_t_deg_s=3&x_m=100&y_m=10")
    expect(page.locator("#flown")).to_contain_text(
        "the start lies outside the corridor, 46.18 m beyond right"
    )
    expect(page.locator("#verdict .why")).to_contain_text("at least 46.18 m")
    expect(page.locator("#play")).to_be_hidden()
