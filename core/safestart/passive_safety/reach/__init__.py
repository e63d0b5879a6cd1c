"""Reach tubes of the switched rendezvous and of the drifts after an abort."""
