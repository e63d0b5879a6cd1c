"""Claimed jobs on their way through the cluster."""
