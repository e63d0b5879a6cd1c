"""One peer that takes all it can get of a real server: connections, memory, threads. The others are answered."""

from __future__ import annotations

import json
import re
import socket
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from functools import partial

import httpx
import pytest
from fastapi import Request

from safestart.errors import InvalidInput
from safestart_service.access.callers import Callers
from safestart_service.http.open_files import make_room
from safestart_service.http.places import Places
from safestart_service.http.wire import MOST_AHEAD, holder
from tests.contract.api.service_client import HEAVY, POINT, assert_problem, service
from tests.contract.server.raw_http import HOST, PLACES, STREAMS, problem_in, said, small_server
from tests.waiting import PATIENCE_S, until

ASKED = b"GET /nothing HTTP/1.1\r\n" + HOST + b"\r\n"
CHUNKED = b"POST /nothing HTTP/1.1\r\n" + HOST + b"Transfer-Encoding: chunked\r\n"
WAITING = (
    b"POST /certificates HTTP/1.1\r\n" + HOST + b"Content-Type: application/json\r\nContent-Length: 9\r\n"
)


def well(address) -> bool:
    """Health is answered on a separate connection."""
    return said(address, b"GET /healthz HTTP/1.0\r\n\r\n").startswith(b"HTTP/1.1 200 ")


def taken(address, held: ExitStack) -> tuple[int, bytes]:
    """Number of accepted connections before one is refused, and the answer to that one."""
    for number in range(PLACES + 1):
        connection = held.enter_context(socket.create_connection(address, timeout=PATIENCE_S))
        connection.sendall(WAITING + b"Expect: 100-continue\r\n\r\n")
        told = connection.recv(65536)
        if not told.startswith(b"HTTP/1.1 100 "):
            while data := connection.recv(65536):
                told += data
            return number, told
    raise AssertionError("nobody was turned away")


def test_a_full_house(address):
    """All places are used, the next client gets a refusal, and a freed place is used again."""

    def full() -> bytes | None:
        with ExitStack() as held:
            number, told = taken(address, held)
        return told if number == PLACES else None

    for _ in range(2):
        told = until(full, f"{PLACES} places")
        problem = problem_in(told, 503)
        assert problem["type"].endswith("too-many-connections")
        assert str(PLACES) in problem["required"]
        assert b"\r\nretry-after: " in told
    until(lambda: well(address), "an answer once the house is empty")


def test_who_says_nothing_is_turned_away_too(address):
    with ExitStack() as held:
        until(lambda: taken(address, held)[1], "a full house")
        assert problem_in(said(address), 503)
    until(lambda: well(address), "an answer once the house is empty")


def test_answers_that_nobody_reads(address):
    """They hold their places for a while, not for ever."""
    asked = (b"GET /static/plotly.min.js HTTP/1.1\r\n" + HOST + b"\r\n") * 3
    with ExitStack() as held:
        for _ in range(PLACES):
            connection = held.enter_context(socket.socket())
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            connection.connect(address)
            connection.sendall(asked)
        until(lambda: well(address), "a place that an unread answer had")


def test_trailers_are_no_headers(address):
    told = said(address, CHUNKED + b"Connection: close\r\n\r\n0\r\nX-Request-ID: from-a-trailer\r\n\r\n")
    assert told.startswith(b"HTTP/1.1 404 ")
    assert b"from-a-trailer" not in told


def test_one_answer_to_one_request(address):
    """What goes wrong behind an early answer must not look like the answer to the next request."""
    with socket.create_connection(address, timeout=PATIENCE_S) as connection:
        connection.sendall(CHUNKED + b"\r\n2\r\n{}\r\n")
        found = connection.recv(65536)
        while not found.endswith(b"}"):
            found += connection.recv(65536)
        assert found.startswith(b"HTTP/1.1 404 ")
        connection.sendall(b"ZZ\r\n")
        assert connection.recv(65536) == b""


def test_requests_in_a_row(address):
    last = ASKED.replace(b"Host", b"Connection: close\r\nHost")
    for number in (1, MOST_AHEAD, 150):
        assert said(address, ASKED * (number - 1) + last).count(b"HTTP/1.1 404 ") == number
    with socket.create_connection(address, timeout=PATIENCE_S) as connection, ThreadPoolExecutor() as pool:
        sent = pool.submit(connection.sendall, ASKED * (100 * MOST_AHEAD - 1) + last)
        found = 0
        while data := connection.recv(65536):
            found += data.count(b"x-request-id")
        sent.result()
    assert found > 99 * MOST_AHEAD, "but for names that two reads cut in two"


def test_requests_in_a_row_are_answered_in_order(address):
    """Also for answers of different kinds and durations, and with a body among the requests."""
    body = json.dumps({**POINT, "padding": "x" * 20_000}).encode()
    long = WAITING.replace(b"Length: 9", b"Length: %d" % len(body)) + b"\r\n" + body
    asked, due = [], []
    for number in range(150):
        path = f"/nothing-{number}".encode()
        head = b"GET " + path + b" HTTP/1.1\r\n" + HOST + b"X-Request-ID: n%d\r\n\r\n" % number
        asked.append(
            long.replace(HOST, HOST + b"X-Request-ID: n%d\r\n" % number) if number % 50 == 7 else head
        )
        due.append(f"n{number}")
    last = ASKED.replace(b"Host", b"Connection: close\r\nHost")
    told = said(address, b"".join(asked) + last).decode()
    assert re.findall(r"x-request-id: (n\d+)", told) == due
    assert told.count("HTTP/1.1 422 ") == 3


def test_so_many_follow_and_no_more(address):
    """Also who leaves with a request still behind the stream gives the place back."""
    with httpx.Client(base_url=f"http://{address[0]}:{address[1]}", timeout=PATIENCE_S) as client:
        job = client.post("/processes/benchmark/execution", json=HEAVY).json()["jobID"]
        follow = f"GET /jobs/{job}/events HTTP/1.1\r\n".encode() + HOST + b"\r\n"

        def follows(held: ExitStack) -> bool:
            with ExitStack() as own:
                connection = own.enter_context(socket.create_connection(address, timeout=PATIENCE_S))
                connection.sendall(follow + ASKED)
                if connection.recv(12) != b"HTTP/1.1 200":
                    return False
                held.enter_context(own.pop_all())
            return True

        for _ in range(2):
            with ExitStack() as held:
                for _ in range(STREAMS):
                    until(partial(follows, held), "a place for a stream")
                assert not follows(held)
                for path in (f"/jobs/{job}/events", f"/jobs/{job}?wait=20"):
                    refused = client.get(path)
                    assert refused.status_code == 429
                    assert int(refused.headers["retry-after"]) > 0
                    assert json.loads(refused.text)["type"].endswith("rate-limited")
                assert client.get(f"/jobs/{job}").status_code == 200
        client.delete(f"/jobs/{job}")


def test_every_line_has_an_end(tmp_path):
    """Each class of work has its own line; a full one refuses, and the others go on."""
    with service(tmp_path) as client:
        found = client.app.state.services
        found.light.callers = Callers("answers are being computed", 2)
        found.helpers.callers = Callers("heavy answers are asked for", 2)
        found.submitting.callers = Callers("submissions are under way", 2)
        ask = {**POINT, "x_m": 5, "y_m": 40}
        certified = {**POINT, "method": "certified", "states": [{"x_m": 5, "y_m": 40}]}
        light, heavy, submission = found.light.callers, found.helpers.callers, found.submitting.callers
        calls = (
            (heavy, 200, partial(client.get, "/go-no-go", params={**ask, "method": "exact"})),
            (heavy, 200, partial(client.get, "/go-no-go/proof", params=ask)),
            (light, 200, partial(client.post, "/go-no-go", json=certified)),
            (light, 200, partial(client.post, "/certificates", json=POINT)),
            (light, 200, partial(client.post, "/processes/certificate/execution", json={"inputs": POINT})),
            (submission, 201, partial(client.post, "/processes/benchmark/execution", json=HEAVY)),
        )
        for line, status, call in calls:
            assert call().status_code == status
            assert line.now == 0
            with ExitStack() as held:
                for _ in range(2):
                    held.enter_context(line.place(Request({"type": "http"})))
                refused = call()
                for other, due, ask_other in calls:
                    if other is not line:
                        answered = ask_other()
                        assert answered.status_code == due, answered.text
            assert int(refused.headers["retry-after"]) > 0
            assert "at most 2 at once" in assert_problem(refused, 429)["detail"]
        assert client.get("/go-no-go", params=ask).status_code == 200


def test_one_name_has_half_of_the_places():
    places = Places(5)
    assert [places.take("a") for _ in range(3)] == [True, True, False]
    assert [places.take(None) for _ in range(4)] == [True, True, True, False]
    places.leave("a")
    assert [places.take("b"), places.take("a")] == [True, False]
    for name in ("a", "b", None, None, None):
        places.leave(name)
    assert (places.taken, places._by) == (0, {})


@pytest.mark.parametrize(
    ("address", "name"),
    [
        ("127.0.0.1", None),
        ("::1", None),
        ("", None),
        ("192.0.2.7", "192.0.2.7"),
        ("::ffff:192.0.2.7", "::ffff:192.0.2.7"),
        ("2001:db8:1:2:3::4", "2001:db8:1:2::/64"),
        ("2001:db8:1:2:ffff::", "2001:db8:1:2::/64"),
        ("fe80::1%eth0", "fe80::/64"),
    ],
)
def test_whose_a_connection_is(address, name):
    assert holder(address) == name


def test_no_more_connections_than_files(monkeypatch):
    resource = pytest.importorskip("resource")
    set_to: list[tuple[int, int]] = []
    monkeypatch.setattr(resource, "getrlimit", lambda _: (256, 2048))

    def change(_: int, limits: tuple[int, int]) -> None:
        if limits[0] > limits[1]:
            raise ValueError
        set_to.append(limits)

    monkeypatch.setattr(resource, "setrlimit", change)
    make_room(10)
    assert set_to == []
    make_room(800)
    assert set_to == [(1024, 2048)]
    with pytest.raises(InvalidInput, match="max_connections: required at most 1824"):
        make_room(2000)


def test_too_few_files_for_anything_say_what_the_system_has_to_allow(monkeypatch):
    resource = pytest.importorskip("resource")
    monkeypatch.setattr(resource, "getrlimit", lambda _: (64, 64))
    with pytest.raises(
        InvalidInput, match=r"a system that lets this process open 234 files, not 64 \(ulimit -n\)"
    ):
        make_room(10)


def test_long_answers_that_nobody_reads_are_not_collected_without_end(tmp_path):
    """80 bytes ask for a certificate of 25 MB, and 800 connections that read nothing held 20 GB."""
    body = json.dumps({**POINT, "grid": {"nx": 1000, "ny": 1000, "y_max_m": 150}}).encode()
    head = b"POST /certificates HTTP/1.1\r\n" + HOST + b"Content-Type: application/json\r\n"
    asked = head + b"Content-Length: %d\r\n\r\n" % len(body) + body

    def status(connection: socket.socket) -> bytes:
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2048)
        connection.sendall(asked)
        return connection.recv(12)

    with ExitStack() as held, small_server(tmp_path, unread_s=600.0, max_answers_bytes=60_000_000) as address:

        def another() -> bytes:
            return status(held.enter_context(socket.create_connection(address, timeout=PATIENCE_S)))

        assert another() == b"HTTP/1.1 200"
        told = [another() for _ in range(3)]
        assert b"HTTP/1.1 503" in told
        assert well(address)
        held.close()
        with socket.create_connection(address, timeout=PATIENCE_S) as connection:
            assert until(lambda: status(connection) == b"HTTP/1.1 200", "room again")
