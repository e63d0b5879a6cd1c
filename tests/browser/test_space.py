"""Explore in space: the verdict, its proof, the slices and the scene belong to the fields."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, expect

from safestart.processes.start_in_space.missions import MISSIONS
from safestart.proofs.checker import check
from tests.acceptance.running import Running
from tests.browser.conftest import Visit
from tests.browser.explored import FAULTS
from tests.browser.tour import SOFTWARE, STOPS

WORD = "#verdict .answer:not(.old) .word"
_THERE = STOPS["space"].there
_TRACES = "document.getElementById('space').data.map((one) => one.name)"


def open_space(visit: Visit, query: str = "") -> Page:
    visit.allowed.extend(SOFTWARE)
    page = visit.go(f"/dashboard/space{'?' if query else ''}{query}")
    page.wait_for_selector(_THERE, state="attached")
    return page


def answered(up: Running, **inputs: Any) -> dict[str, Any]:
    """The service's own answer."""
    found: dict[str, Any] = up.client.post(
        "/processes/start-in-space/execution", json={"inputs": inputs}
    ).json()
    return found


def test_the_menu_leads_to_a_verdict_its_proof_and_the_scene(visit: Visit, tmp_path: Path) -> None:
    visit.allowed.extend(SOFTWARE)
    page = visit.go("/dashboard")
    page.click("nav >> text=In space")
    page.wait_for_selector(_THERE, state="attached")
    expect(page.locator(WORD)).to_have_text("GO")
    names = page.evaluate(_TRACES)
    for name in ("corridor", "target's x", "way of y", "turns about", "starts proved GO", "flight", "chaser"):
        assert name in names, names
    expect(page.locator("#region")).to_contain_text("xy")
    expect(page.locator("#instant")).to_contain_text("At 60 s")
    with page.expect_download() as download:
        page.click("#proof a")
    file = tmp_path / "proof.json"
    download.value.save_as(file)
    assert check(json.loads(file.read_text())).verdict == "GO"
    visit.shot("space")


def test_missions_fill_the_fields_and_are_answered(visit: Visit, up: Running) -> None:
    page = open_space(visit)
    options = page.locator("#preset option")
    expect(options).to_have_count(1 + len(MISSIONS))
    for name in ("envisat-tracked", "rocket-body", "r-bar"):
        page.select_option("#preset", name)
        page.wait_for_selector(_THERE, state="attached")
        said = answered(up, **MISSIONS[name])
        expect(page.locator(WORD)).to_have_text(said["verdict"][0].replace("_", " "))
        expect(page.locator("#verdict .facts")).to_contain_text(f"{said['margin_m'][0]:.4g} m")
    assert page.input_value("#corridor") == "faces"
    assert len(page.input_value("#faces").splitlines()) == 5
    expect(page.locator("#slices-lack")).to_contain_text("the speed limit")
    visit.shot("space-r-bar")


def test_a_start_without_a_way_out_has_a_proof_and_no_flight(visit: Visit) -> None:
    page = open_space(visit, "position_m=0+3+0&velocity_m_s=0+-1+0&a_max_m_s2=0.01")
    expect(page.locator(WORD)).to_have_text("NO GO")
    expect(page.locator("#proof")).to_be_visible()
    expect(page.locator("#flown")).to_contain_text("No flight")
    expect(page.locator("#flight-line")).to_be_hidden()
    names = page.evaluate(_TRACES)
    assert "start" in names
    assert "chaser" not in names


def test_what_is_wrong_is_named(visit: Visit) -> None:
    page = open_space(visit)
    page.fill("#position_m", "1 2")
    expect(page.locator("#verdict .problem")).to_contain_text("3 numbers are required")
    expect(page.locator("#position_m")).to_have_attribute("aria-invalid", "true")
    expect(page.locator("#space")).to_be_hidden()
    page.fill("#position_m", "2 25 1")
    page.fill("#inertia_kg_m2", "1 0 0 0 1 0 0 0 9")
    expect(page.locator("#verdict .problem")).to_contain_text("inertia_kg_m2")
    assert page.locator(WORD).count() == 0
    visit.allowed.append("422")


def test_changed_inputs_withdraw_the_answer_at_once(visit: Visit) -> None:
    visit.page.add_init_script(path=FAULTS)
    page = open_space(visit)
    page.evaluate("Object.assign(window.faults, { on: true, delay: 3000, seed: 2 })")
    seen = page.evaluate(
        """() => {
          const field = document.getElementById('body_rate_deg_s');
          field.value = '0.3 0.5 -3';
          field.dispatchEvent(new Event('input', { bubbles: true }));
          const scene = document.getElementById('space'), names = scene.data.map((one) => one.name);
          return [document.querySelectorAll('#verdict .answer:not(.old), #proof').length, scene.dataset.digest, names];
        }"""
    )
    assert seen[:2] == [0, ""]
    assert not {"flight", "chaser", "starts proved GO", "way of x"} & set(seen[2])
    expect(page.locator("#verdict .asked")).to_contain_text("(0.3, 0.5, -3) deg/s")


@pytest.mark.parametrize("width", [390])
def test_a_small_screen(browser: Browser, up: Running, width: int) -> None:
    context = browser.new_context(viewport={"width": width, "height": 844}, has_touch=True, is_mobile=True)
    visit = Visit(context, up.url)
    page = open_space(visit)
    expect(page.locator(WORD)).to_have_text("GO")
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    visit.shot("space-390")
    context.close()
    assert visit.faults() == []
