"""Simulated flights of the switched rendezvous: counter-examples, and the independent side of every proof."""
