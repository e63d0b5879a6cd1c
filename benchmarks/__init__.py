"""Benchmarks: each of ours beside its peer, in one run. ``safestart bench`` runs them in this order."""

import os

# Processes that are timed keep their compiled modules, as they do for users: where the environment forbids it, every
# start would compile the text of all modules again.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

BENCHMARKS = (
    "certified",
    "reach",
    "level_set",
    "closed_loop",
    "sweep",
    "exact_answers",
    "exact_in_space",
    "passive_safety",
    "atlas",
    "http",
    "start_up",
    "first_start",
    "two_workers",
)
