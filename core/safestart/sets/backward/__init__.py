"""Backward reachable sets of linear systems: nominal, robust, stochastic (paper 000, section 3)."""
