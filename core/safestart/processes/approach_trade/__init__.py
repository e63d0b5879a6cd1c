"""The approach-trade process: hopping approaches by angle, hops and hold point, priced by their safety."""
