"""The tracking MPC's result page: the flight about the tumbling target moves, the sets of starts are compared."""

from __future__ import annotations

from playwright.sync_api import expect

from tests.acceptance.running import Running
from tests.browser.conftest import Visit

INPUTS = {"steps": 25, "region": {"rows": 6}}


def test_the_flight_is_animated(up: Running, visit: Visit) -> None:
    headers = {"Prefer": "respond-async"}
    asked = up.client.post("/processes/tracking-mpc/execution", json={"inputs": INPUTS}, headers=headers)
    job = asked.json()["jobID"]
    up.outcome(job)
    page = visit.go(f"/dashboard/jobs/{job}")
    expect(page.get_by_role("heading", name="The flight about the tumbling target")).to_be_visible()
    scene = page.get_by_role("group", name="The flight about the tumbling target")
    expect(scene.locator(".scatterlayer .trace")).to_have_count(7)
    clock = page.get_by_label("time", exact=True)
    assert clock.input_value() == "25"
    clock.fill("5")
    expect(page.locator("output", has_text="5 s")).to_be_visible()
    walls = scene.locator(".scatterlayer .trace path.js-line").first
    lvlh = walls.get_attribute("d")
    page.get_by_label("frame", exact=True).select_option("body")
    expect(walls).not_to_have_attribute("d", str(lvlh))
    body = walls.get_attribute("d")
    clock.fill("20")
    expect(walls).to_have_attribute("d", str(body))
    page.get_by_label("frame", exact=True).select_option("lvlh")
    page.get_by_role("button", name="Fly it").click()
    expect(page.get_by_role("button", name="Pause")).to_be_visible()
    expect(page.get_by_role("button", name="Fly it")).to_be_visible()
    assert clock.input_value() == "25"
    expect(page.get_by_role("heading", name="Which starts")).to_be_visible()
    expect(page.locator(".agreement")).to_contain_text("In both")
    expect(page.get_by_role("heading", name="The controller against any impulse history")).to_be_visible()
    visit.shot("tracking-mpc")
    assert visit.faults() == []
