"""Requests that ask for more than they cost: they are refused early, in little memory, and health is answered."""

from __future__ import annotations

import asyncio
import json
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path

import httpx
import psutil
import pytest

from safestart.errors import InvalidInput
from safestart_service.computing import heavy
from safestart_service.computing.heavy import Helpers
from safestart_service.documents import execution
from tests.acceptance.running import serving
from tests.contract.api.service_client import POINT, assert_problem, service
from tests.waiting import PATIENCE_S, until

JSON = {"Content-Type": "application/json"}
STATES = {**POINT, "states": [{"x_m": 5, "y_m": 40}]}
MOST_MB = 600


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    folder = tmp_path_factory.mktemp("bounded")
    with (
        serving(f"sqlite:///{folder / 'a.sqlite3'}") as url,
        httpx.Client(base_url=url, timeout=PATIENCE_S) as client,
    ):
        # A helper process loads for a long time on a busy machine; what follows is about its answers.
        many = {**POINT, "states": [{"x_m": 5.123456789, "y_m": 40.123456789}] * 3000}
        client.post("/go-no-go", json=many)
        yield client


def compact(document: object) -> bytes:
    return json.dumps(document, separators=(",", ":")).encode()


def memory_mb(server: httpx.Client) -> float:
    """Proportional set size of this service and its helpers; other tests may have processes below ours, too."""
    total, port = 0, str(server.base_url.port)
    for service_ in psutil.Process().children():
        with suppress(psutil.Error):
            if port in service_.cmdline():
                family = (service_, *service_.children(recursive=True))
                total += sum(one.memory_full_info().pss for one in family)
    assert total > 0
    return total / 1e6


ATTACKS = {
    "unknown fields of a model with states": (
        "/go-no-go",
        compact(STATES | {f"a{k}": 1 for k in range(350_000)}),
    ),
    "unknown fields": ("/certificates", compact({**POINT, **{f"a{k}": 1 for k in range(350_000)}})),
    "objects": ("/go-no-go", compact({**POINT, "states": [{}] * 2_000_000})),
    "lists": ("/processes/go-no-go/execution", compact({"inputs": {**POINT, "states": [[]] * 2_000_000}})),
    "wrong items": ("/go-no-go", compact({**POINT, "states": [{"b": 1}] * 100_000})),
    "missing in every item": ("/go-no-go", compact({**POINT, "states": [{"x_m": 1}] * 100_000})),
    "a long text": ("/go-no-go", compact({**POINT, "states": "x" * 7_000_000})),
    "outputs": (
        "/processes/certificate/execution",
        compact({"inputs": POINT, "outputs": {f"a{k}": {} for k in range(30_000)}}),
    ),
}


@pytest.mark.parametrize("name", ATTACKS)
def test_a_body_of_many_parts(server: httpx.Client, name: str) -> None:
    path, body = ATTACKS[name]
    begun = time.monotonic()
    answer = server.post(path, content=body, headers=JSON)
    assert_problem(answer, 422)
    assert len(answer.content) < 3000
    assert time.monotonic() - begun < 20.0
    assert memory_mb(server) < MOST_MB


def test_what_is_refused_for_its_size_is_not_read(monkeypatch: pytest.MonkeyPatch) -> None:
    """2.6 million empty objects took 240 MB: once refused, they were looked through for qualified values."""
    monkeypatch.setattr(execution, "_unqualified", lambda _: pytest.fail("read after all"))
    with pytest.raises(InvalidInput, match="values and names"):
        execution.parse_request("sweep", compact({"inputs": [{}] * 200_000}))


@pytest.mark.parametrize("body", [b"[" * 1_000_000, b'{"a":' * 200_000, b'{"a":' * 300 + b"1" + b"}" * 300])
def test_a_body_of_many_levels(server: httpx.Client, body: bytes) -> None:
    assert server.post("/certificates", content=body, headers=JSON).status_code in (400, 422)


def test_many_bodies_at_once(server: httpx.Client) -> None:
    """Twenty of 8 MB do not fit into the memory for bodies; some are told so, and health is answered meanwhile."""
    body = compact({**POINT, "states": "x" * 7_900_000})
    times: list[float] = []

    def send(_: int) -> httpx.Response:
        try:
            return httpx.post(f"{server.base_url}/go-no-go", content=body, headers=JSON, timeout=PATIENCE_S)
        except httpx.TransportError:  # refused before all of it was sent
            return httpx.Response(503, headers={"retry-after": "5"})

    with ThreadPoolExecutor(20) as pool:
        sent = [pool.submit(send, k) for k in range(20)]
        while not all(one.done() for one in sent):
            begun = time.monotonic()
            assert server.get("/healthz").status_code == 200
            times.append(time.monotonic() - begun)
            time.sleep(0.01)
    answers = [one.result() for one in sent]
    assert {answer.status_code for answer in answers} <= {422, 503}
    assert any(answer.status_code == 422 for answer in answers)
    for answer in answers:
        if answer.status_code == 503:
            assert int(answer.headers["retry-after"]) > 0
    assert memory_mb(server) < MOST_MB
    assert sorted(times)[len(times) // 2] < 0.5
    assert server.post("/go-no-go", json=STATES).status_code == 200


def test_a_process_that_starts_slowly_costs_no_answer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On a busy machine loading takes longer than an answer may; no deadline ends the process meanwhile."""
    start = Helpers._start

    async def slowly(helpers: Helpers) -> None:
        await asyncio.sleep(9.0)
        await start(helpers)

    monkeypatch.setattr(Helpers, "_start", slowly)
    with service(tmp_path, answer_timeout_s=8.0, answer_processes=1) as client:
        quick = {**POINT, "x_m": 5, "y_m": 40, "method": "exact"}
        assert client.get("/go-no-go", params=quick).status_code == 200


def test_what_is_answered_while_no_process_is_ready(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where no kernels are kept a process compiles for minutes: the certificate answers, the rest is told why not."""
    start, ready = Helpers._start, threading.Event()

    async def slowly(helpers: Helpers) -> None:
        while not ready.is_set():
            await asyncio.sleep(0.05)
        await start(helpers)

    monkeypatch.setattr(Helpers, "_start", slowly)
    monkeypatch.setattr(heavy, "START_S", 0.5)
    with service(tmp_path, answer_processes=1) as client:
        sure = {**POINT, "states": [{"x_m": 0, "y_m": 20}, {"x_m": 0, "y_m": 30}]}
        answer = client.post("/go-no-go", json=sure)
        assert answer.status_code == 200
        assert answer.json()["decided_by"] == ["certified", "certified"]
        open_one = {**POINT, "states": [{"x_m": 0, "y_m": 20}, {"x_m": 40, "y_m": 60}]}
        refused = client.post("/go-no-go", json=open_one)
        assert "still starts" in assert_problem(refused, 503)["detail"]
        assert int(refused.headers["retry-after"]) > 0
        ready.set()
        monkeypatch.undo()
        later = client.post("/go-no-go", json={**open_one, "method": "exact"})
        assert later.status_code == 200
        mixed = client.post("/go-no-go", json=open_one).json()
        assert [mixed[name][0] for name in ("verdict", "margin_m", "reason")] == [
            answer.json()[name][0] for name in ("verdict", "margin_m", "reason")
        ]


def test_an_answer_that_takes_too_long(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One that would take too long is refused at once; one that does is ended, and the next one is answered."""
    region = {"inputs": POINT | {"horizon_s": 600}}
    with service(tmp_path, answer_timeout_s=4.0, answer_processes=1) as client:

        def refused() -> float:
            begun = time.monotonic()
            problem = assert_problem(client.post("/processes/safe-region/execution", json=region), 504)
            assert problem["type"].endswith(":answer-timeout")
            assert "Prefer: respond-async" in problem["detail"]
            return time.monotonic() - begun

        assert refused() < 2.0
        quick = {**POINT, "x_m": 5, "y_m": 40, "method": "exact"}
        assert client.get("/go-no-go", params=quick).status_code == 200  # a process has started
        # As if the estimate were wrong; the helper process has its own, so the question goes there by its document.
        monkeypatch.setattr("safestart.processes.go_no_go.one_start.OneAtRest.cost", lambda _: 0.1)
        slow = {**POINT, "x_m": 5, "y_m": 40, "method": "exact", "horizon_s": 600}
        slow |= {"omega_t_half_width_deg_s": 0.1}  # half a minute
        begun = time.monotonic()
        assert client.get("/go-no-go", params=slow).status_code == 504
        assert time.monotonic() - begun < 10.0
        assert client.app.state.services.helpers.line._held.total() == 0
        monkeypatch.undo()
        answered = until(lambda: client.get("/go-no-go", params=quick).status_code == 200, "a new process")
        assert answered


@pytest.mark.parametrize("whole", ["31", "31.0", "3.1e1"])
def test_whole_numbers_however_they_are_written(server: httpx.Client, whole: str) -> None:
    """JSON Schema: a number without a fractional part is an integer."""
    grid = b'{"omega_t_deg_s":3,"a_max_m_s2":0.1,"grid":{"nx":%s,"ny":9}}' % whole.encode()
    answer = server.post("/certificates", content=grid, headers=JSON)
    assert answer.status_code == 200, answer.text
    assert len(answer.json()["x_m"]) == 31
    wrong = server.post("/certificates", content=grid.replace(whole.encode(), b"31.5"), headers=JSON)
    assert "required an integer, received 31.5" in assert_problem(wrong, 422)["detail"]


@pytest.mark.parametrize(
    "number", ["1e18", "1e19", "-1e19", "1e300", "9007199254740993.0", "1" + "0" * 30, "-31.0"]
)
@pytest.mark.parametrize("beside", ["9", "31.0", "18446744073709551616"])
def test_whole_numbers_out_of_range(server: httpx.Client, number: str, beside: str) -> None:
    body = b'{"omega_t_deg_s":3,"a_max_m_s2":0.1,"grid":{"nx":%s,"ny":%s}}' % (
        number.encode(),
        beside.encode(),
    )
    begun = time.monotonic()
    problem = assert_problem(server.post("/certificates", content=body, headers=JSON), 422)
    assert time.monotonic() - begun < 10.0
    assert "grid.nx: required a number" in problem["detail"]


def test_minus_zero_is_a_whole_number(server: httpx.Client) -> None:
    asked = b'{"priority":-0.0,"inputs":{"omega_t_deg_s":3,"a_max_m_s2":0.1}}'
    begun = time.monotonic()
    answer = server.post(
        "/processes/certificate/execution", content=asked, headers=JSON | {"Prefer": "respond-async"}
    )
    assert answer.status_code == 201, answer.text
    assert time.monotonic() - begun < 10.0


def test_wrong_whole_numbers_in_a_long_body_take_no_time(server: httpx.Client) -> None:
    """A body was made whole again and again while one number in it could not be."""
    starts = ",".join(['{"x_m":5,"y_m":40}'] * 5000)
    body = f'{{"omega_t_deg_s":3,"a_max_m_s2":0.1,"method":"tracking","tracking":{{"n_c":1e19}},"states":[{starts}]}}'
    begun = time.monotonic()
    problem = assert_problem(server.post("/go-no-go", content=body.encode(), headers=JSON), 422)
    assert time.monotonic() - begun < 10.0
    assert "tracking.n_c" in problem["detail"]
