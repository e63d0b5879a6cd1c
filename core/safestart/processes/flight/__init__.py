"""The flight process: the best flight from one start, as curves over time."""
