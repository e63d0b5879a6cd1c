"""Simulated flights of the switched rendezvous: counter-examples, and an independent check of every proof."""
