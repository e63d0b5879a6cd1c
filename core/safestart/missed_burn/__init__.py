"""The missed-burn proof: a plan of burns when one fails, in continuous time and for all errors at once."""
