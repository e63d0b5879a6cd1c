"""The missed-burn proof: what a plan of burns does when one fails, in continuous time and for all errors at once."""
