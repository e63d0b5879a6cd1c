"""Property tests are the same on every machine: no example has a time limit, and the examples are always the same.

Others are drawn with ``pytest --hypothesis-profile=default``.
"""

from hypothesis import HealthCheck, settings

settings.register_profile(
    "steady", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("steady")
