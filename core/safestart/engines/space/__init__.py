"""The engines over a plane of starts in space: any attitude, orbit, faces and thrusts."""
