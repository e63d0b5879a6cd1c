"""Bounds of the avoid game's value, certified without a grid."""
