"""Code of a task process: it runs a job, or a shard of one, from raw inputs to an outcome that says how it ended.

It raises nothing: errors become part of the outcome, so no exception class or stack trace has to travel.
"""

from __future__ import annotations

import threading
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime
from typing import Any
from uuid import uuid4

from distributed import get_worker

from safestart.errors import SafestartError
from safestart.processes.execute import Execution, execute, merge
from safestart.processes.registry import PROCESS_IDS, process
from safestart.processes.sharding import Part
from safestart.records.artifact import Artifact
from safestart.records.provenance import source, versions
from safestart.runtime.progress import Context
from safestart_worker.cluster.report import Reporter
from safestart_worker.problems import of_error, of_unexpected

# Keys of the jobs whose tasks in this process must stop; see request_stop.
_stopping: set[str] = set()
_lock = threading.Lock()


@dataclass(frozen=True, slots=True)
class JobEnd:
    """How a task ended: a document with artifacts, or a problem; ``trace`` is for the log only."""

    document: dict[str, Any] | None
    artifacts: tuple[Artifact, ...]
    versions: dict[str, Any]
    problem: dict[str, Any] | None = None
    trace: str | None = None


@dataclass(frozen=True, slots=True)
class ShardEnd:
    """How a shard ended: its result, or a problem; ``by`` is the source that computed it."""

    part: Part | None
    by: str
    problem: dict[str, Any] | None = None
    trace: str | None = None


def request_stop(key: str) -> None:
    """Ask the tasks of the job ``key`` in this process to stop; engines look at every step they report."""
    with _lock:
        _stopping.add(key)


def load() -> None:
    """Import the modules that every process needs, so that the first job does not wait for them."""
    for process_id in PROCESS_IDS:
        process(process_id).runner()
    versions()


def run_job(process_id: str, inputs: dict[str, Any], key: str, topic: str) -> JobEnd:
    """Run one job to its outcome."""
    return _whole(
        lambda context: execute(process_id, process(process_id).stored(inputs), context), key, topic
    )


def run_merge(
    process_id: str, inputs: dict[str, Any], parts: list[Part], started: datetime, key: str, topic: str
) -> JobEnd:
    """Run the merge of a sharded job to its outcome."""
    return _whole(lambda context: merge(process_id, inputs, parts, started, context), key, topic)


def run_shard(process_id: str, part: dict[str, Any], number: int, key: str, topic: str) -> ShardEnd:
    """Run shard ``number`` of the job ``key``."""
    reporter = Reporter(key, topic, get_worker(), number)
    reporter.started()
    context = Context(reporter.report, lambda: key in _stopping)
    sharding = process(process_id).sharding
    assert sharding is not None
    try:
        context.step(0.0, 1.0)  # asked to stop before it began
        return ShardEnd(sharding.run_part(part, context), source())
    except SafestartError as error:
        return ShardEnd(None, source(), of_error(error))
    except Exception as error:
        return ShardEnd(None, source(), of_unexpected(error, uuid4().hex), traceback.format_exc())


def _whole(run: Callable[[Context], Execution], key: str, topic: str) -> JobEnd:
    reporter = Reporter(key, topic, get_worker())
    reporter.started()
    context = Context(reporter.report, lambda: key in _stopping)
    try:
        execution = run(context)
    except SafestartError as error:
        return JobEnd(None, (), versions(), of_error(error))
    except Exception as error:
        incident = uuid4().hex
        return JobEnd(None, (), versions(), of_unexpected(error, incident), traceback.format_exc())
    finally:
        with _lock:
            _stopping.discard(key)
    return JobEnd(execution.document, execution.artifacts, versions())
