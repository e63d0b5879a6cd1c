"""The approach designer: what is dragged, what is shown, and that no answer outlives its inputs."""

from __future__ import annotations

import csv
import re
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.acceptance.running import Running
from tests.browser.conftest import Visit
from tests.browser.explored import FAULTS
from tests.waiting import until

WORD = "#verdict .answer:not(.old) .word"
_TRACES = "document.getElementById('map').data.map((one) => one.name)"
_PIXEL = """([along, radial]) => {
  const map = document.getElementById('map'), box = map.getBoundingClientRect(), { xaxis, yaxis } = map._fullLayout;
  return [box.left + xaxis._offset + xaxis.d2p(along), box.top + yaxis._offset + yaxis.d2p(radial)];
}"""
_AT_REST = "window.faults.waiting === 0 && !document.querySelector('#verdict .old, #verdict [role=status]')"


def design(visit: Visit, query: str = "") -> Page:
    page = visit.go(f"/dashboard/approach{'?' if query else ''}{query}")
    page.wait_for_selector("#map[data-digest]:not([data-digest=''])", state="attached")
    return page


def planned(up: Running, **inputs: Any) -> dict[str, Any]:
    """The service's own answer; the standard wraps objects."""
    found = up.client.post("/processes/hop-plan/execution", json={"inputs": inputs}).json()
    return found | {"plan": found["plan"]["value"]}


def drag(page: Page, begin: tuple[float, float], end: tuple[float, float]) -> None:
    """From one point of the plane to another, [along-track, radial] m, in steps."""
    first, last = page.evaluate(_PIXEL, list(begin)), page.evaluate(_PIXEL, list(end))
    page.mouse.move(*first)
    page.mouse.down()
    page.mouse.move(*last, steps=12)
    page.mouse.up()


def test_the_menu_leads_to_hops_drifts_and_their_proof(visit: Visit, up: Running) -> None:
    page = visit.go("/dashboard")
    page.click("nav >> text=Approach designer")
    expect(page.locator(WORD)).to_have_text("PROVED")
    said = planned(up, angle_deg=130)
    expect(page.locator("#verdict")).to_contain_text(f"{said['plan']['fuel_2norm_m_s']:.3f} m/s")
    expect(page.locator("#verdict")).to_contain_text(f"{said['lambda']:.2f}")
    names = page.evaluate(_TRACES)
    assert "proved to keep out" in names
    assert "hops" in names
    assert "may enter the sphere" not in names
    expect(page.locator("#burns tbody tr")).to_have_count(6)
    visit.shot("approach")


def test_the_v_bar_has_a_breach_and_says_after_which_hop(visit: Visit) -> None:
    page = design(visit, "angle_deg=0")
    expect(page.locator(WORD)).to_have_text("VIOLATED")
    names = page.evaluate(_TRACES)
    assert "may enter the sphere" in names
    rows = page.locator("#burns tbody tr")
    expect(rows.nth(3)).to_contain_text("PROVED")
    expect(rows.nth(4)).to_contain_text("VIOLATED")
    page.click("#near")
    expect(page.locator("#near")).to_have_attribute("aria-pressed", "true")
    span = page.evaluate("document.getElementById('map')._fullLayout.xaxis.range")
    assert abs(span[0]) < 500, "the surroundings of the target alone"
    visit.shot("approach-v-bar")


def test_the_start_turns_the_line_and_the_hold_point_slides_on_it(visit: Visit, up: Running) -> None:
    page = design(visit, "angle_deg=90")
    drag(page, (0, -2000), (-1732, -1000))
    angle = float(page.input_value("#angle_deg"))
    assert angle == pytest.approx(150, abs=4), "146 is the fold: a point beyond it is refused"
    page.fill("#angle_deg", "40")
    expect(page.locator("#verdict")).to_contain_text(
        f"{planned(up, angle_deg=40)['plan']['fuel_2norm_m_s']:.3f}"
    )
    c, s = 0.7660444, 0.6427876
    drag(page, (100 * c, -100 * s), (600 * c, -600 * s))
    hold = float(page.input_value("#hold_m"))
    assert hold == pytest.approx(600, abs=20)
    assert page.input_value("#angle_deg") == "40"
    fuel = planned(up, angle_deg=40, hold_m=hold)["plan"]["fuel_2norm_m_s"]
    expect(page.locator("#verdict")).to_contain_text(f"{fuel:.3f}")
    expect(page).to_have_url(re.compile(f"hold_m={hold:g}"))
    visit.allowed.append("422")


def test_an_angle_past_the_fold_is_refused_with_the_reason(visit: Visit) -> None:
    page = design(visit)
    page.fill("#angle_deg", "160")
    expect(page.locator("#verdict .problem")).to_contain_text("145.66 deg")
    assert page.locator("#verdict .answer").count() == 0
    assert page.locator("#burns tbody tr").count() == 0
    assert "hops" not in page.evaluate(_TRACES)
    visit.allowed.append("422")


def test_changed_inputs_withdraw_the_answer_at_once(visit: Visit) -> None:
    visit.page.add_init_script(path=FAULTS)
    page = design(visit)
    page.evaluate("Object.assign(window.faults, { on: true, delay: 4000, seed: 2 })")
    seen = page.evaluate(
        """() => {
          const field = document.getElementById('angle_deg');
          field.value = '0';
          field.dispatchEvent(new Event('input', { bubbles: true }));
          const count = (selector) => document.querySelectorAll(selector).length, map = document.getElementById('map');
          const names = map.data.map((one) => one.name);
          return [count('#verdict .answer:not(.old)'), count('#burns tr'), map.dataset.digest, names];
        }"""
    )
    assert seen[:3] == [0, 0, ""]
    assert "burns" not in seen[3]
    page.wait_for_timeout(1300)
    assert page.locator("#verdict .old").count() == 0, "an old answer stays for a second"
    expect(page.locator(WORD)).to_have_text("VIOLATED")


def test_late_answers_are_dropped(visit: Visit, up: Running) -> None:
    """Answers come in any order, some although they were given up; what stays is the answer to the fields."""
    visit.page.add_init_script(path=FAULTS)
    page = design(visit)
    page.evaluate("Object.assign(window.faults, { on: true, delay: 900, deaf: 1, seed: 5 })")
    for angle in (0, 90, 20, 110, 60, 120):
        page.fill("#angle_deg", str(angle))
        page.wait_for_timeout(150)
    until(lambda: page.evaluate(_AT_REST), "a page at rest")
    assert page.input_value("#angle_deg") == "120"
    expect(page.locator(WORD)).to_have_text("PROVED")
    expect(page.locator("#verdict .asked")).to_contain_text("120 deg")
    fuel = planned(up, angle_deg=120)["plan"]["fuel_2norm_m_s"]
    expect(page.locator("#verdict")).to_contain_text(f"{fuel:.3f}")


def test_burns_are_a_file(visit: Visit, up: Running, tmp_path: Path) -> None:
    page = design(visit, "angle_deg=90&hops=3")
    with page.expect_download() as download:
        page.click("text=Burns as CSV")
    file = tmp_path / "burns.csv"
    download.value.save_as(file)
    rows = list(csv.DictReader(file.read_text().splitlines()))
    said = planned(up, angle_deg=90, hops=3)["burns"]
    assert [float(row["time_s"]) for row in rows] == [burn["time_s"] for burn in said]
    assert [float(row["dv_x_m_s"]) for row in rows] == [burn["impulse_m_s"][0] for burn in said]


def test_a_study_is_submitted_found_again_and_leaves_with_its_inputs(visit: Visit, up: Running) -> None:
    page = design(visit, "angle_deg=90&hops=2&runs=20&seed=11")
    expect(page.locator("#study")).to_contain_text("No study of these inputs")
    page.click("#submit")
    expect(page.locator("#study")).to_contain_text(re.compile("under way|Abort breach"))
    expect(page.locator("#study")).to_contain_text("Abort breach probability")
    expect(page.locator("#submit")).to_be_disabled()
    link = page.locator("#study a").get_attribute("href")
    assert link is not None
    study = up.get(f"/jobs/{link.rpartition('/')[2]}/results")
    assert study["inputs"]["angle_deg"] == 90
    assert study["inputs"]["runs"] == 20
    high = 100 * study["outputs"]["study"]["breach"]["high"]
    expect(page.locator("#study")).to_contain_text(f"{high:.1f} %")
    visit.shot("approach-study")
    page.fill("#seed", "12")
    expect(page.locator("#study")).to_contain_text("No study of these inputs")
    expect(page.locator(WORD)).to_have_text("PROVED")
    page.fill("#seed", "11")
    expect(page.locator("#study")).to_contain_text(f"{high:.1f} %")


def test_a_small_screen(browser: Browser, up: Running) -> None:
    context = browser.new_context(viewport={"width": 390, "height": 844}, has_touch=True, is_mobile=True)
    visit = Visit(context, up.url)
    page = design(visit, "angle_deg=120")
    expect(page.locator(WORD)).to_have_text("PROVED")
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    place = page.locator("#map").bounding_box()
    picture = page.locator("#map .main-svg").first.bounding_box()
    assert place is not None
    assert picture is not None
    assert picture["width"] <= place["width"] + 1
    page.locator('input[data-for="angle_deg"]').evaluate(
        "(field) => { field.value = '0'; field.dispatchEvent(new Event('input', { bubbles: true })); }"
    )
    expect(page.locator(WORD)).to_have_text("VIOLATED")
    visit.shot("approach-390")
    context.close()
    assert visit.faults() == []
