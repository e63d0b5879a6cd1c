"""The embedded cluster has Dask's defaults and ours."""

import asyncio
import gc
import os

import dask
import psutil
import pytest

from safestart.errors import InvalidInput
from safestart_worker.cluster.opening import _defaults, _require_address, open_cluster
from safestart_worker.cluster.own_files import forget_variables

USERS = {
    "temporary-directory": "/nonexistent",
    "scheduler-address": "tcp://10.0.0.1:8786",
    "distributed.worker.lifetime.duration": "4 s",
    "distributed.worker.preload": ["nowhere"],
    "distributed.nanny.preload": ["nowhere"],
    "distributed.scheduler.idle-timeout": "3 s",
    "distributed.comm.tls.ca-file": "/mine/ca.pem",
}


def test_the_users_dask_configuration_is_not_ours() -> None:
    with dask.config.set(USERS):
        own, elsewhere = _defaults(""), _defaults("tls://there:8786")
    for found in (own, elsewhere):
        assert found["temporary-directory"] is None
        assert found["scheduler-address"] is None
        part = found["distributed"]
        assert part["worker"]["lifetime"]["duration"] is None
        assert part["worker"]["preload"] == part["nanny"]["preload"] == []
        assert part["scheduler"]["idle-timeout"] is None
    assert own["distributed"]["comm"]["tls"]["ca-file"] is None
    assert elsewhere["distributed"]["comm"]["tls"]["ca-file"] == "/mine/ca.pem"
    own["distributed"]["worker"]["preload"].append("ours")  # a copy
    assert _defaults("")["distributed"]["worker"]["preload"] == []


def test_task_processes_do_not_see_dasks_variables(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("DASK_TEMPORARY_DIRECTORY", "/nonexistent")
    monkeypatch.setenv("DASK_CONFIG", "/nonexistent")
    forget_variables()
    assert not [name for name in os.environ if name.startswith("DASK_")]


@pytest.mark.slow
def test_a_process_without_a_task_hardly_wakes() -> None:
    """Dask's profiler and its clock woke each process 100 times a second, which took a twentieth of a slow core."""

    async def wakes_per_s() -> float:
        async with open_cluster("", 1, 3, "me"):
            family = psutil.Process().children(recursive=True)
            before = {one: one.num_ctx_switches().voluntary for one in family}
            await asyncio.sleep(3.0)
            return max(one.num_ctx_switches().voluntary - count for one, count in before.items()) / 3.0

    assert asyncio.run(wakes_per_s()) < 50.0


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    "address", ["http://x", "x", "tcp://x", "tcp://x:99999999", "tcp://x:0", "tcp://", "ucx://x:1", "\udcff"]
)
def test_no_address_is_refused_before_there_is_a_client(address: str) -> None:
    """The client would leave coroutines that nobody awaits, and two warnings after the sentence."""

    async def opened() -> None:
        async with open_cluster(address, 1, 3, "me"):
            pass

    with pytest.raises(InvalidInput, match="scheduler: required an address such as tcp://host:8786"):
        asyncio.run(opened())
    gc.collect()


@pytest.mark.parametrize("address", ["tcp://x:8786", "x:8786", "tls://[::1]:8786", "ws://x:80"])
def test_addresses(address: str) -> None:
    _require_address(address)
