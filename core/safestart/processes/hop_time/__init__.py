"""The hop-time process: how long one hop takes, at once."""
