"""Clients that others wrote or generate, by hand: ``python -m tests.clients``."""
