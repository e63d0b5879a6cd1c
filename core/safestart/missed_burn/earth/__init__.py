"""The missed-burn proof about the true Earth: two bodies with J2, an orbit of any eccentricity."""
