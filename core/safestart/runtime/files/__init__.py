"""Files and streams read within a bound."""
