"""Compiled parts of the exact answers; loaded with the first of them, as Numba takes a second to load."""
