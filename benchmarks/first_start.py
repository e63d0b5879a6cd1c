"""A worker's first start: from an empty kernel cache to the first finished benchmark job, and to all kernels.

``python -m benchmarks.first_start`` prints what is compiled: how often each kernel, in how many seconds of one core.
``python -m benchmarks.first_start started`` starts a worker of two task processes on an empty cache and on the same
cache again.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from pathlib import Path
from typing import Any

import psutil
from numba.core import event

from benchmarks.own_group import own_group
from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from safestart.store.records import JobStatus

INPUTS = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1}
LIMIT_S = 600.0


class Compiled(event.Listener):
    """Compilations by kernel: how often, seconds of this thread without what it calls, and with it."""

    def __init__(self) -> None:
        self.rows: dict[str, list[float]] = defaultdict(lambda: [0, 0.0, 0.0])
        self._open: list[list[float]] = []

    def on_start(self, event: Any) -> None:  # noqa: ARG002
        """Begin one, inside of another perhaps."""
        self._open.append([time.thread_time(), 0.0])

    def on_end(self, event: Any) -> None:
        """Count it for its kernel."""
        function = event.data["dispatcher"].py_func
        begun, inside = self._open.pop()
        spent = time.thread_time() - begun
        row = self.rows[f"{function.__module__}.{function.__qualname__}"]
        row[0], row[1], row[2] = row[0] + 1, row[1] + spent - inside, row[2] + spent
        if self._open:
            self._open[-1][1] += spent


def listed(parts: list[str]) -> None:
    """Compile ``parts`` (all by default) in this process, and print each one's kernels, slowest first."""
    from safestart.runtime.kernels import warmup

    for part in parts or list(warmup.PARTS):
        compiled, begun = Compiled(), time.thread_time()
        event.register("numba:compile", compiled)
        warmup.warm(part)
        event.unregister("numba:compile", compiled)
        rows = sorted(compiled.rows.items(), key=lambda item: -item[1][1])
        number = int(sum(row[0] for row in compiled.rows.values()))
        print(f"{part}: {number} compilations, {time.thread_time() - begun:.1f} s of one core")
        for name, (count, own, whole) in rows:
            print(f"  {own:6.2f} s, with callees {whole:6.2f} s, {count:.0f} x {name}")


def started(cache: Path) -> dict[str, float]:
    """Seconds from a worker's start, with a benchmark in the queue, to its end and to all kernels."""
    with tempfile.TemporaryDirectory() as folder:
        url = f"sqlite:///{Path(folder) / 'first.sqlite3'}"
        database = Database(url)
        database.migrate()
        jobs = JobRepository(database)
        job = jobs.submit("benchmark", INPUTS, timeout_s=LIMIT_S).id
        out = Path(folder) / "worker.log"
        begun = time.perf_counter()
        command = [sys.executable, "-m", "safestart_worker", "--database-url", url, "--processes", "2"]
        environment = os.environ | {"NUMBA_CACHE_DIR": str(cache), "PYTHONUNBUFFERED": "1"}
        found: dict[str, float] = {}
        with (
            out.open("wb") as log,
            own_group(command, env=environment, stdout=log, stderr=log) as worker,
        ):
            while len(found) < 4:
                time.sleep(0.05)
                spent, said = time.perf_counter() - begun, out.read_text(errors="replace")
                if worker.poll() is not None or spent > LIMIT_S:
                    raise RuntimeError(f"the worker ended, or took too long:\n{said[-4000:]}")
                if "takes jobs from" in said:
                    found.setdefault("takes_jobs_s", spent)
                if "all kernels are there" in said:
                    found.setdefault("ready_s", spent)
                if "first_job_s" not in found and (status := jobs.get(job).status).ended:
                    if status is not JobStatus.SUCCESSFUL:
                        raise RuntimeError(f"the benchmark ended {status.value}:\n{said[-4000:]}")
                    found["first_job_s"] = spent
                    family = psutil.Process(worker.pid)
                    found["first_job_cpu_s"] = sum(
                        sum(one.cpu_times()[:2]) for one in (family, *family.children(recursive=True))
                    )
        database.close()
    return found


def measure() -> dict[str, dict[str, float]]:
    """One start on an empty cache, one on the same cache again."""
    with tempfile.TemporaryDirectory() as cache:
        cold, warm = started(Path(cache)), started(Path(cache))
    times = {
        "first_start_s": cold["first_job_s"],
        "first_start_cpu_s": cold["first_job_cpu_s"],
        "first_start_all_kernels_s": cold["ready_s"],
        "worker_warm_takes_jobs_s": warm["takes_jobs_s"],
        "worker_warm_first_job_s": warm["first_job_s"],
    }
    return {"ratios": {}, "times": times}


def main() -> None:
    """Print the list, or the times of a start."""
    from safestart.runtime.kernels.warmup import PARTS

    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "what", nargs="*", metavar="PART", help=f"started, or some of {', '.join(PARTS)}; all by default"
    )
    asked = parser.parse_args().what
    if asked == ["started"]:
        print(json.dumps(measure()["times"], indent=2))
        return
    if unknown := set(asked) - set(PARTS):
        parser.error(f"no such part: {', '.join(sorted(unknown))}")
    with tempfile.TemporaryDirectory() as cache:
        inside = "from benchmarks.first_start import listed; import sys; listed(sys.argv[1:])"
        subprocess.run(
            [sys.executable, "-c", inside, *asked],
            check=True,
            env=os.environ | {"NUMBA_CACHE_DIR": cache},
        )


if __name__ == "__main__":
    main()
