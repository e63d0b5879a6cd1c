"""Answers about the tracking MPC of paper 002: what any impulse history can do, regions, flights, certificates."""
