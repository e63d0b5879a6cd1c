"""Paths and query strings at random, to an application in this process: none may end in an unexpected error."""

from __future__ import annotations

import atexit
import random
import tempfile
from collections.abc import Callable
from contextlib import ExitStack
from functools import cache
from pathlib import Path
from typing import Any
from urllib.parse import quote

from starlette.testclient import TestClient

from tests.contract.api.service_client import service

PATHS = (
    "go-no-go",
    "go-no-go/proof",
    "jobs",
    "processes",
    "processes/{id}",
    "jobs/{id}",
    "jobs/{id}/results",
)
PATHS += ("jobs/{id}/events", "jobs/{id}/bundle", "jobs/{id}/inputs", "jobs/{id}/prov", "dashboard/compare")
GIVEN = {"omega_t_deg_s": "3", "a_max_m_s2": "0.1", "x_m": "5", "y_m": "40"}
TEXTS = (
    *(
        "",
        "0",
        "-1",
        "1e308",
        "1e999",
        "nan",
        "inf",
        "-0",
        "1_0",
        "0x1",
        "٣",
        "null",
        "true",
        "[]",
        "{}",
        "[[[[",
    ),
    *(
        "[2,25,1]",
        '{"kind":"spin"}',
        '{"a":1,"a":2}',
        "\0",
        "\ud800",
        "../..",
        "a" * 2000,
        "%",
        "%zz",
        "\r\nX: y",
    ),
    *(
        "certified",
        "auto",
        "paper",
        "exact",
        "stay",
        "synchronize",
        "lvlh",
        "body",
        "csv",
        "npz",
        "successful",
    ),
)


@cache
def application() -> tuple[TestClient, tuple[str, ...]]:
    """A service with an empty database, and the names of all parameters in its description."""
    held = ExitStack()
    atexit.register(held.close)
    folder = held.enter_context(tempfile.TemporaryDirectory())
    client = held.enter_context(service(Path(folder), rate_per_s=1e9, answer_processes=1))
    methods = [one for path in client.get("/openapi.json").json()["paths"].values() for one in path.values()]
    found = {item["name"] for one in methods for item in one.get("parameters", ()) if item["in"] == "query"}
    return client, tuple(sorted(found - {"wait"}))


def url(draw: random.Random) -> Callable[[], object]:
    """A path with parameters: known ones, unknown ones, twice, badly encoded."""
    client, names = application()
    path = draw.choice(PATHS).replace("{id}", _written(draw.choice((*TEXTS[:-8], "benchmark", "x")), draw))
    pairs: list[tuple[str, Any]] = [item for item in GIVEN.items() if draw.random() < 0.8]
    pairs += [(draw.choice((*names, "x", "")), draw.choice(TEXTS)) for _ in range(draw.randint(0, 4))]
    draw.shuffle(pairs)
    query = "&".join(f"{_written(name, draw)}={_written(text, draw)}" for name, text in pairs)
    asked = f"/{path}?{query}"

    def ask() -> object:
        answer = client.get(asked)
        if answer.status_code >= 500 and answer.status_code not in (503, 504):
            raise AssertionError(f"{answer.status_code} for {asked[:200]}")
        if answer.status_code >= 400 and answer.headers["content-type"] != "application/problem+json":
            raise AssertionError(f"{answer.status_code} without a problem for {asked[:200]}")
        return answer.status_code

    return ask


def _written(text: str, draw: random.Random) -> str:
    """Percent-encoded, mostly; else as far as a URL can hold it."""
    data = text.encode("utf-8", "surrogatepass")
    if draw.random() < 0.8:
        return quote(data, safe="")
    return quote(data, safe="%[]{}:,\"'@!$()*+;=/?~")
