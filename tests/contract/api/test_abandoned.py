"""Answers that no client waits for are not computed: neither running ones nor those in line."""

from __future__ import annotations

import asyncio
import json
import socket
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import httpx
import pytest
from fastapi import Request
from starlette.requests import ClientDisconnect

from safestart.runtime.progress import Context
from safestart_service.computing.light import Threads
from tests.acceptance.running import serving
from tests.contract.api.service_client import service
from tests.waiting import PATIENCE_S, until

REGION = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1}


def test_work_whose_client_leaves_is_told_so(tmp_path: Path) -> None:
    began: list[str] = []
    gone = threading.Event()

    def endless(left: Callable[[], bool]) -> None:
        began.append("endless")
        while True:
            Context(cancelled=left).step(0, 1)
            time.sleep(0.001)

    computed = Threads("answers are being computed", 1, 2)

    async def receive() -> dict[str, Any]:
        while not gone.is_set():
            await asyncio.sleep(0.001)
        return {"type": "http.disconnect"}

    async def run(client: Any) -> list[BaseException | None]:
        scope = {
            "type": "http",
            "method": "GET",
            "path": "/",
            "headers": [],
            "query_string": b"",
            "app": client.app,
        }
        request = Request(scope, receive)
        first = asyncio.create_task(computed(request, endless))
        await asyncio.to_thread(until, lambda: began, "work under way")
        gone.set()
        found: list[BaseException | None] = list(await asyncio.gather(first, return_exceptions=True))
        return found

    with service(tmp_path) as client:
        (ended,) = asyncio.run(run(client))
    assert isinstance(ended, ClientDisconnect)


@pytest.mark.timeout(900)
def test_a_region_does_not_wait_behind_regions_that_were_given_up(tmp_path: Path) -> None:
    """Seen: a region of 60 s waited 107 s behind abandoned ones of 596 s."""
    with serving(f"sqlite:///{tmp_path / 'a.sqlite3'}") as url:
        alone = _region(url, 60)
        at = urlsplit(url)
        for k in range(12):
            body = json.dumps({"inputs": REGION | {"horizon_s": 596, "omega_t_deg_s": 1 + 0.1 * k}}).encode()
            with socket.create_connection((at.hostname or "", at.port or 0)) as peer:
                peer.sendall(
                    b"POST /processes/safe-region/execution HTTP/1.1\r\nHost: 127.0.0.1\r\n"
                    b"Content-Type: application/json\r\nContent-Length: %d\r\n\r\n" % len(body) + body
                )
                time.sleep(0.05)
        assert _region(url, 58) < 20 * alone + 10, "twelve of 596 s take minutes"


def _region(url: str, horizon_s: int) -> float:
    begun = time.monotonic()
    inputs = {"inputs": REGION | {"horizon_s": horizon_s}}
    httpx.post(f"{url}/processes/safe-region/execution", json=inputs, timeout=PATIENCE_S).raise_for_status()
    return time.monotonic() - begun
