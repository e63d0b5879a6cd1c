"""What runs inside a helper process: one call at a time, in bounded memory, at low priority."""

from __future__ import annotations

import gc
import os
import traceback
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from importlib import import_module
from time import monotonic
from typing import Any

from safestart.errors import SafestartError, Unavailable
from safestart.processes.go_no_go.method_registry import METHODS
from safestart.processes.registry import PROCESS_IDS, process
from safestart.runtime.named import load
from safestart.runtime.progress import Context
from safestart.runtime.settings import Settings
from safestart_service.computing.allocator import return_freed
from safestart_service.computing.helpers import serving
from safestart_service.computing.store import Store
from safestart_service.shortage import shortage

MOST_BYTES = 768 * 1024**2
"""Data of a helper process. Numba takes 130 MiB of it, the largest legal question less than half of the rest."""
NICENESS = 5
# An answer that took less has left too little behind to spend a millisecond on it.
_SHORT_S = 0.05


# What is loaded where it is first needed. Loaded before the fork, it is there once for all helpers.
_LATE = (
    "clarabel",
    "safestart.proofs.checker",
    "safestart.store.cache",
    "safestart.store.database",
    "safestart.store.jobs.repository",
    "safestart_service.computing.work",
)


class Failed(RuntimeError):
    """An unexpected error inside a helper process; its text holds the traceback."""


def call(function: Callable[..., Any], settings: Settings, *arguments: Any) -> Any:
    """``function(store, context, *arguments)``; raises our errors as they are, and ``Failed`` for all others."""
    begun = monotonic()
    try:
        _prepare()
        store = _store(settings)
        begun = monotonic()
        return function(store, Context(cancelled=serving.stopped, shelf=store.shelf), *arguments)
    except SafestartError:
        raise
    except MemoryError:
        raise Unavailable(
            f"the answer takes more than {MOST_BYTES >> 20} MiB; required a smaller question, or a job",
            required="a smaller question, or a job",
        ) from None
    except Exception as error:
        no_room = shortage(error)
        raise Failed(traceback.format_exc()) if no_room is None else no_room from None
    finally:
        if monotonic() - begun > _SHORT_S:
            _return_memory()


def ready() -> int:
    """Load what heavy answers need, before the first one comes; returns the process id.

    All of it: loading takes seconds on a busy machine. Where it fell into the time of an answer, its deadline ended the
    process, and the next one began anew.
    """
    for spec in map(process, PROCESS_IDS):
        if spec.light:
            spec.runner()
    for method in METHODS.values():
        load(method.decide)
    for name in _LATE:
        import_module(name)
    # By name, like the processes: the application itself, which imports this module, loads no Numba.
    import_module("safestart.exact.kernels.warm").warm()
    # Numba's objects stay: scanning them takes a tenth of a second every time. What compiling left is freed.
    _return_memory()
    gc.freeze()
    return os.getpid()


@cache
def _prepare() -> None:
    with suppress(AttributeError, OSError):
        os.nice(NICENESS)
    with suppress(ImportError, ValueError, OSError):
        import resource

        _, hard = resource.getrlimit(resource.RLIMIT_DATA)
        resource.setrlimit(resource.RLIMIT_DATA, (MOST_BYTES, hard))


def _return_memory() -> None:
    gc.collect()
    return_freed()


@cache
def _store(settings: Settings) -> Store:
    from safestart.store.database import Database

    return Store.over(settings, Database(settings.url()))
