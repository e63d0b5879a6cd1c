"""The exact question in space: any start, attitude, orbit, corridor and set of thrusts."""
