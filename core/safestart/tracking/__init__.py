"""Answers about the tracking MPC of paper 002: possible impulse histories, regions, flights, certificates."""
