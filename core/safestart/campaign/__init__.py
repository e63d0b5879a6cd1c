"""Campaigns of many cases: drawn, cut into shards, simulated, tallied, merged."""
