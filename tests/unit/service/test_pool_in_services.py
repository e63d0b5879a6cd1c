"""Helper processes of small services in processes of their own: killed, without a folder, short of memory."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import psutil
import pytest

from safestart_service.computing.helpers.sources import FORKS
from tests.waiting import PATIENCE_S, ended, until

needs_fork = pytest.mark.skipif(not FORKS, reason="this system cannot fork")

ALONE = """
import asyncio, os, sys, time
from safestart_service.computing.helpers.pool import Pool
async def ready():
    pool = Pool(1)
    await pool.start()
    return pool
async def busy():
    pool = await ready()
    asyncio.ensure_future(pool(eval, "__import__('ctypes').PyDLL(None).sleep(600)"))
    await asyncio.sleep(0.5)
    return pool
async def loads():
    sys.path.insert(0, sys.argv[2])
    pool = Pool(1)
    asyncio.ensure_future(pool.start())
    while not os.path.exists(os.path.join(sys.argv[2], "begun")):
        await asyncio.sleep(0.05)
    return pool
async def wait():
    pool = await globals()[sys.argv[1]]()
    print("there", flush=True)
    await asyncio.sleep(600)
asyncio.run(wait())
"""
HANGS = """
import ctypes, pathlib
pathlib.Path(__file__).with_name("begun").touch()
ctypes.PyDLL(None).sleep(600)  # as a library that keeps the interpreter to itself
"""


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere it ends when the library returns")
@pytest.mark.parametrize("when", ["ready", "busy", "loads"])
def test_no_process_outlives_a_service_that_is_killed(when: str, tmp_path: Path) -> None:
    (tmp_path / "clarabel.py").write_text(HANGS)
    service = subprocess.Popen(
        [sys.executable, "-c", ALONE, when, str(tmp_path)], stdout=subprocess.PIPE, text=True
    )
    assert service.stdout is not None
    assert service.stdout.readline() == "there\n"
    family = psutil.Process(service.pid).children(recursive=True)
    assert len(family) >= 1 + (when != "loads")
    service.kill()
    service.wait()
    assert until(lambda: all(ended(one.pid) for one in family), "the end of all processes")


NOWHERE = """
import asyncio, os, sys
from safestart_service.computing.helpers.pool import Pool
os.mkdir(sys.argv[1])
os.chdir(sys.argv[1])
os.rmdir(sys.argv[1])
async def asked():
    pool = Pool(1)
    print(await pool(os.getcwd))
    pool.close()
asyncio.run(asked())
"""


@needs_fork
def test_a_folder_that_was_deleted_is_left(tmp_path: Path) -> None:
    """Modules that look where they are could not be loaded, and every exact answer was a 500."""
    asked = [sys.executable, "-P", "-c", NOWHERE, str(tmp_path / "gone")]
    done = subprocess.run(asked, capture_output=True, text=True)
    assert done.stdout == f"{os.path.abspath(os.sep)}\n", done.stderr


AGAIN = """
import asyncio, gc, sys
from safestart_service.computing.helpers.pool import Pool
sys.path.insert(0, sys.argv[1])
async def asked():
    pool = Pool(1)
    print(await pool(gc.get_freeze_count) > 0)
    pool.close()
asyncio.run(asked())
"""
FAILS_ONCE = """
import pathlib
tried = pathlib.Path(__file__).with_name("tried")
if not tried.exists():
    tried.touch()
    raise MemoryError
"""


@needs_fork
def test_what_could_not_be_loaded_is_loaded_before_the_next_fork(tmp_path: Path) -> None:
    """Else every helper loads for itself from then on, in the time of its answers."""
    (tmp_path / "clarabel.py").write_text(FAILS_ONCE)
    done = subprocess.run([sys.executable, "-c", AGAIN, str(tmp_path)], capture_output=True, text=True)
    assert done.stdout == "True\n", done.stderr
    assert (tmp_path / "tried").exists()
    assert "MemoryError" in done.stderr, "it is told in the log"


KILLED = """
import asyncio, os, sys, threading, time
sys.path.insert(0, sys.argv[1])
import psutil
from fastapi.testclient import TestClient
from safestart.runtime.settings import Settings
from safestart_service.app import create_app
from safestart_service.computing import heavy
heavy.START_S = 300
def kill():
    for number in range(2):
        while not os.path.exists(os.path.join(sys.argv[1], f"begun{number}")):
            time.sleep(0.05)
        for one in psutil.Process().children():
            one.kill()
app = create_app(Settings(database_url="sqlite:///" + os.path.join(sys.argv[1], "store"), answer_timeout_s=6))
threading.Thread(target=kill).start()
with TestClient(app, base_url="http://127.0.0.1", client=("127.0.0.1", 1)) as client:
    states = [{"x_m": 1e-4 * k, "y_m": 40} for k in range(5000)]
    body = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "method": "paper", "states": states}
    print(client.post("/go-no-go", json=body).status_code)
"""
SLOW = """
import pathlib, time
number = len(list(pathlib.Path(__file__).parent.glob("begun*")))
pathlib.Path(__file__).with_name(f"begun{number}").touch()
time.sleep(600 if number < 2 else 10)  # killed; longer than an answer may take
"""


@needs_fork
def test_an_answer_waits_for_the_next_process_where_one_is_killed_while_it_loads(tmp_path: Path) -> None:
    """Twice here. Else the next one loads in the answer's own time."""
    (tmp_path / "clarabel.py").write_text(SLOW)
    command = [sys.executable, "-c", KILLED, str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE_S)
    assert done.stdout == "200\n", done.stderr[-2000:]
