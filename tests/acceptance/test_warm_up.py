"""What a worker compiles and loads beside its jobs."""

from __future__ import annotations

from pathlib import Path

from safestart.runtime.warmup import PARTS
from safestart.store.records import JobStatus
from tests.acceptance.test_worker import CERTIFICATE
from tests.acceptance.worker_process import Farm
from tests.waiting import until


def test_all_kernels_follow_beside_the_jobs_that_do_not_need_them(tmp_path: Path) -> None:
    farm = Farm(tmp_path, warm_up="all")
    try:
        farm.start()
        assert farm.ended(farm.submit("certificate", CERTIFICATE)).status is JobStatus.SUCCESSFUL
        until(lambda: "every process holds all modules and kernels" in farm.said(), "the kernels")
        assert all(f"kernels of {part} are there" in farm.said() for part in PARTS)
        assert "warming up failed" not in farm.said()
    finally:
        farm.close()
