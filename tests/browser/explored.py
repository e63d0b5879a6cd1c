"""Explore in the view of a test: the contents of its fields, the page's statements about them, and the truth.

The truth comes from the service, from the fields alone, without the page's scripts.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import httpx
from playwright.sync_api import Page

from tests.acceptance.running import PATIENT, answers
from tests.waiting import PATIENCE_S, free_port, until

FAULTS = Path(__file__).with_name("faults.js")
NUMBER = re.compile(r"-?(\d+(\.\d+)?|\.\d+)(e[+-]?\d+)?", re.IGNORECASE)
SPREADS = (
    "omega_t_half_width_deg_s",
    "a_max_half_width_m_s2",
    "position_half_width_m",
    "velocity_half_width_m_s",
    "disturbance_m_s2",
)
SHAPE = ("c_x", "x0_m", "r_h_m")
POINT = ("omega_t_deg_s", "a_max_m_s2", "mean_motion_rad_s")

_SEEN = """() => {
  const fields = {};
  for (const field of document.querySelectorAll("#controls [name], #start [name]")) {
    fields[field.id] = field.validity.badInput ? "no number" : field.value;
  }
  const map = document.getElementById("map"), shown = !map.hidden && !map.classList.contains("old");
  const trace = (name) => shown ? (map.data ?? []).find((one) => one.name === name) ?? null : null;
  const region = trace("exact: proved GO"), certified = trace("certified, for ever");
  const card = document.querySelector("#verdict .answer:not(.old)");
  const aside = document.querySelector("#verdict .aside:not(.old) .closed-word");
  return {
    fields,
    word: card && card.querySelector(".word").textContent,
    why: card && (card.querySelector(".why") ?? card.querySelector("p")).textContent,
    closed: aside && aside.textContent,
    flown: document.getElementById("flown").textContent,
    region: region && region.x.map((x, k) => [x, region.y[k]]),
    certified: certified && certified.z.filter((_, k) => k % 8 === 0).map((row) => row.filter((_, k) => k % 8 === 0)),
    problem: document.querySelector("#verdict .problem")?.textContent ?? null,
  };
}"""
_EDIT = """(edits) => {
  const seen = SEEN;
  for (const [id, value] of edits) {
    const field = document.getElementById(id);
    field.value = value;
    field.dispatchEvent(new Event("input", { bubbles: true }));
    if (field.tagName === "SELECT") field.dispatchEvent(new Event("change", { bubbles: true }));
  }
  return seen();
}""".replace("SEEN", _SEEN)

Seen = dict[str, Any]


class Served:
    """``safestart serve`` at one address, to be killed and started again."""

    def __init__(self, folder: Path) -> None:
        self.url = f"http://127.0.0.1:{free_port()}"
        address = f"sqlite:///{folder / 'served.sqlite3'}"
        self._environment = PATIENT | os.environ | {"SAFESTART_DATABASE_URL": address}
        self.start()

    def start(self) -> None:
        """Start, and wait for an answer."""
        command = [sys.executable, "-m", "safestart", "serve", "--port", self.url.rpartition(":")[2]]
        self._process = subprocess.Popen(command, env=self._environment)
        until(lambda: answers(self.url, self._process), "a service that answers")

    def kill(self) -> None:
        """End it in the middle of whatever it does."""
        self._process.kill()
        self._process.wait(PATIENCE_S)


def seen(page: Page) -> Seen:
    """One moment of the page."""
    found: Seen = page.evaluate(_SEEN)
    return found


def edit(page: Page, **texts: str) -> Seen:
    """Write into fields as a user does, and look before anything else can happen."""
    found: Seen = page.evaluate(_EDIT, list(texts.items()))
    return found


def settled(page: Page) -> Seen:
    """The page once it has an answer or a problem, and nothing is under way."""
    until(
        lambda: page.evaluate(
            """() => window.faults.waiting === 0 && !document.querySelector('#verdict .old, #map.old, [role=status]')"""
        ),
        "a page at rest",
    )
    return seen(page)


class Truth:
    """What the service says about the inputs that stand in the fields."""

    def __init__(self, url: str) -> None:
        self._client = httpx.Client(base_url=url, timeout=PATIENCE_S)
        self._kept: dict[str, Any] = {}

    def verdict(self, fields: dict[str, str], method: str = "auto") -> dict[str, Any] | None:
        """The answer to the question in the fields; None where they hold none that the service takes."""
        if not self._readable(fields, start=True):
            return None
        names = [*POINT, *SHAPE, "rest", "x_m", "y_m"]
        if method != "paper":
            names += ["question", "horizon_s", *SPREADS]
            names += ["within_s"] if fields["question"] == "synchronize" else []
        return self._get("/go-no-go", {name: fields[name] for name in names} | {"method": method})

    def flight(self, fields: dict[str, str]) -> dict[str, Any] | None:
        """The flight that belongs to the fields."""
        if not self._readable(fields, start=True):
            return None
        start = {name: float(fields[name]) for name in ("x_m", "y_m")}
        inputs = (
            self._scenario(fields) | {name: fields[name] for name in ("rest", "question")} | {"start": start}
        )
        inputs["horizon_s"] = float(fields["horizon_s"])
        if fields["question"] == "synchronize":
            inputs["within_s"] = float(fields["within_s"])
        return self._post("/processes/flight/execution", {"inputs": inputs})

    def region(self, fields: dict[str, str]) -> list[list[float]] | None:
        """The proved polygon on the map, closed; None without one."""
        if fields["rest"] != "lvlh" or not self._readable(fields, start=False):
            return None
        more = {name: float(fields[name]) for name in ("horizon_s", "y_max_m")}
        found = self._post("/processes/safe-region/execution", {"inputs": self._scenario(fields) | more})
        polygon = found["inner_polygon_m"] if found else []
        return [*polygon, polygon[0]] if polygon else None

    def certified(self, fields: dict[str, str]) -> list[list[float]] | None:
        """Margins of the certified set on the map's grid."""
        if not self._readable(fields, start=False):
            return None
        grid = {"nx": 81, "ny": 81, "y_max_m": float(fields["y_max_m"])}
        found = self._post("/certificates", self._scenario(fields) | {"rest": fields["rest"], "grid": grid})
        return None if found is None else found["margin_m"]

    def _readable(self, fields: dict[str, str], *, start: bool) -> bool:
        texts = {name: text for name, text in fields.items() if name not in ("question", "rest")}
        if not start and not texts["x_m"] and not texts["y_m"]:
            texts = {name: text for name, text in texts.items() if name not in ("x_m", "y_m")}
        return all(NUMBER.fullmatch(text) for text in texts.values())

    def _scenario(self, fields: dict[str, str]) -> dict[str, Any]:
        return {name: float(fields[name]) for name in POINT} | {
            "corridor": {name: float(fields[name]) for name in SHAPE}
        }

    def _get(self, path: str, query: dict[str, str]) -> Any:
        return self._once(f"{path}?{httpx.QueryParams(query)}", lambda: self._client.get(path, params=query))

    def _post(self, path: str, body: dict[str, Any]) -> Any:
        return self._once(f"{path} {body}", lambda: self._client.post(path, json=body))

    def _once(self, key: str, ask: Any) -> Any:
        if key not in self._kept:
            self._kept[key] = until(lambda: self._answer(ask), key)[0]
        return self._kept[key]

    def _answer(self, ask: Any) -> list[Any] | None:
        """[document], [None] where it is refused, None while the service is away."""
        try:
            found = ask()
        except httpx.TransportError:
            return None
        if found.status_code == 422:
            return [None]
        return [found.json()] if found.is_success else None


def faults_in(found: Seen, truth: Truth) -> list[str]:
    """What a moment of the page shows that is not so; empty where every verdict shown is true of the fields."""
    fields, wrong = found["fields"], []
    if found["word"] is not None:
        told = (found["word"].replace(" ", "_"), _plain(found["why"]))
        true = truth.verdict(fields)
        if true is None or told != (true["verdict"], _plain(true["reason"])):
            wrong.append(f"verdict {told}; true: {true and (true['verdict'], true['reason'])}")
    if found["closed"] is not None:
        true = truth.verdict(fields, "paper")
        if true is None or true["verdict"] != found["closed"].replace(" ", "_"):
            wrong.append(f"the paper's conditions {found['closed']}; true: {true and true['verdict']}")
    if found["region"] is not None and truth.region(fields) != found["region"]:
        wrong.append("the exact region on the map is another one")
    if found["certified"] is not None:
        margins = truth.certified(fields)
        if margins is None or [row[::8] for row in margins[::8]] != found["certified"]:
            wrong.append("the certified set on the map is another one")
    if re.search(r"\d", found["flown"]):
        flight = truth.flight(fields)
        if flight is None or not _tells(found["flown"], flight):
            wrong.append(f"flight: {found['flown']}; true: {flight and flight['closest_m']}")
    return [f"{one}; fields {fields}" for one in wrong]


def _plain(sentence: str) -> str:
    return sentence.rstrip(".").lower()


def _tells(text: str, flight: dict[str, Any]) -> bool:
    """Whether the caption gives this flight's number, to its four digits: at worst, or of a start outside."""
    outside = min(flight["distance_m"][0])
    true = -outside if outside < 0 else abs(flight["closest_m"])
    number = re.search(r"(?:At worst|corridor,|closest to \w+,) (-?[\d.e+-]+) m", text)
    return number is not None and abs(abs(float(number[1])) - true) <= 6e-4 * true + 1e-9
