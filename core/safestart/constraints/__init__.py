"""Constraints on a flight at all times: ``constraint`` is the interface; polyhedra, and sets of accelerations."""
