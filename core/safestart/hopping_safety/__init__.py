"""What makes a hopping approach safe enough, and what that costs: a drift away, a tighter barrier; a proof at once."""
