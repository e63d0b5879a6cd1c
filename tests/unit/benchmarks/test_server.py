"""A benchmark begins when the service answers, not some seconds after its start."""

from __future__ import annotations

from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, HTTPServer
from threading import Thread

import pytest

from benchmarks.server import answered


class Late(BaseHTTPRequestHandler):
    """Refuses two requests, as a service whose helper process still starts; never knows ``/absent``."""

    asked = 0

    def do_GET(self) -> None:
        Late.asked += 1
        self.send_response(404 if self.path == "/absent" else 503 if Late.asked < 3 else 200)
        self.end_headers()

    def log_message(self, *_: object) -> None:
        """Nothing."""


@pytest.fixture
def port() -> Iterator[int]:
    with HTTPServer(("127.0.0.1", 0), Late) as http:
        Late.asked = 0
        thread = Thread(target=http.serve_forever, args=(0.01,))
        thread.start()
        yield http.server_port
        http.shutdown()
        thread.join()


def test_a_refusal_is_asked_again(port: int) -> None:
    answered(port, "/late")
    assert Late.asked == 3


def test_a_mistake_is_not(port: int) -> None:
    with pytest.raises(RuntimeError, match=r"answer to /absent .*404"):
        answered(port, "/absent")
    assert Late.asked == 1


def test_patience_has_an_end() -> None:
    with pytest.raises(RuntimeError, match=r"/healthz within 0\.1 s, received: .*refused"):
        answered(1, "/healthz", within_s=0.1)
