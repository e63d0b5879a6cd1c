"""Closed-loop flights: a controller in a plant, watched at all times."""
