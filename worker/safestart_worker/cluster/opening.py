"""Open a Dask cluster: an embedded one of local processes, or an existing one by its address."""

from __future__ import annotations

import logging
from collections.abc import AsyncIterator
from contextlib import AsyncExitStack, asynccontextmanager
from copy import deepcopy
from tempfile import TemporaryDirectory
from typing import Any

import dask
from distributed import Client, LocalCluster, Nanny, Security
from distributed.comm.addressing import parse_address
from distributed.comm.registry import get_backend
from distributed.system import MEMORY_LIMIT

from safestart.errors import InvalidInput, invalid
from safestart_worker.cluster.cluster import Cluster
from safestart_worker.cluster.credentials import configured, refused, throwaway
from safestart_worker.cluster.own_files import forget_variables, unreadable
from safestart_worker.cluster.own_nanny import OwnNanny

CONNECT_TIMEOUT_S = 10.0
_MEMORY_SHARE = 0.9
_ONE_THREAD = {
    name: "1" for name in ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS")
}


@asynccontextmanager
async def open_cluster(
    scheduler: str, processes: int, max_attempts: int, owner: str
) -> AsyncIterator[Cluster]:
    """Connect to ``scheduler``, or start an embedded cluster when it is empty; the block's end closes it."""
    if scheduler:
        _require_address(scheduler)
    async with AsyncExitStack() as stack:
        folder = stack.enter_context(_private_folder())
        if not scheduler:
            forget_variables()
        with dask.config.set(
            {**_defaults(scheduler), **_config(max_attempts), "temporary-directory": folder}
        ):
            security = configured(scheduler) if scheduler else throwaway()
            local = None if scheduler else await stack.enter_async_context(_embedded(processes, security))
            try:
                client = await stack.enter_async_context(
                    Client(
                        scheduler if local is None else await _short_cut(local),
                        security=security,
                        asynchronous=True,
                        timeout=CONNECT_TIMEOUT_S,
                        set_as_default=False,
                    )
                )
            except (OSError, TimeoutError) as error:
                raise refused(scheduler, error) from error
            except ValueError as error:
                raise _no_address(scheduler) from error
            cluster = Cluster(client, owner, local)
            stack.push_async_callback(cluster.close)
            yield cluster


def _require_address(scheduler: str) -> None:
    """Raise ``InvalidInput`` for no address of a scheduler, before there is a client.

    Dask's client finds it out inside of coroutines, and leaves some of its own that nobody awaits.
    """
    try:
        scheme, place = parse_address(scheduler)
        if not 0 < get_backend(scheme).get_address_host_port(place)[1] < 65536:
            raise ValueError("no port")
    except (ValueError, NotImplementedError, TypeError):
        raise _no_address(scheduler) from None


def _no_address(scheduler: str) -> InvalidInput:
    return invalid("scheduler", "an address such as tcp://host:8786", scheduler)


def _private_folder() -> TemporaryDirectory[str]:
    """A private folder: Dask imports from its processes' working folder, and others may write to its default one."""
    return TemporaryDirectory(prefix="safestart-", ignore_cleanup_errors=True)


def _defaults(scheduler: str) -> dict[str, Any]:
    """Dask's own defaults in place of the user's files and variables, which may set lifetimes, preloads and folders.

    What the user says about connections holds for the user's scheduler.
    """
    defaults: dict[str, Any] = deepcopy(dask.config.merge(*dask.config.defaults))
    if scheduler:
        defaults["distributed"]["comm"] = deepcopy(dask.config.get("distributed.comm"))
    return defaults | {"scheduler-address": None}


def _embedded(processes: int, security: Security) -> LocalCluster:
    """Processes of one thread each on the loopback interface, without dashboard; peers need the certificate."""
    return LocalCluster(
        n_workers=processes,
        threads_per_worker=1,
        processes=True,
        worker_class=OwnNanny if unreadable() else Nanny,
        host="127.0.0.1",
        security=security,
        # Dask always opens a port for its dashboard: take a free one, without pages (_config).
        dashboard_address=None,
        scheduler_kwargs={"dashboard_address": "127.0.0.1:0"},
        memory_limit=int(_MEMORY_SHARE * MEMORY_LIMIT / max(processes, 1)),
        # Dask warns about every process that we end on purpose; our own log lines say what matters.
        silence_logs=logging.ERROR,
        asynchronous=True,
    )


async def _short_cut(cluster: LocalCluster) -> str:
    """In-process address of the scheduler: half of all messages are between it and us and need no TLS."""
    scheduler: Any = cluster.scheduler
    await scheduler.listen("inproc://", allow_offload=False)
    address: str = scheduler.listeners[-1].contact_address
    return address


def _config(max_attempts: int) -> dict[str, Any]:
    return {
        # Dask counts deaths beyond the first allowed ones; we count attempts.
        "distributed.scheduler.allowed-failures": max_attempts - 1,
        # By default Dask gives a lost process up when its successor takes more than 15 s, as it does on a loaded
        # machine. We wait longer, and give up ourselves when jobs get nowhere (see liveness).
        "distributed.deploy.lost-worker-timeout": "1000 hours",
        # Events carry progress only; the database is the record.
        "distributed.admin.low-level-log-length": 1000,
        # Samples of what runs, for a dashboard that we do not open: a thread of each process wakes 100 times a second.
        "distributed.worker.profile.enabled": False,
        # How late the event loop is, which Dask would log; our own signs of life say more (see liveness).
        "distributed.admin.tick.interval": "500ms",
        # The process reads these before it imports NumPy or Numba.
        "distributed.nanny.pre-spawn-environ": {**_ONE_THREAD, "MALLOC_TRIM_THRESHOLD_": "65536"},
        "distributed.scheduler.http.routes": [],
        "distributed.worker.http.routes": [],
        "distributed.comm.timeouts.connect": f"{CONNECT_TIMEOUT_S:g}s",
    }
