"""What must hold at every time of a flight."""
