"""The thrust-map process: the effect of more thrust, answered at once."""
