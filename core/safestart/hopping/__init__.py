"""Hopping approaches (paper 004): how long a hop takes, which hops make an approach, and what they cost."""
