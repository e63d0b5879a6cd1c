"""Kernels: how Numba compiles them, the cache on disk that keeps them, and the warm-up that compiles them ahead."""
