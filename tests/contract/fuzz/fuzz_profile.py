"""Loaded by schemathesis as its hooks: every example is a new one.

By default half of them go to varying and shrinking those that were accepted, which takes most of the time.
"""

from hypothesis import Phase, settings

settings.register_profile("fresh", phases=[Phase.explicit, Phase.generate], database=None)
settings.load_profile("fresh")
