"""The safe-region process: the exact region of starts between its proved polygons, answered at once."""
