"""The sweep-in-space process: many starts of one question in space, decided exactly and flown in closed loop."""
