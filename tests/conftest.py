"""Property tests are the same on every machine: no example has a time limit, and the examples are always the same.

Others are drawn with ``pytest --hypothesis-profile=default``.

Hundreds of tests start processes of ours. They keep their compiled modules even where the environment says not to:
without them each of those processes compiles the text of all modules again, two thirds of its start.
"""

import os
import sys

from hypothesis import HealthCheck, settings

os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

settings.register_profile(
    "steady", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("steady")
