"""Benchmarks: each of ours beside its peer, in one run."""
