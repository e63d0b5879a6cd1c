"""A helper process that is ready has loaded everything: no answer's deadline falls into loading."""

from __future__ import annotations

import json
import subprocess
import sys

LOADED_LATER = """
import json, sys
from safestart_service.computing import inside
inside.ready()
from safestart.processes.execute import execute
from safestart.processes.registry import PROCESS_IDS, process
from numba.core.caching import Cache
late, load = [], Cache.load_overload
def noted(self, *asked):
    late.append(self._name)
    return load(self, *asked)
Cache.load_overload = noted
before = set(sys.modules)
point = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "states": [{"x_m": 5, "y_m": 40}]}
for more in ({}, {"omega_t_half_width_deg_s": 0.05}, {"disturbance_m_s2": 0.001}):
    execute("go-no-go", point | {"method": "exact"} | more)
for light in (one for one in PROCESS_IDS if process(one).light):
    execute(light, process(light).example)
modules = sorted(name for name in set(sys.modules) - before if name.partition(".")[0] != "email")
print(json.dumps({"modules": modules, "kernels": late}))
"""


def test_answers_load_nothing_more() -> None:
    """Where loading fell into an answer, its deadline killed the process, and a busy machine never had one ready."""
    # In a process of its own: a helper lowers its priority and bounds its memory.
    done = subprocess.run([sys.executable, "-c", LOADED_LATER], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    # A kernel, too: where the cache has it not, it is compiled, and the compiler loads more modules.
    assert json.loads(done.stdout.splitlines()[-1]) == {"modules": [], "kernels": []}
