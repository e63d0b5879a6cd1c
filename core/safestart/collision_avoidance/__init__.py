"""Collision avoidance between two satellites (paper 001): the avoid game, its certified bounds, its value on a grid."""
