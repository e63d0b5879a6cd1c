"""The thrust-map process: what more thrust buys, at once."""
