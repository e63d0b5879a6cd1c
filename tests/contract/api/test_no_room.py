"""A machine without threads, memory or files for an answer: 503 on every route, and nothing refused is done later."""

from __future__ import annotations

import asyncio
import errno
import os
import shutil
import subprocess
import sys
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
import pytest

from safestart.errors import Unavailable
from safestart.store.jobs.repository import JobRepository
from safestart_service.access.keyring import Keyring
from safestart_service.computing.in_thread import begun
from safestart_service.computing.light import Threads
from safestart_service.shortage import shortage
from tests.contract.api.service_client import assert_problem, service, url_of
from tests.waiting import PATIENCE_S

THREADLESS = RuntimeError("can't start new thread")
STORED = [
    "/readyz",
    "/jobs",
    "/jobs/00000000-0000-0000-0000-000000000000",
    "/metrics",
    "/openapi.json",
    "/docs",
]
UID = str(300_000 + os.getpid() % 100_000)
"""The limit counts the processes of a user: one that nobody else is."""
AS_USER = [
    *("setpriv", f"--reuid={UID}", f"--regid={UID}", "--clear-groups", "--inh-caps=-all,+dac_override"),
    *("--ambient-caps=-all,+dac_override", "--bounding-set=-all,+dac_override"),
]


def caused(error: Exception, cause: Exception) -> Exception:
    error.__cause__ = cause
    return error


@pytest.mark.parametrize(
    "error",
    [
        THREADLESS,
        MemoryError(),
        OSError(errno.ENOMEM, "Cannot allocate memory", "/secret"),
        BlockingIOError(errno.EAGAIN, "Resource temporarily unavailable"),
        OSError(errno.EMFILE, "Too many open files", "/secret"),
        ImportError("/secret.so: failed to map segment from shared object"),
        ExceptionGroup("several", [MemoryError(), THREADLESS]),
        caused(ValueError("/secret"), MemoryError()),
        RuntimeError("cannot schedule new futures after shutdown"),
    ],
)
def test_what_is_no_room(error):
    found = shortage(error)
    assert isinstance(found, Unavailable)
    assert "secret" not in found.detail


@pytest.mark.parametrize(
    "error",
    [
        RuntimeError("another"),
        ValueError("can't start new thread"),
        FileNotFoundError(errno.ENOENT, "No such file"),
        ImportError("no module"),
        OSError("without a number"),
        ExceptionGroup("several", [MemoryError(), ValueError()]),
    ],
)
def test_what_is_a_fault(error):
    assert shortage(error) is None


@pytest.mark.parametrize("path", STORED)
def test_no_thread(client, monkeypatch, path):
    def refuse(_: threading.Thread) -> None:
        raise THREADLESS

    monkeypatch.setattr(threading.Thread, "start", refuse)
    monkeypatch.setattr("anyio._backends._asyncio.WorkerThread.start", refuse)
    monkeypatch.setattr("anyio._backends._asyncio._threadpool_idle_workers", _Nobody())
    answer = client.get(path)
    problem = assert_problem(answer, 503)
    assert problem["type"].endswith("unavailable")
    assert answer.headers["retry-after"]
    assert client.get("/healthz").status_code == 200


class _Nobody:
    """No idle thread from an earlier request."""

    def get(self) -> Any:
        raise LookupError

    def set(self, _: Any) -> None:
        pass


def test_no_memory(client, monkeypatch):
    def none(*_: Any, **__: Any) -> None:
        raise MemoryError

    for name in ("counts", "list"):
        monkeypatch.setattr(JobRepository, name, none)
    for path in ("/readyz", "/jobs"):
        assert assert_problem(client.get(path), 503)["required"] == "the same request later"


def test_what_was_refused_is_not_done_later(monkeypatch):
    """A pool queues work before it starts a thread for it: a thread that is there already would do it."""
    done: list[str] = []
    go_on = threading.Event()
    threads = ThreadPoolExecutor(2)

    async def ask() -> None:
        first = begun(threads, go_on.wait)
        with monkeypatch.context() as patch:
            patch.setattr(threading.Thread, "start", _refuse)
            with pytest.raises(RuntimeError, match="new thread"):
                begun(threads, lambda: done.append("refused"))
        go_on.set()
        await first
        await begun(threads, lambda: done.append("asked"))

    asyncio.run(ask())
    threads.shutdown()
    assert done == ["asked"]


def test_who_waits_when_it_closes_is_told():
    go_on = threading.Event()
    threads = Threads("answers are being computed", 1, 4)

    async def ask() -> None:
        first, second = begun(threads._pool, go_on.wait), begun(threads._pool, go_on.wait)
        threads.close()
        go_on.set()
        await first
        with pytest.raises(asyncio.CancelledError):
            await asyncio.wait_for(second, PATIENCE_S)

    asyncio.run(ask())


def _refuse(_: threading.Thread) -> None:
    raise THREADLESS


@pytest.mark.parametrize("error", [MemoryError(), THREADLESS, ValueError("a fault")])
def test_keys_are_read_again_after_any_error(monkeypatch, error):
    """Else a key that is revoked elsewhere would pass for ever."""
    read: list[int] = []
    monkeypatch.setattr("safestart_service.access.keyring.REFRESH_S", 0.001)

    def load() -> None:
        read.append(1)
        raise error

    async def keep() -> None:
        keyring = Keyring(None)  # type: ignore[arg-type]
        monkeypatch.setattr(keyring, "load", load)
        async with keyring.kept_fresh():
            while len(read) < 5:
                await asyncio.sleep(0.001)

    asyncio.run(asyncio.wait_for(keep(), PATIENCE_S))


def test_it_starts_without_a_thread(tmp_path, monkeypatch):
    """And migrates the database once there is one."""
    submit, refused = ThreadPoolExecutor.submit, iter([True])

    def first_refused(pool: ThreadPoolExecutor, *given: Any, **more: Any) -> Any:
        if next(refused, False):
            raise THREADLESS
        return submit(pool, *given, **more)

    monkeypatch.setattr(ThreadPoolExecutor, "submit", first_refused)
    with service(tmp_path) as client:
        assert client.get("/healthz").status_code == 200


@contextmanager
def cramped(folder: Path, most: int) -> Iterator[tuple[str, Path]]:
    """The address of a real service whose user may have so many processes and threads, and what it says.

    With three it has them as soon as it serves.
    """
    if sys.platform != "linux" or os.geteuid() != 0 or shutil.which("setpriv") is None:
        pytest.skip("only root can be another user")
    folder.chmod(0o777)
    limited = ["bash", "-c", f'ulimit -u {most}; exec "$@"', "bash"]
    asked = [
        sys.executable,
        "-B",
        "-m",
        "safestart",
        "serve",
        "--port",
        "0",
        "--database-url",
        url_of(folder),
    ]
    said = folder / "said"
    with said.open("w") as errors:
        command = [*AS_USER, *limited, *asked]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=errors, text=True)
    assert process.stdout is not None
    line = process.stdout.readline()
    if not line:
        process.wait(PATIENCE_S)
        pytest.skip("this machine gives us no other user")
    try:
        yield line.split()[1], said
    finally:
        process.terminate()
        process.wait(PATIENCE_S)


def test_a_user_without_processes(tmp_path):
    """No answer of the store finds a thread; those that need none are given."""
    with cramped(tmp_path, 3) as (address, _):
        for path in STORED:
            assert_problem(httpx.get(address + path, timeout=PATIENCE_S), 503)
        for path in ("/healthz", "/conformance", "/go-no-go?omega_t_deg_s=3&a_max_m_s2=0.1&x_m=5&y_m=40"):
            assert httpx.get(address + path, timeout=PATIENCE_S).status_code == 200


@pytest.mark.parametrize("most", [1, 4, 5, 6, 7])
def test_whatever_finds_no_process_says_so_in_one_line(tmp_path, most):
    with cramped(tmp_path, most) as (address, said):
        inputs = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "states": [{"x_m": 5, "y_m": 40}], "method": "exact"}
        answer = httpx.post(address + "/go-no-go", json=inputs, timeout=PATIENCE_S)
        assert answer.status_code in {200, 503}
        assert httpx.get(address + "/healthz", timeout=PATIENCE_S).status_code == 200
    assert "Traceback" not in said.read_text()
