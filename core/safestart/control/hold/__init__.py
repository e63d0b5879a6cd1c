"""Station keeping at the hold point of a turning target, and the sets that it keeps (paper 000, section 8.3)."""
