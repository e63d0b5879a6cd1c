"""The plane-benchmark process: the reachability engines on a plane of starts in space."""
