"""What the first screen of a result holds, as a user sees it without scrolling."""

from __future__ import annotations

from playwright.sync_api import Page, expect

_SEEN = """() => Object.fromEntries(Object.entries({
  finding: ".first .said > :not(.key-inputs)", inputs: ".first .key-inputs dl",
  picture: ".first .beside figure img, .first .beside figure .main-svg",
}).map(([name, selector]) => {
  const node = document.querySelector(selector), box = node?.getBoundingClientRect();
  return [name, node ? [box.top, box.bottom, box.width] : null];
}))"""


def check_first_screen(page: Page) -> None:
    """A finding, a picture and the inputs are on the screen; of long ones at least the beginning."""
    expect(page.locator(".first .beside figure").locator("img[src], .main-svg").first).to_be_visible()
    size = page.viewport_size
    assert size is not None
    for name, box in page.evaluate(_SEEN).items():
        assert box is not None, f"no {name}"
        top, bottom, width = box
        assert width > 100, f"{name}: {box}"
        assert top >= -5, f"{name} begins above the screen: {box}"
        assert min(bottom, top + 60) <= size["height"], f"{name} is below the screen: {box}"
        assert name != "picture" or bottom <= size["height"], f"the picture is cut: {box}"
