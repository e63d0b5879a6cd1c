"""Staying in the corridor against a bounded disturbance: the tube and its ancillary feedback."""
