"""A real server, and raw bytes to and from it."""

from __future__ import annotations

import json
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from tests.contract.api.service_client import url_of
from tests.waiting import PATIENCE_S

HOST = b"Host: localhost\r\n"
PLACES = 12
STREAMS = 3
Address = tuple[str, int]


@contextmanager
def small_server(folder: Path, streams: int = STREAMS) -> Iterator[Address]:
    """A server with few places and little patience for heads and readers, but much for bodies.

    Its helper process starts with the first heavy answer, which most of its tests never ask for.
    """
    chosen = {
        "port": 0,
        "database_url": url_of(folder),
        "max_connections": PLACES,
        "max_followers": streams,
        "request_timeout_s": 3600.0,
    }
    code = (
        "import safestart_service.http.wire as wire, safestart_service.http.unread as unread;"
        "import safestart_service.app as app; make = app.create_app;"
        "app.create_app = lambda *given, warm, source: make(*given, source=source);"
        "wire.HEAD_S = 5.0; unread.UNREAD_S = 1.0;"
        f"import safestart_service.commands as c; c._serve({chosen!r})"
    )
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    yield "127.0.0.1", int(process.stdout.readline().split()[1].rpartition(":")[2])
    process.terminate()
    process.wait(PATIENCE_S)


def said(address: tuple[str, int], *pieces: bytes) -> bytes:
    """All that comes back until the server closes the connection."""
    with socket.create_connection(address, timeout=PATIENCE_S) as connection:
        for piece in pieces:
            try:
                connection.sendall(piece)
            except (BrokenPipeError, ConnectionResetError):
                break
        found = b""
        try:
            while data := connection.recv(65536):
                found += data
        except ConnectionResetError:  # it was closed with bytes of ours unread
            pass
        return found


def problem_in(answer: bytes, status: int) -> dict[str, Any]:
    """The one problem document of which the answer consists."""
    head, _, body = answer.partition(b"\r\n\r\n")
    lines = head.decode("latin-1").split("\r\n")
    assert lines[0].startswith(f"HTTP/1.1 {status} "), answer[:300]
    headers = dict(line.lower().split(": ", 1) for line in lines[1:])
    assert headers["content-type"] == "application/problem+json"
    assert int(headers["content-length"]) == len(body)
    assert headers["connection"] == "close"
    assert headers["x-content-type-options"] == "nosniff"
    problem: dict[str, Any] = json.loads(body)
    assert set(problem) >= {"type", "title", "status", "detail", "instance", "field", "required", "received"}
    assert (problem["status"], problem["request_id"]) == (status, headers["x-request-id"])
    return problem
