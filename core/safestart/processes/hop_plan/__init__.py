"""The hop-plan process: an approach planned and proved at once, with the drifts to draw."""
