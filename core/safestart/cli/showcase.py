"""The work of ``safestart demo``: the whole path on this machine, from the POST to the printed Table 2."""

from __future__ import annotations

import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import httpx

from safestart.cli.console import err, out, print_json, reporting
from safestart.cli.reproduce.command import DIFFERENCES, show_table2, table2_inputs, table2_rows
from safestart.errors import Unavailable
from safestart.papers import safe_start as published
from safestart.public.following import tell
from safestart.runtime.reporting import Reporting
from safestart.runtime.settings import settings

_START_LIMIT_S = 300.0
_READY_POLL_S = 0.2


def demonstrate(as_json: bool) -> None:
    """Start everything, submit the Table 2 benchmarks over HTTP, follow them, print the table, stop."""
    with _running() as client:
        jobs = {rate: _submit(client, rate) for rate in published.TABLE2}
        for rate, job in jobs.items():
            with reporting(f"benchmark at {rate:g} deg/s") as context:
                _follow(client, job, context)
        rows: list[dict[str, Any]] = []
        for rate, job in jobs.items():
            document = _json(client.get(f"/jobs/{job}/results"))
            rows += table2_rows(rate, document["outputs"])
        urls = [str(client.base_url.join(f"/dashboard/jobs/{job}")) for job in jobs.values()]
    if as_json:
        print_json({"rows": rows, "differences": list(DIFFERENCES), "jobs": urls})
        return
    show_table2(rows)
    out.print("\nStored; [bold]safestart up[/] serves them again (the database keeps them):")
    for url in urls:
        out.print(f"  {url}", soft_wrap=True)


@contextmanager
def _running() -> Iterator[httpx.Client]:
    """``safestart up`` on a free port, ready to answer; stopped at the end."""
    host, port = "127.0.0.1", _free_port(settings().port)
    command = [sys.executable, "-m", "safestart", "up", "--host", host, "--port", str(port)]
    child = subprocess.Popen(command, stdout=sys.stderr, stderr=sys.stderr)
    try:
        with client_of(f"http://{host}:{port}") as client:
            _await_ready(client, child)
            yield client
    finally:
        child.send_signal(signal.SIGINT)
        try:
            child.wait(timeout=30.0)
        except subprocess.TimeoutExpired:
            child.kill()


def client_of(url: str) -> httpx.Client:
    """A client of a service on this machine; the environment's proxies cannot reach it and are not asked."""
    return httpx.Client(base_url=url, timeout=30.0, trust_env=False)


def _free_port(wanted: int) -> int:
    """The configured port if it is free, so that printed URLs stay valid under ``safestart up``; else any port."""
    for port in (wanted, 0):
        with socket.socket() as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                continue
            free: int = probe.getsockname()[1]
            return free
    raise Unavailable("demo: required a free port on 127.0.0.1, found none")


def _await_ready(client: httpx.Client, child: subprocess.Popen[bytes]) -> None:
    start = time.monotonic()
    while time.monotonic() - start < _START_LIMIT_S:
        if child.poll() is not None:
            raise Unavailable(
                f"demo: 'safestart up' ended with exit code {child.returncode}; its lines are above"
            )
        try:
            if client.get("/readyz").status_code == httpx.codes.OK:
                err.print(f"service ready after {time.monotonic() - start:.1f} s")
                return
        except httpx.TransportError:
            pass
        time.sleep(_READY_POLL_S)
    raise Unavailable(f"demo: required a ready service within {_START_LIMIT_S:g} s of start")


def _json(response: httpx.Response) -> dict[str, Any]:
    document: dict[str, Any] = response.json()
    if response.is_error:
        raise Unavailable(
            f"demo: {response.request.url} answered {response.status_code}: {document.get('detail')}"
        )
    return document


def _submit(client: httpx.Client, rate: float) -> str:
    start = time.monotonic()
    answer = _json(client.post("/processes/benchmark/execution", json={"inputs": table2_inputs(rate)}))
    certificate = answer["certificate"]
    err.print(
        f"{rate:g} deg/s: certificate in {1e3 * (time.monotonic() - start):.0f} ms "
        f"(r_sync {certificate['r_sync_m']:.1f} m, {100 * certificate['safe_fraction']:.1f} % of the corridor), "
        f"job {answer['jobID']} queued",
        soft_wrap=True,
    )
    job: str = answer["jobID"]
    return job


def _follow(client: httpx.Client, job: str, context: Reporting) -> None:
    while True:
        status = _json(client.get(f"/jobs/{job}"))
        if status["status"] == "successful":
            return
        if status["status"] in ("failed", "dismissed"):
            reason = (status.get("problem") or {}).get("detail", status.get("message"))
            raise Unavailable(f"demo: job {job} {status['status']}: {reason}")
        tell(context, status)
        time.sleep(0.3)
