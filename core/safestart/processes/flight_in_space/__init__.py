"""The flight-in-space process: one flight from one start of a question in space, watched at all times."""
