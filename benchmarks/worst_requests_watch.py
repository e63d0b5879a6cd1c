"""Watchers of a service from processes of their own: one asks for its health, one reads its memory.

The process that sends sixteen bodies of 8 MB is busy with them; asked from there, health seems to take half a second.
"""

from __future__ import annotations

import http.client
import multiprocessing
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import psutil

EVERY_S = 0.02
_PATIENCE_S = 120.0


def health(end: Connection, address: str) -> None:
    """Ask until told to stop; answers with the times of all requests, s."""
    client = http.client.HTTPConnection(urlsplit(address).netloc, timeout=_PATIENCE_S)
    times: list[float] = []
    end.send(None)
    while not end.poll(EVERY_S):
        begun = time.perf_counter()
        client.request("GET", "/healthz")
        client.getresponse().read()
        times.append(time.perf_counter() - begun)
    end.send(times)


def memory(end: Connection, pid: int) -> None:
    """Look until told to stop; answers with the peaks over a process and its children, bytes.

    By the names of :func:`memory_of`.
    """
    peaks: Counter[str] = Counter()
    service = psutil.Process(pid)
    end.send(None)
    while True:
        peaks |= memory_of([service, *service.children(recursive=True)])
        if end.poll(EVERY_S):
            break
    end.send(peaks)


def memory_of(processes: Iterable[psutil.Process]) -> Counter[str]:
    """Memory of processes together, bytes; what some of them share counts once.

    ``Pss``: proportional set size, with files that are mapped; ``Pss_Anon``: without them.
    """
    found: Counter[str] = Counter()
    for one in processes:
        with suppress(OSError):  # it has ended
            for line in Path(f"/proc/{one.pid}/smaps_rollup").read_text().splitlines()[1:]:
                name, value = line.split(":")
                if name in ("Pss", "Pss_Anon"):
                    found[name] += 1024 * int(value.split()[0])
    return found


@contextmanager
def watching(watch: Callable[[Connection, Any], None], what: object) -> Iterator[Callable[[], Any]]:
    """Run a watcher while the block does; the given function stops it and returns its answer."""
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=watch, args=(theirs, what), daemon=True)
    process.start()
    ours.recv()  # it has begun

    def stop() -> Any:
        ours.send(None)
        return ours.recv()

    try:
        yield stop
    finally:
        process.terminate()
        process.join()
