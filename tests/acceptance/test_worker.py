"""A real worker on a real database: ends, progress, dismissal, time limits, deaths of every kind."""

from __future__ import annotations

import asyncio
import re
import socket
import ssl
import time
from collections.abc import Iterator
from typing import Any

import psutil
import pytest
from distributed.comm import CommClosedError, connect

from safestart.errors import JobFailed
from safestart.processes.execute import execute
from safestart.processes.registry import process
from safestart.records.comparable import comparable
from safestart.store.records import JobStatus
from safestart_worker.cluster.credentials import throwaway
from tests.acceptance.worker_process import DASK_GIVES_UP_S, Farm, over
from tests.waiting import PATIENCE_S, until

CERTIFICATE: dict[str, Any] = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1}
# About a hundred steps of some 50 ms, each of them reported: long enough to be disturbed, polls for a stop.
STEADY: dict[str, Any] = {
    "omega_t_deg_s": [0.5 * i for i in range(1, 51)],
    "a_max_m_s2": [0.05, 0.1],
    "grid": {"nx": 400, "ny": 400, "y_max_m": 150},
}
# Minutes of work in steps of seconds, the first of which is a compilation: does not poll in time.
STUBBORN: dict[str, Any] = {
    **CERTIFICATE,
    "engines": ["hamilton_jacobi"],
    "hamilton_jacobi": {
        "nodes_xy": 61,
        "nodes_v": 31,
        "accuracy": "very_high",
        "frame": "body",
        "solver": "hj_reachability",
    },
}


# Sixteen shards of some tenths of a second.
SWEEP: dict[str, Any] = {
    "controllers": ["filter", "sequence"],
    "cases_per_cell": 100,
    "omega_t_deg_s": [1, 4],
    "a_max_m_s2": [0.1],
    "records": 300,
}


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Farm]:
    farm = Farm(tmp_path_factory.mktemp("farm"))
    yield farm
    farm.close()


@pytest.fixture
def farm(shared: Farm) -> Farm:
    """The module's farm with its worker running, whatever the test before did to it."""
    shared.start()
    return shared


@pytest.fixture(scope="module")
def undisturbed(shared: Farm) -> str:
    """Id of a steady job that nothing happened to."""
    shared.start()
    job = shared.submit("coverage", STEADY)
    assert shared.ended(job).status is JobStatus.SUCCESSFUL
    return job


def result_of(farm: Farm, job: str) -> Any:
    """Inputs, outputs and artifact hashes, times aside; not the git revision, which may move under the test."""
    document = farm.results.result(job).document
    artifacts = document["provenance"]["artifacts"]
    return comparable({"inputs": document["inputs"], "outputs": document["outputs"], "artifacts": artifacts})


def statuses(farm: Farm, job: str) -> list[str]:
    return [event.data["status"] for event in farm.jobs.events(job) if event.kind == "status"]


def test_a_job_is_picked_up_and_ends_with_its_result(farm: Farm) -> None:
    job = farm.submit("certificate", CERTIFICATE)
    ended = farm.ended(job)
    assert ended.status is JobStatus.SUCCESSFUL, ended
    assert (ended.progress, ended.attempts, ended.owner) == (100.0, 1, None)
    document = farm.results.result(job).document
    process("certificate").outputs.model_validate(document["outputs"])
    assert ended.versions is not None
    assert "numpy" in ended.versions["packages"]
    assert farm.worker is not None
    assert "warming up failed" not in farm.said()
    assert farm.jobs.crew().workers == 1
    heard = [
        c.laddr for p in (psutil.Process(farm.worker.pid), *farm.processes()) for c in p.net_connections()
    ]
    assert {address.ip for address in heard if address} <= {"127.0.0.1"}
    assert 8787 not in {address.port for address in heard if address}


def test_no_port_answers_who_has_not_the_certificate(farm: Farm) -> None:
    """Dask runs any code it receives, and every account of the machine can reach a loopback port."""
    assert farm.worker is not None
    family = (psutil.Process(farm.worker.pid), *farm.processes())
    ports = {c.laddr.port for p in family for c in p.net_connections() if c.status == psutil.CONN_LISTEN}
    dask = {port for port in ports if not answers_http(port)}
    # The scheduler, and a nanny and a worker for each of the two task processes.
    assert len(dask) == 5
    assert {port: asyncio.run(answered(port)) for port in dask} == {port: [] for port in dask}


def answers_http(port: int) -> bool:
    """True for one of Dask's ports for pages, all of which are switched off."""
    with socket.create_connection(("127.0.0.1", port), timeout=PATIENCE_S) as asking:
        asking.sendall(b"GET / HTTP/1.0\r\n\r\n")
        try:
            answer = b"".join(iter(lambda: asking.recv(4096), b""))
        except ConnectionError:
            return False
    assert not answer.startswith(b"HTTP") or b" 404 " in answer, answer
    return answer.startswith(b"HTTP")


async def answered(port: int) -> list[str]:
    """Of those without the certificate of the cluster, the ones that get an answer to Dask's most harmless question."""
    blind = ssl.create_default_context()
    blind.check_hostname, blind.verify_mode = False, ssl.CERT_NONE
    foreign = throwaway().get_connection_args("client")["ssl_context"]
    foreign.verify_mode = ssl.CERT_NONE
    found = []
    for who, protocol, context in (
        ("plain", "tcp", None), ("no certificate", "tls", blind), ("foreign certificate", "tls", foreign),
    ):  # fmt: skip
        try:
            comm = await connect(f"{protocol}://127.0.0.1:{port}", timeout=PATIENCE_S, ssl_context=context)
            await comm.write({"op": "identity", "reply": True})
            await comm.read()
            found.append(who)
        except CommClosedError:
            continue
    return found


def test_progress_is_real_and_never_falls(farm: Farm, undisturbed: str) -> None:
    events = [event for event in farm.jobs.events(undisturbed) if event.kind == "progress"]
    percents = [event.data["progress"] for event in events]
    assert len(set(percents)) >= 4, percents
    assert percents == sorted(percents)
    assert 0.0 <= percents[0] < 50.0
    assert percents[-1] < 100.0
    assert all(event.data["eta_s"] >= 0.0 for event in events if event.data["eta_s"] is not None)
    assert len({event.data["message"] for event in events}) >= 4
    lasted_s = (events[-1].at - events[0].at).total_seconds()
    assert len(events) <= 2 * lasted_s + 3, "at most two a second, one at the start and one at the end"
    assert statuses(farm, undisturbed) == ["accepted", "running", "successful"]


def test_bad_inputs_fail_with_the_field_and_what_it_requires(farm: Farm) -> None:
    job = farm.submit("certificate", {**CERTIFICATE, "a_max_m_s2": -1})
    ended = farm.ended(job)
    assert ended.status is JobStatus.FAILED
    assert ended.problem is not None
    assert (ended.problem["type"], ended.problem["status"]) == ("urn:safestart:problem:invalid-input", 422)
    assert ended.problem["field"] == "a_max_m_s2"
    assert ">= 1e-06" in ended.problem["required"]
    with pytest.raises(JobFailed, match="a_max_m_s2"):
        farm.results.result(job)


def test_a_process_nobody_knows_fails_with_the_known_ones(farm: Farm) -> None:
    ended = farm.ended(farm.submit("alchemy", {}))
    assert ended.problem is not None
    assert ended.problem["type"] == "urn:safestart:problem:not-found"
    assert "certificate" in ended.problem["detail"]


def test_dismissing_leaves_the_neighbour_untouched(farm: Farm, undisturbed: str) -> None:
    stubborn = farm.submit("benchmark", STUBBORN)
    killed = farm.computing(stubborn)
    polite = farm.submit("coverage", STEADY)
    neighbour_process = farm.computing(polite)
    queued = farm.submit("coverage", STEADY)
    assert farm.jobs.position(queued) == 1
    assert farm.jobs.dismiss(queued).status is JobStatus.DISMISSED
    farm.jobs.dismiss(stubborn)
    assert farm.ended(stubborn).status is JobStatus.DISMISSED
    until(lambda: over([killed]), "the end of a task that does not poll")
    assert farm.ended(polite).status is JobStatus.SUCCESSFUL
    assert neighbour_process.is_running()
    assert result_of(farm, polite) == result_of(farm, undisturbed)
    assert not [event for event in farm.jobs.events(polite) if event.kind == "log"]
    assert statuses(farm, queued) == ["accepted", "dismissed"]


def test_a_task_that_polls_keeps_its_process_when_dismissed(farm: Farm) -> None:
    job = farm.submit("coverage", STEADY)
    running_in = farm.computing(job)
    farm.jobs.dismiss(job)
    assert farm.ended(job).status is JobStatus.DISMISSED
    assert running_in.is_running()
    assert running_in.status() != psutil.STATUS_ZOMBIE


def test_a_job_that_runs_too_long_fails_with_the_reason(farm: Farm) -> None:
    ended = farm.ended(farm.submit("benchmark", STUBBORN, timeout_s=1.5))
    assert ended.status is JobStatus.FAILED
    assert ended.problem is not None
    assert ended.problem["type"] == "urn:safestart:problem:timeout"
    assert "after 1.5 s" in ended.problem["detail"]


def test_a_killed_task_process_costs_time_but_not_the_result(farm: Farm, undisturbed: str) -> None:
    job = farm.submit("coverage", STEADY)
    farm.computing(job, 10.0).kill()
    until(lambda: farm.said().count(f"job={job} runs in process") == 2, "the second start")
    ended = farm.ended(job)
    assert (ended.status, ended.attempts) == (JobStatus.SUCCESSFUL, 2)
    assert result_of(farm, job) == result_of(farm, undisturbed)
    assert farm.results.result(job).sha256 == farm.results.result(undisturbed).sha256
    notes = [event.data["message"] for event in farm.jobs.events(job) if event.kind == "log"]
    assert notes == ["its task process died; starting, attempt 2"]


def test_a_process_that_takes_long_to_come_back_is_waited_for(farm: Farm) -> None:
    """Dask gives up after a while; a loaded machine needs longer, and had no task process left in the end."""
    until(lambda: len(farm.task_processes()) == 2, "both task processes")
    before = farm.task_processes()
    before[0].kill()
    late = until(lambda: [p for p in farm.task_processes() if p not in before], "its successor")[0]
    late.suspend()
    time.sleep(2 * DASK_GIVES_UP_S)
    late.resume()
    until(lambda: late.pid in computed_in(farm), "a job in the process that came back late")


def computed_in(farm: Farm) -> set[int]:
    """The task processes that two jobs at once ran in."""
    jobs = [farm.submit("coverage", STEADY | {"omega_t_deg_s": [1, 2, 3, 4]}) for _ in range(2)]
    assert all(farm.ended(job).status is JobStatus.SUCCESSFUL for job in jobs)
    return {int(pid) for job in jobs for pid in re.findall(rf"job={job} runs in process (\d+)", farm.said())}


def test_a_job_that_takes_down_every_task_process_fails_as_poison(farm: Farm) -> None:
    job = farm.submit("coverage", STEADY)
    for start in (1, 2):
        until(lambda n=start: farm.said().count(f"job={job} runs in process") == n, f"start {start}")
        farm.computing(job).kill()
    ended = farm.ended(job)
    assert ended.status is JobStatus.FAILED
    assert ended.problem is not None
    assert "started 2 times" in ended.problem["detail"]
    assert "2 times its task process died" in ended.problem["detail"]
    assert ended.attempts == 2
    assert farm.jobs.tallies()["poisoned"] == 1


def test_a_killed_worker_leaves_no_process_and_the_next_one_finishes_its_job(
    farm: Farm, undisturbed: str
) -> None:
    job = farm.submit("coverage", STEADY)
    farm.computing(job, 10.0)
    children = farm.processes()
    assert len(children) >= 2
    assert farm.worker is not None
    farm.worker.kill()
    farm.worker.wait()
    until(lambda: over(children), "the end of the task processes")
    assert farm.jobs.get(job).status is JobStatus.RUNNING
    farm.lapse()
    farm.start()
    ended = farm.ended(job)
    assert (ended.status, ended.attempts) == (JobStatus.SUCCESSFUL, 2)
    assert result_of(farm, job) == result_of(farm, undisturbed)
    assert statuses(farm, job) == ["accepted", "running", "running", "successful"]


def test_a_sweep_that_lost_a_process_and_its_worker_has_the_aggregate_of_an_undisturbed_one(
    farm: Farm,
) -> None:
    spec = process("sweep")
    assert spec.sharding is not None
    total = len(spec.sharding.parts(spec.parse(SWEEP)))
    assert total >= 8
    job = farm.submit("sweep", SWEEP)
    until(lambda: len(farm.jobs.shard_contents(job)) >= 2, "two finished shards")
    farm.computing(job).kill()
    until(lambda: len(farm.jobs.shard_contents(job)) >= 4, "four finished shards")
    assert farm.worker is not None
    farm.worker.kill()
    farm.worker.wait()
    kept = len(farm.jobs.shard_contents(job))
    assert 4 <= kept < total
    seen = spec.sharding.so_far(spec.parse(SWEEP), farm.jobs.shard_documents(job))
    assert 0 < seen["cases"] < 800
    farm.lapse()
    farm.start()
    ended = farm.ended(job)
    assert ended.status is JobStatus.SUCCESSFUL, ended
    notes = [event.data["message"] for event in farm.jobs.events(job) if event.kind == "log"]
    assert f"{kept} of {total} parts are done already" in notes
    assert farm.jobs.shard_contents(job) == {}
    there = farm.results.result(job).document
    here = execute("sweep", SWEEP).document
    assert comparable(there["outputs"]) == comparable(here["outputs"])
    assert there["provenance"]["artifacts"] == here["provenance"]["artifacts"]


def test_a_stopped_worker_gives_its_job_back(farm: Farm) -> None:
    job = farm.submit("benchmark", STUBBORN)
    farm.computing(job)
    children = farm.processes()
    assert farm.worker is not None
    farm.worker.terminate()
    assert farm.worker.wait(PATIENCE_S) == 0
    waiting = farm.jobs.get(job)
    assert (waiting.status, waiting.attempts, waiting.owner) == (JobStatus.ACCEPTED, 0, None)
    assert "its worker stopped" in waiting.message
    until(lambda: over(children), "the end of the task processes")
    assert farm.jobs.crew().workers == 0
    assert farm.jobs.dismiss(job).status is JobStatus.DISMISSED


def test_a_task_process_that_stands_still_is_replaced(shared: Farm, undisturbed: str) -> None:
    """Dask itself would wait five minutes for a process that neither works nor ends."""
    shared.stop()
    shared.start(silence_s=8.0)
    job = shared.submit("coverage", STEADY)
    stopped = shared.computing(job, 10.0)
    stopped.suspend()
    said = "give no sign of life, their processes do nothing"
    until(lambda: said in shared.said(), "the discovery")
    ended = shared.ended(job)
    assert (ended.status, ended.attempts) == (JobStatus.SUCCESSFUL, 2)
    assert over([stopped])
    assert result_of(shared, job) == result_of(shared, undisturbed)
