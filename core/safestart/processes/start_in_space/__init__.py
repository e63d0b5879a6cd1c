"""The start-in-space process: verdicts for any start, attitude, orbit, corridor and set of thrusts."""
