"""What runs in a task process: one job, from its raw inputs to an outcome that says how it ended.

Nothing is raised: errors become part of the outcome, so that no exception class and no stack trace has to travel.
"""

from __future__ import annotations

import threading
import traceback
from dataclasses import dataclass
from typing import Any
from uuid import uuid4

from distributed import get_worker

from safestart.artifact import Artifact
from safestart.errors import SafestartError
from safestart.processes.execute import execute
from safestart.processes.registry import PROCESS_IDS, process
from safestart.progress import Context
from safestart.provenance import versions
from safestart_worker.problems import of_error, of_unexpected
from safestart_worker.report import Reporter

# Keys of the tasks of this process that were asked to stop; see request_stop.
_stopping: set[str] = set()
_lock = threading.Lock()


@dataclass(frozen=True, slots=True)
class Outcome:
    """How a task ended: a document with artifacts, or a problem; ``trace`` is for the log only."""

    document: dict[str, Any] | None
    artifacts: tuple[Artifact, ...]
    versions: dict[str, Any]
    problem: dict[str, Any] | None = None
    trace: str | None = None


def request_stop(key: str) -> None:
    """Ask the task ``key`` of this process to stop; engines look at every step they report."""
    with _lock:
        _stopping.add(key)


def load() -> None:
    """Import what every process needs, so that the first job does not wait for it."""
    for process_id in PROCESS_IDS:
        process(process_id).runner()
    versions()


def run_job(process_id: str, inputs: dict[str, Any], key: str, topic: str) -> Outcome:
    """Run one job to its outcome."""
    reporter = Reporter(key, topic, get_worker())
    reporter.started()
    context = Context(reporter.report, lambda: key in _stopping)
    try:
        execution = execute(process_id, inputs, context)
    except SafestartError as error:
        return Outcome(None, (), versions(), of_error(error))
    except Exception as error:
        incident = uuid4().hex
        return Outcome(None, (), versions(), of_unexpected(error, incident), traceback.format_exc())
    finally:
        with _lock:
            _stopping.discard(key)
    return Outcome(execution.document, execution.artifacts, versions())
