"""The queue: turns, claims under leases, workers, shards."""
