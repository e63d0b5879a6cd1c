"""Benchmarks: each of ours beside its peer, in one run. ``safestart bench`` runs them in this order."""

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
