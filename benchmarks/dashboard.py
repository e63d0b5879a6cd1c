"""Time from a moved slider or a click to the drawn picture, in Chromium: ``python -m benchmarks.dashboard``.

Run by hand: it needs a browser. A figure is the median over the moves of one page after it was loaded once.
"""

from __future__ import annotations

import json
import shutil
import statistics
import tempfile
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

from benchmarks.asked import parser
from tests.acceptance.running import serving

MOVES = 25
_CLICK = """async () => {
  const word = () => document.querySelector('.answer .word'), begun = performance.now();
  document.querySelector('#verdict').replaceChildren();
  document.querySelector('#start').requestSubmit();
  while (!word() || document.querySelector('#play').disabled) await new Promise((r) => setTimeout(r, 1));
  return performance.now() - begun;
}"""


def _slide(page: Page, rate: float) -> float:
    page.evaluate("delete document.getElementById('map').dataset.drawnMs")
    page.locator('input[data-for="omega_t_deg_s"]').evaluate(
        "(field, rate) => { field.value = rate; field.dispatchEvent(new Event('input', {bubbles: true})); }",
        rate,
    )
    while not (drawn := page.evaluate("document.getElementById('map').dataset.drawnMs")):
        page.wait_for_timeout(2)
    return float(drawn)


def measure() -> dict[str, float]:
    """Medians in milliseconds."""
    with (
        tempfile.TemporaryDirectory() as folder,
        serving(f"sqlite:///{Path(folder) / 'b.sqlite3'}") as url,
        sync_playwright() as playwright,
    ):
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1280, "height": 900})
        page.goto(f"{url}/dashboard?x_m=5&y_m=40")
        page.wait_for_selector("#map[data-proved]", state="attached")
        slides = [_slide(page, 1.0 + 0.1 * k) for k in range(MOVES)]
        page.wait_for_timeout(2000)
        clicks = []
        for k in range(MOVES):
            page.fill("#y_m", str(20 + k))
            clicks.append(float(page.evaluate(_CLICK)))
        browser.close()
    return {
        "slider_to_picture_ms": statistics.median(slides),
        "click_to_flown_start_ms": statistics.median(clicks),
    }


if __name__ == "__main__":
    parser(__doc__).parse_args()
    print(json.dumps(measure(), indent=1))
