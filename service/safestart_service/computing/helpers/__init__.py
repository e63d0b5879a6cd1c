"""Helper processes: how they start, compute one call at a time, and end."""
