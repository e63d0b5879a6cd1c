"""The collision-avoidance process: the two-satellite game of paper 001, its sets and its closed loop."""
