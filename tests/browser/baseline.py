"""Pictures of pages made small: a coarse grey picture says where things stand, whatever machine draws the letters.

A screenshot is averaged over cells of 8 by 8 pixels, and sixteen shades are left. In such a picture a line of text is a
grey bar; how a machine smooths its letters, arrows and sliders hardly shows. The pages wear one font in these pictures,
which Matplotlib brings, so that lines break at the same words everywhere.
"""

from __future__ import annotations

import io
import json
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np
from numpy.typing import NDArray
from PIL import Image
from PIL.PngImagePlugin import PngInfo
from playwright.sync_api import BrowserContext, Page, Route

CELL = 8
SHADES = 16
STEP = 30
"""A cell is another one if its shade (0 to 255) differs by more: two steps of the sixteen shades and the averaging."""
SHARE = 0.001
"""Share of other cells that a picture may have: a page stretched by a pixel has 0.00004, one without its menu 0.003."""
FONT = Path(matplotlib.get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf"
_WORN = """
@font-face { font-family: "Baseline"; src: url("/baseline.ttf"); }
:root *, :root *::before, :root *::after { font-family: "Baseline" !important; }
.steady-hidden, #estimate, .took, .provenance dd { visibility: hidden; }
"""
Shades = NDArray[np.uint8]


def wear_one_font(context: BrowserContext) -> None:
    """Let all pages of a context use one font; the context must bypass the content policy."""

    def dressed(route: Route) -> None:
        answer = route.fetch()
        route.fulfill(response=answer, body=answer.text() + _WORN)

    context.route("**/static/safestart.css", dressed)
    context.route("**/baseline.ttf", lambda route: route.fulfill(path=FONT))


def settle(page: Page) -> None:
    """Wait for the font and draw the pictures with it; nothing moves afterwards."""
    page.evaluate("document.fonts.load('12px Baseline').then(() => document.fonts.ready)")
    page.evaluate("document.dispatchEvent(new Event('colours'))")
    page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")


def coarse(png: bytes) -> Shades:
    """Rows of shades (multiples of 17), one for each cell, of a screenshot."""
    grey = Image.open(io.BytesIO(png)).convert("L")
    small = grey.resize((max(1, grey.width // CELL), max(1, grey.height // CELL)), Image.Resampling.BOX)
    steps = np.rint(np.asarray(small, float) * (SHADES - 1) / 255)
    return (steps * 17).astype(np.uint8)


@dataclass(frozen=True)
class Difference:
    """How two coarse pictures differ: share of other cells, and whether one is taller or wider."""

    share: float
    sizes: tuple[tuple[int, ...], tuple[int, ...]]

    @property
    def seen(self) -> bool:
        """Whether a user would see it."""
        (height, width), (other_height, other_width) = self.sizes
        return width != other_width or abs(height - other_height) > 1 or self.share > SHARE


def difference(one: Shades, two: Shades) -> Difference:
    """Compare what both pictures have; a row more or less is allowed."""
    height, width = min(one.shape[0], two.shape[0]), min(one.shape[1], two.shape[1])
    step = np.abs(one[:height, :width].astype(int) - two[:height, :width])
    return Difference(float(np.mean(step > STEP)), (one.shape, two.shape))


def sheet(pictures: list[Shades]) -> bytes:
    """Coarse pictures side by side, as PNG of four bits a cell; their sizes are in its text."""
    height, width = max(one.shape[0] for one in pictures), sum(one.shape[1] + 1 for one in pictures)
    whole, at, sizes = np.zeros((height, width), np.uint8), 0, PngInfo()
    for one in pictures:
        whole[: one.shape[0], at : at + one.shape[1]] = one
        at += one.shape[1] + 1
    image = Image.fromarray(whole // 17)
    image.putpalette([17 * k for k in range(SHADES) for _ in range(3)])
    sizes.add_text("sizes", json.dumps([one.shape for one in pictures]))
    written = io.BytesIO()
    image.save(written, "PNG", bits=4, optimize=True, pnginfo=sizes)
    return written.getvalue()


def read_sheet(path: Path) -> list[Shades]:
    """The pictures of a sheet."""
    with Image.open(path) as image:
        sizes, whole = json.loads(image.info["sizes"]), np.asarray(image.convert("L"))
    found, at = [], 0
    for height, width in sizes:
        found.append(whole[:height, at : at + width])
        at += width + 1
    return found


def small_file(png: bytes) -> bytes:
    """The screenshot in 256 colours: a third of its size."""
    written = io.BytesIO()
    Image.open(io.BytesIO(png)).convert("RGB").quantize(256, dither=Image.Dither.NONE).save(
        written, "PNG", optimize=True
    )
    return written.getvalue()
