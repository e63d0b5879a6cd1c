"""The hop-time process: the duration of one hop, answered at once."""
