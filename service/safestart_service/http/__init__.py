"""HTTP: the wire, its limits, bodies, media types, answers and event streams."""
