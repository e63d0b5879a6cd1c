"""After any sequence of edits Explore shows a verdict that is true of the inputs shown, or none.

Requests are late, fail, come out of order or although they were given up, and the service is killed and started again.
In CI a few sequences; by hand as many as one likes:

    EDIT_SEQUENCES=500 EDIT_SEED=1 pytest tests/browser/test_edit_sequences.py
"""

from __future__ import annotations

import os
import random
import threading
from collections import Counter
from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.browser.conftest import Visit
from tests.browser.explored import FAULTS, Seen, Served, Truth, edit, faults_in, seen, settled

SEQUENCES = int(os.environ.get("EDIT_SEQUENCES", "8"))
SEED = int(os.environ.get("EDIT_SEED", "1"))
GOOD: dict[str, list[str]] = {
    "omega_t_deg_s": ["3", "0.5", "1", "2", "4", "6", "3e0"],
    "a_max_m_s2": ["0.1", "0.05", "0.2", "0.02"],
    "horizon_s": ["60", "20", "40", "62", "80", "20", "40", "62", "80", "240"],
    "y_max_m": ["150", "60", "200"],
    "question": ["stay", "stay", "synchronize"],
    "within_s": ["60", "40", "100", "200"],
    "rest": ["lvlh", "lvlh", "body"],
    "mean_motion_rad_s": ["0.0011", "0", "0.0005"],
    "c_x": ["1.5", "1", "0.6"],
    "r_h_m": ["0.5", "1"],
    "position_half_width_m": ["0", "0", "0.1", "0.5", "60"],
    "omega_t_half_width_deg_s": ["0", "0", "0.05"],
    "disturbance_m_s2": ["0", "0", "0.001"],
    "x_m": ["-60", "5", "0", "12", "100", "-20"],
    "y_m": ["80", "40", "20", "10", "75"],
}
"""What the service takes; the first text of each field is the one to begin with."""
BAD: dict[str, list[str]] = {
    "omega_t_deg_s": ["", "-5", "99", "-"],
    "a_max_m_s2": ["", "-1", "0"],
    "horizon_s": ["61", "", "-2"],
    "y_max_m": ["", "0.1"],
    "within_s": ["", "7"],
    "mean_motion_rad_s": [""],
    "c_x": ["-1", ""],
    "r_h_m": [""],
    "position_half_width_m": ["-30", ""],
    "omega_t_half_width_deg_s": ["-1", ""],
    "disturbance_m_s2": ["-0.1", ""],
    "x_m": [""],
    "y_m": [""],
}
TURN = """() => {
  const frame = document.querySelector("#frame:enabled");
  if (!frame) return;
  frame.value = frame.value === "lvlh" ? "body" : "lvlh";
  frame.dispatchEvent(new Event("change"));
}"""
FIRST = {name: texts[0] for name, texts in GOOD.items()}


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    found = Served(tmp_path_factory.mktemp("edits"))
    yield found
    found.kill()


def some_edit(page: Page, draw: random.Random) -> Seen:
    """One action of a user; returns what the page shows at that moment."""
    kind = draw.random()
    if kind < 0.10:
        box = (
            page.locator("#map .nsewdrag").first.bounding_box() if page.locator("#map").is_visible() else None
        )
        if box is not None:
            page.mouse.click(
                box["x"] + draw.random() * box["width"], box["y"] + draw.random() * box["height"]
            )
    elif kind < 0.18:
        page.evaluate("document.querySelector('#start').requestSubmit()")
    elif kind < 0.22:
        page.evaluate("document.querySelector('.problem button')?.click()")
    elif kind < 0.26:
        page.evaluate("document.querySelector('#play:enabled')?.click()")
    elif kind < 0.30:
        page.evaluate(TURN)
    elif kind < 0.36:
        field = draw.choice(["omega_t_deg_s", "horizon_s"])
        page.locator(f'input[data-for="{field}"]').evaluate(
            "(range, value) => { range.value = value; range.dispatchEvent(new Event('input', { bubbles: true })); }",
            draw.choice(["1", "2", "4"]) if field == "omega_t_deg_s" else draw.choice(["20", "44", "80"]),
        )
    elif kind < 0.44:
        field = draw.choice(list(GOOD))
        if page.locator(f"#{field}").is_visible() and field not in ("question", "rest"):
            page.locator(f"#{field}").press_sequentially(
                draw.choice(["1", "-", "e", ".", "Backspace"]), delay=5
            )
    else:
        return edit(page, **some_texts(page, draw))
    return seen(page)


def some_texts(page: Page, draw: random.Random) -> dict[str, str]:
    """Texts for a few fields, a few of them bad; what was bad is mostly mended, so that verdicts are shown."""
    texts = {}
    for name in draw.sample(list(GOOD), draw.choice([1, 1, 1, 2, 3])):
        texts[name] = draw.choice(BAD[name] if name in BAD and draw.random() < 0.15 else GOOD[name])
    if draw.random() < 0.7:
        fields = seen(page)["fields"]
        for name in GOOD:
            if name not in texts and fields[name] not in GOOD[name]:
                texts[name] = draw.choice(GOOD[name])
    return texts


def run_sequence(
    page: Page, served: Served, truth: Truth, draw: random.Random, tally: Counter[str]
) -> list[str]:
    """A sequence of edits; returns every false statement ever shown, and every true one missing at the end."""
    looks: list[Seen] = [edit(page, **FIRST)]
    settings: dict[str, Any] = {
        "on": True,
        "seed": draw.randrange(2**31),
        "delay": draw.choice([0, 100, 600, 1500]),
        "failing": draw.choice([0, 0, 0.1, 0.4]),
        "deaf": draw.choice([0, 0.5, 1]),
    }
    page.evaluate("(settings) => Object.assign(window.faults, settings)", settings)
    restart = None
    for _ in range(draw.randint(4, 14)):
        if restart is None and draw.random() < 0.02:
            served.kill()
            restart = threading.Timer(draw.uniform(0.1, 2.0), served.start)
            restart.start()
            tally["restarts"] += 1
        looks.append(some_edit(page, draw))
        for _ in range(draw.choice([0, 1, 1, 2])):
            page.wait_for_timeout(draw.choice([1, 30, 120, 250, 500]))
            looks.append(seen(page))
    if restart is not None:
        restart.join()
    page.evaluate("Object.assign(window.faults, { on: false })")
    settled(page)
    page.evaluate("document.querySelector('#start').requestSubmit()")
    last = settled(page)
    wrong = [fault for look in [*looks, last] for fault in faults_in(look, truth)]
    tally["looks"] += len(looks) + 1
    tally["verdicts"] += sum(look["word"] is not None for look in [*looks, last])
    wanted = truth.verdict(last["fields"])
    if (wanted is None) != (last["word"] is None):
        wrong.append(
            f"at rest: verdict {last['word']} ({last['problem']}), true: {wanted and wanted['verdict']}; "
            f"fields {last['fields']}"
        )
    return wrong


@pytest.mark.timeout(3600 * 12)
def test_the_verdict_shown_is_true_of_the_inputs_shown_or_none_is_shown(
    browser: Browser, served: Served
) -> None:
    context = browser.new_context(viewport={"width": 1280, "height": 900})
    context.add_init_script(path=FAULTS)
    visit, truth, tally = Visit(context, served.url), Truth(served.url), Counter[str]()
    # The test itself writes "-" into number fields.
    visit.allowed += ["422", "503", "ERR_", "Failed to load", "cannot be parsed"]
    page = visit.go("/dashboard?x_m=-60&y_m=80")
    expect(page.locator("#verdict .word")).to_be_visible()
    page.locator("#controls details").evaluate_all("(all) => all.forEach((one) => { one.open = true; })")
    wrong: dict[int, list[str]] = {}
    for k in range(SEQUENCES):
        if found := run_sequence(page, served, truth, random.Random(f"{SEED}/{k}"), tally):
            wrong[k] = found
        print(f"{k + 1} of {SEQUENCES} sequences of seed {SEED}: {dict(tally)}, wrong: {wrong}", flush=True)
    assert wrong == {}, f"sequences of seed {SEED}"
    assert tally["verdicts"] > SEQUENCES, "verdicts are shown"
    context.close()
    assert visit.faults() == []
