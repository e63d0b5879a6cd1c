"""What a worker compiles and loads beside its jobs, and what it does not read."""

from __future__ import annotations

from pathlib import Path

import pytest

from safestart.runtime.kernels.warmup import PARTS
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


@pytest.mark.parametrize("text", ["a: [", "- no mapping", "\0"], ids=["malformed", "list", "binary"])
def test_dasks_broken_files_are_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str) -> None:
    broken = tmp_path / "home/.config/dask/e.yaml"
    broken.parent.mkdir(parents=True)
    broken.write_text(text)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    farm = Farm(tmp_path, processes=1)
    try:
        farm.start()
        job = farm.ended(farm.submit("certificate", {"omega_t_deg_s": 3, "a_max_m_s2": 0.1}))
        assert job.status is JobStatus.SUCCESSFUL, job
        assert "malformed" not in farm.said()
    finally:
        farm.close()
