"""Time from a filter, a search or an order to the list of jobs that shows it, in Chromium, with many stored jobs.

``python -m benchmarks.job_list [NUMBER ...]`` (3000 and 100000 stored jobs). Run by hand: it needs a browser. A time
runs from the change of a field to the moment when the rows of the new answer stand on the page, without the 150 ms for
which the page waits whether somebody types on. ``SAFESTART_TEST_POSTGRESQL`` names a server to measure on instead of
SQLite.
"""

from __future__ import annotations

import json
import random
import shutil
import tempfile
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import psycopg
from playwright.sync_api import Page, sync_playwright
from sqlalchemy import insert

from benchmarks.asked import parser
from safestart.processes.registry import PROCESS_IDS, process
from safestart.store.database import Database
from safestart.store.jobs.labelling import searched
from safestart.store.models import JobRow, table
from tests.acceptance.running import serving
from tests.contract.store.store_backends import POSTGRESQL, fresh_url

QUIET_MS = 150.0
ROUNDS = 25
_WORDS = ("burn", "envisat", "night", "ground", "trial", "final", "slow", "fast", "dawn", "baseline")
_BATCH = 5000
_CHANGE = """async ([id, value]) => {
  const total = document.getElementById('total'), list = document.getElementById('list');
  const begun = performance.now(), field = document.getElementById(id);
  const drawn = new Promise((done) => {
    const seen = new MutationObserver(() => {
      if (list.classList.contains('old')) return;
      seen.disconnect();
      done(performance.now());
    });
    setTimeout(() => seen.observe(list, { attributes: true, attributeFilter: ['class'] }), 0);
  });
  if (id.startsWith('th')) document.querySelector(value).click();
  else {
    field.value = value;
    field.dispatchEvent(new Event(field.type === 'search' ? 'input' : 'change', { bubbles: true }));
  }
  return [await drawn - begun, total.textContent];
}"""


def fill(database: Database, number: int) -> None:
    """Store so many ended jobs, as clients leave them: with names, tags, outcomes and inputs."""
    chance, first = random.Random(0), datetime(2026, 1, 1, tzinfo=UTC)
    inputs = {
        name: process(name).parse(process(name).example).model_dump(mode="json") for name in PROCESS_IDS
    }
    for start in range(0, number, _BATCH):
        rows = [_row(k, chance, first, inputs) for k in range(start, min(start + _BATCH, number))]
        with database.session(write=True) as session:
            session.execute(insert(table(JobRow)), rows)


def _tidy(url: str) -> None:
    """What PostgreSQL does by itself some time after so many rows have come: an index alone then answers a search."""
    if POSTGRESQL:
        with psycopg.connect(url.replace("+psycopg", "", 1), autocommit=True) as connection:
            connection.execute("VACUUM ANALYZE jobs")


def _row(k: int, chance: random.Random, first: datetime, inputs: dict[str, Any]) -> dict[str, Any]:
    name = f"{chance.choice(_WORDS)} {chance.choice(_WORDS)} {k}" if chance.random() < 0.7 else ""
    tags = chance.sample(_WORDS, chance.randint(0, 3))
    kind = PROCESS_IDS[min(int(chance.expovariate(0.4)), len(PROCESS_IDS) - 1)]
    word = chance.choice(("GO", "NO_GO", "UNDECIDED", None))
    status = chance.choices(("successful", "failed", "dismissed"), (90, 7, 3))[0]
    begun = first + timedelta(seconds=30 * k)
    job = f"{chance.getrandbits(32):08x}-{k % 65536:04x}-4000-8000-{chance.getrandbits(48):012x}"
    outcome = {"word": word, "sense": "open", "count": 1, "of": 1, "basis": None} if word else None
    return {
        "id": job, "process_id": kind, "status": status, "priority": 0, "inputs": inputs[kind],
        "request_sha256": "0" * 64, "progress": 100.0, "message": "done", "attempts": 1, "timeout_s": 60.0,
        "created_at": begun, "started_at": begun, "finished_at": begun + timedelta(seconds=chance.expovariate(0.1)),
        "updated_at": begun, "name": name, "tags": tags, "note": "", "search": searched(job, kind, name, tags),
        "verdict": word, "outcome": outcome, "cancel_requested": False, "token": 1,
    }  # fmt: skip


def _changes() -> dict[str, list[tuple[str, str]]]:
    """What is done to the list, by kind."""
    back = [("status", ""), ("search", "")]
    return {
        "search": [("search", text) for k in range(ROUNDS) for text in (f"envisat {k}7", f"#{_WORDS[k % 10]}")],
        "a rare search": [("search", text) for k in range(ROUNDS) for text in (f"nothing{k}", f"dawn {k}99")],
        "filter": [
            pair
            for k in range(ROUNDS)
            for pair in (
                ("status", ("failed", "successful", "dismissed")[k % 3]),
                ("process", PROCESS_IDS[k % len(PROCESS_IDS)]),
                ("verdict", ("GO", "NO_GO")[k % 2]),
                ("verdict", ""),
                ("process", ""),
                *back[:1],
            )
        ],
        "order": [
            ("th", f"th[data-sort={column}] button")
            for _ in range(5)
            for column in ("name", "duration", "verdict", "status", "submitter", "created")
        ],
        "page": [("th", f"#{button}") for _ in range(ROUNDS) for button in ("older", "last", "newer", "first")],
    }  # fmt: skip


def measure(number: int) -> dict[str, Any]:
    """Seconds of the first list and, for each kind of change, the median and the 95th percentile."""
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        url = fresh_url("postgresql", Path(folder)) if POSTGRESQL else f"sqlite:///{folder}/list.sqlite3"
        database = Database(url)
        database.migrate()
        fill(database, number)
        _tidy(url)
        database.close()
        with serving(url) as address:
            browser = playwright.chromium.launch(
                executable_path=shutil.which("chromium"), args=["--no-sandbox"]
            )
            page = browser.new_page(viewport={"width": 1280, "height": 900})
            page.set_default_timeout(60_000)
            page.goto(f"{address}/dashboard/jobs")
            page.wait_for_selector(".jobs tbody tr")
            found: dict[str, Any] = {"jobs": number}
            for kind, changes in _changes().items():
                page.evaluate(_CHANGE, ["search", "burn"])
                if kind != "search":
                    page.evaluate(_CHANGE, ["search", ""])
                found[kind] = _spread([_seconds(page, change) for change in changes])
            browser.close()
    return found


def _seconds(page: Page, change: tuple[str, str]) -> float:
    took, _ = page.evaluate(_CHANGE, list(change))
    return (float(took) - QUIET_MS) / 1000.0


def _spread(times: list[float]) -> dict[str, float]:
    times.sort()
    return {"p50_s": round(times[len(times) // 2], 3), "p95_s": round(times[int(0.95 * (len(times) - 1))], 3)}


if __name__ == "__main__":
    asked = parser(__doc__)
    asked.add_argument("numbers", nargs="*", type=int, metavar="NUMBER", default=[3000, 100_000])
    for count in asked.parse_args().numbers:
        print(json.dumps(measure(count)))
